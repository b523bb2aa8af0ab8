//! Promise: `info`, `fk` and `animate` take scenes in glTF files, and any posed mesh may become one.

use crate::forked_rig::{Folder, json, kinopt, stderr, stdout};
use glam::{Affine3A, Quat, Vec3, Vec3A};
use kinopt::animation::curve::KeyedCurve;
use kinopt::animation::rotation::RotationCurve;
use kinopt::animation::{Armature, ArmatureBone, Channel, Clip, LocalTransform};
use kinopt::io::gltf::{self, Scene, SceneMesh, Skin, WriteOptions};
use kinopt::io::ply;
use kinopt::mesh::TriangleMesh;
use kinopt::skinning::{MorphTarget, MorphTargets, SkinWeights};
use serde_json::json;

/// A flag of four corners: two on the pole at x = 0, two that follow a joint at x = 1, which the
/// clip "wave" turns about y by a quarter turn in a second. The morph target "flat" moves corner 3.
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
    let corners = [
        [0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [2.0, 0.0, 0.0],
        [2.0, 1.0, 0.0],
    ];
    let mut weights = SkinWeights::builder(4, 2);
    for (vertex, joint) in [(0, 0), (1, 0), (2, 1), (3, 1)] {
        weights.add(vertex, joint, 1.0).unwrap();
    }
    let target = MorphTarget::new("flat", vec![3], vec![Vec3::NEG_Y], Vec::new(), Vec::new());
    let mesh = SceneMesh {
        name: "flag".into(),
        bone: cloth,
        mesh: TriangleMesh::new(
            corners.map(Vec3::from).to_vec(),
            Vec::new(),
            vec![[0, 2, 1], [1, 2, 3]],
        )
        .unwrap(),
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
    sink.morph_weight(
        0,
        KeyedCurve::linear(vec![0.5, 1.5], vec![0.0, 1.0]).unwrap(),
    )
    .unwrap();
    let clips = vec![wave.build(), sink.build()];
    Scene {
        armature,
        meshes: vec![mesh],
        clips,
        notes: Vec::new(),
    }
}

fn written(folder: &Folder) -> String {
    let path = folder.file("flag.glb");
    gltf::write(&flag(), &WriteOptions::default(), &path).unwrap();
    path
}

fn near(positions: &[Vec3], wanted: [[f32; 3]; 4]) {
    assert_eq!(positions.len(), 4);
    for (a, b) in positions.iter().zip(wanted.map(Vec3::from)) {
        assert!(a.distance(b) < 1e-6, "{a} instead of {b}");
    }
}

#[test]
fn info_lists_nodes_clips_meshes_and_morph_targets() {
    let folder = Folder::new("scene-info");
    let file = written(&folder);
    let info = json(&["info", &file, "--json"]);
    assert_eq!(info["kind"], "scene");
    assert_eq!(info["size"], f64::sqrt(5.0));
    assert_eq!(
        info["clips"],
        json!([{"name": "wave", "start": 0.0, "end": 1.0}, {"name": "sink", "start": 0.5, "end": 1.5}])
    );
    assert_eq!(
        info["bones"][2],
        json!({"name": "hinge", "parent": "pole", "rest_position": [1.0, 0.0, 0.0], "joint": true})
    );
    assert_eq!(
        info["meshes"],
        json!([{"name": "flag", "bone": "cloth", "vertices": 4, "triangles": 2, "normals": false, "joints": 2, "max_influences": 1, "morph_targets": ["flat"]}])
    );
    assert_eq!(info["notes"], json!([]));
    let output = kinopt(&["info", &file]);
    let text = stdout(&output);
    for words in [
        "flag.glb (scene)",
        "sink, 0.5 s to 1.5 s",
        "flag on cloth: 4 vertices, 2 triangles, without normals, 2 joints, at most 1 to a vertex, morph targets flat",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
}

#[test]
fn fk_places_nodes_at_a_time_of_a_clip() {
    let folder = Folder::new("scene-fk");
    let file = written(&folder);
    let placed = json(&["fk", &file, "--time=0.5", "--frame=hinge", "--json"]);
    assert_eq!(
        placed["frames"]["hinge"]["position"],
        json!([1.0, 0.0, 0.0])
    );
    let y = placed["frames"]["hinge"]["quaternion"][2].as_f64().unwrap();
    assert!((y + (std::f64::consts::PI / 8.0).sin()).abs() < 1e-6, "{y}");
    // The other clip leaves it alone.
    let placed = json(&format!(
        "fk {file} --time=1 --clip=sink --frame=hinge --json"
    ));
    assert_eq!(
        placed["frames"]["hinge"]["quaternion"],
        json!([1.0, 0.0, 0.0, 0.0])
    );
}

#[test]
fn animate_poses_a_clip_at_one_time_or_frame_by_frame() {
    let folder = Folder::new("scene-animate");
    let file = written(&folder);
    let turned = [
        [0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 0.0, 1.0],
        [1.0, 1.0, 1.0],
    ];
    for skinning in ["lbs", "dqs"] {
        let out = folder.file(&format!("{skinning}.glb"));
        let document = json(&format!(
            "animate {file} --time=1 --skinning {skinning} --out {out} --json"
        ));
        assert_eq!(document["vertices"], 4);
        assert_eq!(document["skinning"], skinning);
        near(gltf::read(&out).unwrap().meshes[0].mesh.positions(), turned);
    }
    let out = folder.file("frames");
    let document = json(&format!(
        "animate {file} --clip=sink --fps=2 --format=glb --out {out} --json"
    ));
    let frames = document["frames"].as_array().unwrap();
    assert_eq!(frames.len(), 3);
    for (frame, weight) in frames.iter().zip([0.0, 0.5, 1.0]) {
        let path = frame["file"].as_str().unwrap();
        assert!(path.ends_with(".glb"), "{path}");
        let corner = [2.0, 1.0 - weight, 0.0];
        let wanted = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0], corner];
        near(gltf::read(path).unwrap().meshes[0].mesh.positions(), wanted);
    }
    let looped = folder.file("looped.ply");
    json(&format!(
        "animate {file} --time=2.25 --loop --out {looped} --json"
    ));
    let held = folder.file("held.ply");
    json(&["animate", &file, "--time=2.25", "--out", &held, "--json"]);
    near(ply::read(&held).unwrap().positions(), turned);
    let quarter = std::f32::consts::FRAC_PI_8;
    let [x, z] = [1.0 + quarter.cos(), quarter.sin()];
    let wanted = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [x, 0.0, z], [x, 1.0, z]];
    near(ply::read(&looped).unwrap().positions(), wanted);
}

