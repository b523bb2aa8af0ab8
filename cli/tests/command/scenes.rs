//! Promise: `info`, `fk` and `animate` read scenes from glTF files, and any posed mesh can be written as glTF.

use crate::forked_rig::*;
use glam::{Affine3A, Quat, Vec3, Vec3A};
use kinopt::animation::curve::KeyedCurve;
use kinopt::animation::rotation::RotationCurve;
use kinopt::animation::{Armature, ArmatureBone, Channel, Clip, LocalTransform};
use kinopt::io::gltf::{self, Scene, SceneMesh, ScenePosing, Skin};
use kinopt::io::ply;
use kinopt::mesh::TriangleMesh;
use kinopt::skinning::{MorphTarget, MorphTargets, SkinWeights, SkinningMethod};
use serde_json::json;

/// Flag of four corners: two on the pole at x = 0, two with a joint at x = 1. The clip "wave" rotates the joint about
/// y by a quarter turn in a second. The morph target "flat" moves corner 3.
fn flag() -> Scene {
    let bone = |name: &str, parent, translation: Vec3A| ArmatureBone {
        name: name.into(),
        parent,
        rest: LocalTransform {
            translation,
            ..LocalTransform::IDENTITY
        },
    };
    let bones = vec![
        bone("cloth", None, Vec3A::ZERO),
        bone("pole", None, Vec3A::ZERO),
        bone("hinge", Some(1), Vec3A::X),
    ];
    let armature = Armature::new(bones, vec!["flat".into()]).unwrap();
    let [cloth, pole, hinge] = ["cloth", "pole", "hinge"].map(|name| armature.bone(name).unwrap());
    let corners =
        [[0.0, 0.0], [0.0, 1.0], [2.0, 0.0], [2.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
    let triangles = vec![[0, 2, 1], [1, 2, 3]];
    let mut weights = SkinWeights::builder(4, 2);
    for (vertex, joint) in [(0, 0), (1, 0), (2, 1), (3, 1)] {
        weights.add(vertex, joint, 1.0).unwrap();
    }
    let target = MorphTarget::new("flat", vec![3], vec![Vec3::NEG_Y], Vec::new(), Vec::new());
    let mesh = SceneMesh {
        name: "flag".into(),
        bone: cloth,
        mesh: TriangleMesh::new(corners.to_vec(), Vec::new(), triangles).unwrap(),
        tangents: Vec::new(),
        morph_targets: MorphTargets::new(4, vec![target.unwrap()]).unwrap(),
        first_morph_weight: 0,
        skin: Some(Skin {
            name: String::new(),
            joints: vec![pole, hinge],
            joint_from_mesh: vec![Affine3A::IDENTITY, Affine3A::from_translation(Vec3::NEG_X)],
            weights: weights.build().unwrap(),
        }),
    };
    let quarter = Quat::from_rotation_y(-std::f32::consts::FRAC_PI_2);
    let mut wave = Clip::builder("wave", &armature);
    let turn = RotationCurve::slerp(vec![0.0, 1.0], vec![Quat::IDENTITY, quarter]).unwrap();
    wave.channel(hinge, Channel::Rotation(turn)).unwrap();
    let mut sink = Clip::builder("sink", &armature);
    let weights = KeyedCurve::linear(vec![0.5, 1.5], vec![0.0, 1.0]).unwrap();
    sink.morph_weight(0, weights).unwrap();
    let clips = vec![wave.build(), sink.build()];
    scene(armature, vec![mesh], clips)
}

fn written(folder: &Folder) -> String {
    folder.scene("flag.glb", &flag())
}

fn near(positions: &[Vec3], expected: [[f32; 3]; 4]) {
    assert_eq!(positions.len(), 4);
    for (a, b) in positions.iter().zip(expected.map(Vec3::from)) {
        assert!(a.distance(b) < 1e-6, "{a} instead of {b}");
    }
}

/// Vertices of the first mesh of a written scene.
fn posed(file: &str) -> Vec<Vec3> {
    let scene = gltf::read(file).unwrap();
    let mut posing = ScenePosing::new(&scene, SkinningMethod::LinearBlend).unwrap();
    let mesh = posing.mesh(scene.armature.rest()).unwrap();
    mesh.positions().to_vec()
}

#[test]
fn info_lists_nodes_clips_meshes_and_morph_targets() {
    let folder = Folder::new("scene-info");
    let file = written(&folder);
    let info = answer!("info {file}");
    has!(info, {"kind": "scene", "size": f64::sqrt(5.0), "notes": []});
    let wave = json!({"name": "wave", "start": 0.0, "end": 1.0});
    assert_eq!(
        info["clips"],
        json!([wave, {"name": "sink", "start": 0.5, "end": 1.5}])
    );
    assert_eq!(
        info["bones"][2],
        json!({"name": "hinge", "parent": "pole", "rest_position": [1.0, 0.0, 0.0], "joint": true})
    );
    assert_eq!(
        info["meshes"],
        json!([{"name": "flag", "bone": "cloth", "vertices": 4, "triangles": 2, "normals": false, "joints": 2, "max_influences": 1, "morph_targets": ["flat"]}])
    );
    let text = text!("info {file}");
    says!(text => "flag.glb (scene) | sink, 0.5 s to 1.5 s");
    says!(text => "flag on cloth: 4 vertices, 2 triangles, without normals, 2 joints");
    says!(text => "2 joints, at most 1 to a vertex, morph targets flat");
}

#[test]
fn fk_places_nodes_at_a_time_of_a_clip() {
    let folder = Folder::new("scene-fk");
    let file = written(&folder);
    let hinge =
        |time: &str| answer!("fk {file} --time={time} --frame=hinge")["frames"]["hinge"].clone();
    let placed = hinge("0.5");
    assert_eq!(placed["position"], json!([1.0, 0.0, 0.0]));
    let y = number(&placed["quaternion"][2]);
    assert!((y + (std::f64::consts::PI / 8.0).sin()).abs() < 1e-6, "{y}");
    // The other clip does not move it.
    assert_eq!(
        hinge("1 --clip=sink")["quaternion"],
        json!([1.0, 0.0, 0.0, 0.0])
    );
}

#[test]
fn animate_poses_a_clip_at_one_or_many_times() {
    let folder = Folder::new("scene-animate");
    let file = written(&folder);
    let [low, high] = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let turned = [low, high, [1.0, 0.0, 1.0], [1.0, 1.0, 1.0]];
    for (skinning, ending) in [("lbs", "glb"), ("lbs", "ply"), ("dqs", "ply")] {
        let out = folder.file(&format!("{skinning}.{ending}"));
        let document = answer!("animate {file} --time=1 @output.skinning={skinning} --out {out}");
        has!(document, {"vertices": 4, "skinning": skinning});
        match ending {
            "glb" => near(&posed(&out), turned),
            _ => near(ply::read(&out).unwrap().positions(), turned),
        }
    }
    // Viewers use linear blend skinning.
    let out = folder.file("dual.glb");
    refused!("animate {file} --time=1 @output.skinning=dqs --out {out}" => 2, "dual.glb | dqs");
    let out = folder.file("frames");
    let document = answer!("animate {file} --clip=sink --fps=2 --format=ply --out {out}");
    let frames = list(&document["frames"]);
    assert_eq!(frames.len(), 3);
    for (frame, weight) in frames.iter().zip([0.0, 0.5, 1.0]) {
        let path = word(&frame["file"]);
        assert!(path.ends_with(".ply"), "{path}");
        near(
            ply::read(path).unwrap().positions(),
            [low, high, [2.0, 0.0, 0.0], [2.0, 1.0 - weight, 0.0]],
        );
    }
    let (looped, held) = (folder.file("looped.ply"), folder.file("held.ply"));
    text!("animate {file} --time=2.25 --loop --out {looped}");
    text!("animate {file} --time=2.25 --out {held}");
    near(ply::read(&held).unwrap().positions(), turned);
    let quarter = std::f32::consts::FRAC_PI_8;
    let [x, z] = [1.0 + quarter.cos(), quarter.sin()];
    near(
        ply::read(&looped).unwrap().positions(),
        [low, high, [x, 0.0, z], [x, 1.0, z]],
    );
}

#[test]
fn rig_mesh_may_be_written_as_a_scene() {
    let (folder, rig) = Folder::with_rig("rig-as-scene");
    let (glb, ply) = (folder.file("posed.glb"), folder.file("posed.ply"));
    text!("animate {rig} --time=1.25 --out {glb}");
    text!("animate {rig} --time=1.25 --out {ply}");
    assert_eq!(
        gltf::read(&glb).unwrap().meshes[0].mesh,
        ply::read(&ply).unwrap()
    );
}

/// The pole is twice as long as it is wide; below it, the hinge is at (1, 0, 0) without scale.
#[test]
fn without_scale_drops_the_scales_of_bones() {
    let folder = Folder::new("scene-scale");
    let bone = |name: &str, parent, translation: Vec3A, scale: Vec3A| ArmatureBone {
        name: name.into(),
        parent,
        rest: LocalTransform {
            translation,
            scale,
            ..LocalTransform::IDENTITY
        },
    };
    let bones = vec![
        bone("pole", None, Vec3A::ZERO, Vec3A::new(2.0, 1.0, 1.0)),
        bone("hinge", Some(0), Vec3A::X, Vec3A::ONE),
        bone("end", Some(1), Vec3A::X, Vec3A::ONE),
    ];
    let armature = Armature::new(bones, Vec::new()).unwrap();
    let file = folder.scene("scaled.glb", &scene(armature, Vec::new(), Vec::new()));
    let dropped = "@model.without_scale=true";
    for (options, x) in [("", 4.0), (dropped, 2.0)] {
        let placed = answer!("fk {file} {options} --frame end");
        assert_eq!(placed["frames"]["end"]["position"], json!([x, 0.0, 0.0]));
        let info = answer!("info {file} {options}");
        assert_eq!(info["bones"][2]["rest_position"], json!([x, 0.0, 0.0]));
        let target = format!("--target end={x},0,0");
        let solved = answer!("solve {file} {options} {target}");
        assert_eq!(solved["reached"], true);
    }
    // The target is beyond the reach of the bones without scale.
    let solved = answer!("solve {file} {dropped} --target end=4,0,0");
    assert_eq!(solved["reached"], false);
    let panda = "../models/franka_panda.urdf";
    refused!("info {panda} {dropped}" => 2, "`without_scale` | scenes");
}

#[test]
fn conflicting_options_are_rejected() {
    let folder = Folder::new("scene-refused");
    let (file, rig, out) = (written(&folder), folder.rig(), folder.file("posed.glb"));
    let to = format!("--time=1 --out {out}");
    refused!("animate {file} {to} --clip=walk" => 1, "`walk` | wave, sink");
    refused!("animate {file} {to} --interpolation=linear" => 2, "--interpolation | scene");
    refused!("animate {rig} {to} --clip=walk" => 2, "rig.json | --clip");
    refused!("fk {rig} --time=1 --clip=walk" => 2, "--clip");

    let unskinned = folder.file("still.glb");
    gltf::write_mesh(&flag().meshes[0].mesh, &unskinned).unwrap();
    refused!("animate {unskinned} {to}" => 1, "still.glb | no clip");
    let mut bare = flag();
    bare.meshes.clear();
    let bare = folder.scene("bare.glb", &bare);
    refused!("animate {bare} {to}" => 1, "bare.glb | a mesh");

    let cut = folder.file("cut.glb");
    let bytes = std::fs::read(&file).unwrap();
    std::fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
    refused!("info {cut}" => 1, "cut.glb | byte 8");
    let content = r#"{"asset":{"version":"2.0"},"nodes":[{"name":"a","children":[4]}]}"#;
    let text = folder.text("bad.gltf", content);
    refused!("info {text}" => 1, "bad.gltf | nodes[0].children[0] | node 4");
}

#[test]
fn solve_moves_the_joints_of_a_scene() {
    let folder = Folder::new("scene-solve");
    let (file, out) = (written(&folder), folder.file("dragged.glb"));
    let solved = answer!("solve {file} --target=hinge=0,0,1 --out {out}");
    assert_eq!(solved["reached"], true);
    let corners = posed(&out);
    // The corner at the pole's joint stays. The far corner keeps its distance from the hinge.
    assert!(corners[0].length() < 1e-6);
    assert!((corners[1].length() - 1.0).abs() < 1e-6);
    assert!((corners[2].distance(Vec3::Z) - 1.0).abs() < 1e-6);
    refused!("solve {file} --target=hing=0,0,1" => 1, "`hing` | cloth, pole, hinge");
    // Nodes without skinned vertices are locked.
    let cloth = answer!("solve {file} --target=cloth=1,0,0");
    assert_eq!(cloth["reached"], false);
}

#[test]
fn empty_scene_has_no_size() {
    let folder = Folder::new("empty-scene");
    let file = folder.text("empty.gltf", r#"{"asset":{"version":"2.0"},"scenes":[{}]}"#);
    let text = text!("info {file}");
    assert!(!text.contains("inf ") && text.contains("size"), "{text}");
    assert_eq!(answer!("info {file}")["size"], 0.0);
}

#[test]
fn non_gltf_files_are_named() {
    let folder = Folder::new("no-gltf");
    for (name, content, words) in [
        ("rubbish.glb", "rubbish", "no JSON object"),
        ("empty.glb", "", "no JSON object"),
        ("list.gltf", "[1, 2]", "no JSON object"),
        ("other.gltf", "{\"bones\": []}", "missing field `asset`"),
    ] {
        let file = folder.text(name, content);
        refused!("info {file}" => 1, "{name}: not a glTF file: | {words}");
    }
}
