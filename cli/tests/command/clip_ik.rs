//! Promise: `animate --reach` and `--plant` solve over a clip. The written file keeps all its other content.

use std::fs;

use crate::forked_rig::*;
use kinopt::animation::{Cursor, Playback};
use kinopt::io::gltf::{self, Scene};

/// Hips with an arm of two bones and two legs, at rest for two seconds; with a material and an unknown extension.
const FIGURE: &str = r#"{"asset":{"version":"2.0"},"extensionsUsed":["ACME_mood"],"extensions":{"ACME_mood":{"glad":1.50}},
 "materials":[{"name":"wool","pbrMetallicRoughness":{"metallicFactor":0.10}}],
 "nodes":[{"name":"hips","children":[1,4,7],"translation":[0,1,0]},
  {"name":"arm","children":[2],"translation":[0,0.5,0]},{"name":"forearm","children":[3],"translation":[0.3,0,0.05]},{"name":"hand","translation":[0.3,0,0.05]},
  {"name":"thigh.l","children":[5],"translation":[0.1,0,0]},{"name":"shin.l","children":[6],"translation":[0,-0.5,0.05]},{"name":"foot.l","translation":[0,-0.5,-0.05]},
  {"name":"thigh.r","children":[8],"translation":[-0.1,0,0]},{"name":"shin.r","children":[9],"translation":[0,-0.5,0.05]},{"name":"foot.r","translation":[0,-0.5,-0.05]}],
 "scene":0,"scenes":[{"nodes":[0]}],
 "buffers":[{"byteLength":32,"uri":"data:application/octet-stream;base64,AAAAAAAAAEAAAAAAAACAPwAAAAAAAAAAAACAPwAAAAA="}],
 "bufferViews":[{"buffer":0,"byteLength":8},{"buffer":0,"byteOffset":8,"byteLength":24}],
 "accessors":[{"bufferView":0,"componentType":5126,"type":"SCALAR","count":2,"min":[0],"max":[2]},{"bufferView":1,"componentType":5126,"type":"VEC3","count":2}],
 "animations":[{"name":"stand","samplers":[{"input":0,"output":1}],"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}]}]}"#;

fn bone_position(scene: &Scene, clip: &str, bone: &str, time: f64) -> kinopt::glam::Vec3 {
    let mut pose = scene.armature.rest().clone();
    let clip = scene.clip(clip).unwrap();
    clip.sample(time, Playback::Hold, &mut Cursor::new(), &mut pose)
        .unwrap();
    let bone = scene.armature.bone(bone).unwrap();
    scene
        .armature
        .model_from_bone(&pose, bone)
        .unwrap()
        .translation
        .into()
}

#[test]
fn reach_and_plant_keep_the_rest_of_the_file() {
    let folder = Folder::new("clip-ik");
    let (file, out) = (
        folder.text("figure.gltf", FIGURE),
        folder.file("figure.glb"),
    );
    let document = answer!(
        "animate {file} --fps=30 --reach hand=0.2,1.2,0.4 --span 0.5,1.5 --fade 0.25 --plant foot.l --plant foot.r --clip-name wave --into {out}"
    );
    assert_eq!(document["clip"], "wave");
    let stances = document["stances"].as_array().unwrap();
    assert_eq!(stances.len(), 2);
    assert!(
        stances
            .iter()
            .all(|stance| stance["slide"].as_f64().unwrap() < 1e-5)
    );
    assert_eq!(document["root_moved"], 0.0);
    let text = String::from_utf8_lossy(&fs::read(&out).unwrap()).into_owned();
    for extra in [r#""ACME_mood":{"glad":1.50}"#, r#""metallicFactor":0.10"#] {
        assert!(text.contains(extra), "{extra}");
    }
    let scene = gltf::read(&out).unwrap();
    let hand = |clip: &str, time| bone_position(&scene, clip, "hand", time);
    let target = kinopt::glam::Vec3::new(0.2, 1.2, 0.4);
    assert!(hand("wave", 1.0).distance(target) < 1e-4);
    for time in [0.0, 0.49, 1.51, 2.0] {
        assert!(hand("wave", time).distance(hand("stand", time)) < 1e-6);
    }
}

#[test]
fn curve_file_and_ground_shape_are_used() {
    let folder = Folder::new("clip-ik-curve");
    let (file, out) = (
        folder.text("figure.gltf", FIGURE),
        folder.file("figure.glb"),
    );
    let curve = folder.text(
        "curve.csv",
        "time,x,y,z\n0,0.3,1.3,0.3\n1,0.2,1.5,0.4\n2,0.3,1.7,0.2\n",
    );
    let ground = folder.text(
        "box.json",
        r#"{"boxes": [{"name": "step", "size": [0.1, 0.2, 1], "position": [0.1, 0.1, 0]}]}"#,
    );
    let document = answer!(
        "animate {file} --fps=30 --reach hand={curve} --plant foot.l --plant foot.r --ground {ground} --into {out} --clip-name up"
    );
    assert!(
        document["led"]
            .as_array()
            .unwrap()
            .iter()
            .all(|target| target["miss"].as_f64().unwrap() < 1e-4),
        "{document}"
    );
    let scene = gltf::read(&out).unwrap();
    assert!(
        bone_position(&scene, "up", "hand", 1.0).distance(kinopt::glam::Vec3::new(0.2, 1.5, 0.4))
            < 1e-4
    );
    // One foot is on the step, the other next to it. The hips rise by half the step.
    let height = |bone: &str| bone_position(&scene, "up", bone, 1.0).y;
    assert!((height("foot.l") - 0.2).abs() < 1e-4 && height("foot.r").abs() < 1e-4);
    assert!((height("hips") - 1.1).abs() < 0.1, "{}", height("hips"));
    refused!("animate {file} --fps=30 --reach hand=0,0 --into {out}" => 2, "3 numbers");
    refused!("animate {file} --fps=30 --reach wing=0,0,0 --into {out}" => 1, "`wing` | forearm");
    refused!("animate {file} --fps=30 --reach hand=0,1,0 --span 3,4 --into {out}" => 1, "from 3 s to 4 s");
    refused!("animate {file} --fps=30 --up z --into {out}" => 2, "--up | --plant");
    refused!("animate {file} --fps=30 --reach hand=0,1,0 --out {out}.obj" => 2, "--reach | .glb");
}

#[test]
fn rig_reaches_within_its_limits() {
    let folder = Folder::new("clip-ik-rig");
    let out = folder.file("humanoid.glb");
    let rig = &model("humanoid/humanoid.json");
    let document = answer!(
        "animate {rig} --fps=20 --reach left_hand=0.35,0.25,1.1 --span 1.2,2.6 --out {out}"
    );
    let target = &document["led"][0];
    assert_eq!(target["bone"], "left_hand");
    assert!(target["miss"].as_f64().unwrap() < 1e-3, "{target}");
    assert_eq!(document["root_moved"], 0.0);
}

#[test]
fn keys_of_a_rig_are_solved() {
    let folder = Folder::new("clip-ik-keys");
    let out = folder.file("changed.json");
    let rig = &model("humanoid/humanoid.json");
    let document = answer!(
        "animate {rig} --fps=30 --reach right_hand=0.3,-0.3,1.3 --span 0.9,2.2 --out {out}"
    );
    assert_eq!(document["led"][0]["bone"], "right_hand");
    let [before, after] = [rig, &out].map(|file| kinopt::io::rig::Rig::read(file).unwrap());
    assert_eq!(after.skeleton.bones().len(), before.skeleton.bones().len());
    let keys = |rig: &kinopt::io::rig::Rig| rig.clip.tracks().to_vec();
    let mut changed = 0;
    for (after, before) in keys(&after).iter().zip(&keys(&before)) {
        for (after, before) in after.keys.iter().zip(&before.keys) {
            let apart = [0, 1, 2].map(|k| (after.angles[k] - before.angles[k]).abs());
            let same = apart.iter().all(|apart| *apart < 1e-12);
            assert!(same || (0.9..=2.2).contains(&before.time));
            changed += usize::from(!same);
        }
    }
    assert!(changed > 0);
    refused!("animate {rig} --fps=30 --out {out}" => 1, "no reach and no planted bone");
    refused!("animate {rig} --fps=30 --plant left_foot --out {out}" => 2, "--plant");
}

#[test]
fn keys_beyond_a_limit_are_reported_by_joint() {
    let folder = Folder::new("clip-ik-beyond");
    let (over, out) = (folder.file("over.json"), folder.file("within.json"));
    let mut rig = kinopt::io::rig::Rig::read(model("humanoid/humanoid.json")).unwrap();
    let forearm = rig.skeleton.bone("right_forearm").unwrap();
    let upper = rig.skeleton.bones()[forearm.index()].limits[1].upper;
    let mut tracks = rig.clip.tracks().to_vec();
    let forearm_tracks = tracks.iter_mut().filter(|track| track.bone == forearm);
    for key in forearm_tracks.flat_map(|track| &mut track.keys) {
        key.angles[1] = upper + 0.2;
    }
    rig.clip = kinopt::animation::EulerClip::new(tracks).unwrap();
    rig.write(&over).unwrap();
    let command = format!(
        "animate {over} --fps=30 --reach right_hand=0.3,-0.3,1.3 --span 0.9,2.2 --out {out}"
    );
    let document = answer!("{command}");
    let exceeded = list(&document["beyond"]);
    assert_eq!(exceeded.len(), 1, "{exceeded:?}");
    assert_eq!(exceeded[0]["joint"], "right_forearm/bend");
    assert!(
        exceeded[0]["by"].as_f64().unwrap() > 0.2 - 1e-6,
        "{exceeded:?}"
    );
    let text = text!("{command}");
    says!(text => "`right_forearm/bend`: up to | rad beyond its limit");
}

#[test]
fn rig_with_z_up_is_upright_in_the_file() {
    let folder = Folder::new("clip-ik-up");
    let rig = &model("humanoid/humanoid.json");
    let head = |file: &str| {
        let scene = gltf::read(file).unwrap();
        let bone = scene.armature.bone("head").unwrap();
        let rest = scene.armature.rest();
        let placement = scene.armature.model_from_bone(rest, bone).unwrap();
        kinopt::glam::Vec3::from(placement.translation)
    };
    let [lying, standing] = ["lying.glb", "standing.glb"].map(|name| folder.file(name));
    answer!("animate {rig} --fps=5 --out {lying}");
    answer!("animate {rig} --fps=5 --up z --out {standing}");
    let (lying, standing) = (head(&lying), head(&standing));
    assert!(lying.z > 1.4 && standing.y > 1.4);
    // Right-handed rotation of z up to y up: x stays, z becomes y, and y becomes −z.
    assert!((standing - kinopt::glam::Vec3::new(lying.x, lying.z, -lying.y)).length() < 1e-5);
}