#[test]
fn a_rig_s_mesh_may_be_written_as_a_scene() {
    let folder = Folder::new("rig-as-scene");
    let rig = folder.rig();
    let (glb, ply) = (folder.file("posed.glb"), folder.file("posed.ply"));
    for out in [&glb, &ply] {
        json(&["animate", &rig, "--time=1.25", "--out", out, "--json"]);
    }
    assert_eq!(
        gltf::read(&glb).unwrap().meshes[0].mesh,
        ply::read(&ply).unwrap()
    );
}

#[test]
fn what_does_not_go_together_is_said() {
    let folder = Folder::new("scene-refused");
    let (file, rig, out) = (written(&folder), folder.rig(), folder.file("posed.glb"));
    let to = format!("--time=1 --out {out}");
    refused!("animate {file} {to} --clip=walk" => 1, "`walk` | wave, sink");
    refused!("animate {file} {to} --interpolation=linear" => 2, "--interpolation | scene");
    refused!("animate {rig} {to} --clip=walk" => 2, "rig.json | --clip");
    refused!("fk {rig} --time=1 --clip=walk" => 2, "--clip");

    let still = folder.file("still.glb");
    gltf::write_mesh(&flag().meshes[0].mesh, &still).unwrap();
    refused!("animate {still} {to}" => 1, "still.glb | no clip");
    let mut bare = flag();
    bare.meshes.clear();
    let path = folder.file("bare.glb");
    gltf::write(&bare, &WriteOptions::default(), &path).unwrap();
    refused!("animate {path} {to}" => 1, "bare.glb | a mesh");

    let cut = folder.file("cut.glb");
    let bytes = std::fs::read(&file).unwrap();
    std::fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
    refused!("info {cut}" => 1, "cut.glb | byte 8");
    let text = folder.file("bad.gltf");
    std::fs::write(
        &text,
        r#"{"asset":{"version":"2.0"},"nodes":[{"name":"a","children":[4]}]}"#,
    )
    .unwrap();
    refused!("info {text}" => 1, "bad.gltf | nodes[0].children[0] | node 4");
}

#[test]
fn solve_drags_the_joints_of_a_scene() {
    let folder = Folder::new("scene-solve");
    let (file, out) = (written(&folder), folder.file("dragged.glb"));
    let target = "--target=hinge=0,0,1";
    let solved = json(&["solve", &file, target, "--out", &out, "--json"]);
    assert_eq!(solved["reached"], true);
    let posed = gltf::read(&out).unwrap();
    let corners = posed.meshes[0].mesh.positions();
    // The corner at the joint of the pole stays; the far one is as far from the hinge as it was.
    assert!(corners[0].length() < 1e-6);
    assert!((corners[1].length() - 1.0).abs() < 1e-6);
    assert!((corners[2].distance(Vec3::Z) - 1.0).abs() < 1e-6);
    refused!("solve {file} --target=hing=0,0,1" => 1, "`hing` | cloth, pole, hinge");
    // What no skin follows is locked.
    let cloth = json(&["solve", &file, "--target=cloth=1,0,0", "--json"]);
    assert_eq!(cloth["reached"], false);
}

#[test]
fn an_empty_scene_has_no_size() {
    let folder = Folder::new("empty-scene");
    let file = folder.file("empty.gltf");
    std::fs::write(&file, r#"{"asset":{"version":"2.0"},"scenes":[{}]}"#).unwrap();
    let output = kinopt(&["info", &file]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    assert!(!text.contains("inf "), "{text}");
    assert!(text.contains("size"), "{text}");
    assert_eq!(json(&["info", &file, "--json"])["size"], 0.0);
}

#[test]
fn what_is_no_gltf_is_called_so() {
    let folder = Folder::new("no-gltf");
    for (name, content, words) in [
        ("rubbish.glb", "rubbish", "no JSON object"),
        ("empty.glb", "", "no JSON object"),
        ("list.gltf", "[1, 2]", "no JSON object"),
        ("other.gltf", "{\"bones\": []}", "missing field `asset`"),
    ] {
        let file = folder.file(name);
        std::fs::write(&file, content).unwrap();
        refused!("info {file}" => 1, "{name}: not a glTF file: | {words}");
    }
}
