//! Promise: poses and clips are added to a scene's file, which keeps its other content. A rig with its clip is
//! written as one animated file.

use crate::forked_rig::*;
use kinopt::animation::{Cursor, Playback, Pose};
use kinopt::io::gltf::{self, Scene};

/// Leg of two joints, with a material and an unknown extension. The first joint moves along x and rotates about y in
/// one second.
const WALKER: &str = r#"{"asset":{"version":"2.0"},"extensionsUsed":["ACME_mood"],"extensions":{"ACME_mood":{"glad":1.50}},
 "materials":[{"name":"wool","pbrMetallicRoughness":{"metallicFactor":0.10}}],
 "nodes":[{"name":"hip","children":[1],"translation":[0,1,0]},{"name":"knee","translation":[0,-0.5,0]}],"scene":0,"scenes":[{"nodes":[0]}],
 "buffers":[{"byteLength":64,"uri":"data:application/octet-stream;base64,AAAAAAAAgD8AAAAAAACAPwAAAAAAAEBAAACAPwAAAEAAAAAAAAAAAAAAAAAAAIA/AAAAAPMENT8AAAAA8wQ1Pw=="}],
 "bufferViews":[{"buffer":0,"byteLength":8},{"buffer":0,"byteOffset":8,"byteLength":24},{"buffer":0,"byteOffset":32,"byteLength":32}],
 "accessors":[{"bufferView":0,"componentType":5126,"type":"SCALAR","count":2,"min":[0],"max":[1]},{"bufferView":1,"componentType":5126,"type":"VEC3","count":2},{"bufferView":2,"componentType":5126,"type":"VEC4","count":2}],
 "animations":[{"name":"walk","samplers":[{"input":0,"output":1},{"input":0,"output":2}],"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}},{"sampler":1,"target":{"node":0,"path":"rotation"}}]}]}"#;

fn at(scene: &Scene, clip: &str, time: f64) -> Pose {
    let mut pose = scene.armature.rest().clone();
    let clip = scene.clip(clip).unwrap();
    clip.sample(time, Playback::Hold, &mut Cursor::new(), &mut pose)
        .unwrap();
    pose
}

fn keeps(file: &str) -> Scene {
    let bytes = std::fs::read(file).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    for extra in [r#""ACME_mood":{"glad":1.50}"#, r#""metallicFactor":0.10"#] {
        assert!(text.contains(extra), "{extra} is not in {text}");
    }
    gltf::read(file).unwrap()
}

#[test]
fn clips_are_appended_to_a_file() {
    let folder = Folder::new("scene-clips");
    let (file, out) = (
        folder.text("walker.gltf", WALKER),
        folder.file("walker.glb"),
    );
    let document = answer!("animate {file} --fps=10 --into {out}");
    has!(document, {"clip": "walk at 10", "file": out, "duration": 1.0});
    let scene = keeps(&out);
    for time in [0.0, 0.3, 1.0] {
        let [original, added] = ["walk", "walk at 10"].map(|clip| at(&scene, clip, time));
        assert!((original.translations()[0] - added.translations()[0]).length() < 1e-5);
        assert!(original.rotations()[0].abs_diff_eq(added.rotations()[0], 1e-5));
    }
    // The clip is added to the same file under another name. A used name is an error.
    refused!("animate {file} --fps=10 --clip-name=walk --into {out}" => 1, "walker.glb | `walk` | --clip-name");
    text!("animate {file} --fps=30 --in-place=hip --clip-name=spot --into {out}");
    let scene = keeps(&out);
    assert_eq!(scene.clips.len(), 3);
    let spot = at(&scene, "spot", 1.0);
    let start = at(&scene, "spot", 0.0);
    let moved = spot.translations()[0] - start.translations()[0];
    assert!(moved.x.abs() < 1e-5 && moved.z.abs() < 1e-5, "{moved}");
    assert!(spot.rotations()[0].abs_diff_eq(start.rotations()[0], 1e-5));
}

/// A full disk, simulated by a limit of 512 bytes per file.
#[cfg(unix)]
#[test]
fn failed_write_keeps_the_old_file() {
    let folder = Folder::new("full-disk");
    let (file, out) = (
        folder.text("walker.gltf", WALKER),
        folder.file("walker.glb"),
    );
    text!("animate {file} --fps=10 --into {out}");
    let before = std::fs::read(&out).unwrap();
    let kinopt = env!("CARGO_BIN_EXE_kinopt");
    let line = format!("trap '' XFSZ; ulimit -f 1; {kinopt} animate {file} --fps=60 --into {out}");
    let run = std::process::Command::new("sh")
        .args(["-c", &line])
        .output()
        .unwrap();
    assert_eq!(run.status.code(), Some(1));
    says!(String::from_utf8(run.stderr).unwrap() => "walker.glb");
    assert_eq!(std::fs::read(&out).unwrap(), before);
    let siblings = std::fs::read_dir(std::path::Path::new(&out).parent().unwrap()).unwrap();
    assert_eq!(siblings.count(), 2);
    // With enough disk space the file is written. A symbolic link stays a link.
    let link = folder.file("link.glb");
    std::os::unix::fs::symlink(&out, &link).unwrap();
    text!("animate {file} --fps=60 --into {link}");
    assert_eq!(keeps(&out).clips.len(), 3);
    assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
}

/// 3.3 s in single precision are 197.999997 frames at 60 per second; the last frame is still written.
#[test]
fn clip_is_written_to_its_end() {
    let folder = Folder::new("whole-clips");
    let longer = WALKER.replace("base64,AAAAAAAAgD8A", "base64,AAAAADMzU0AA");
    let file = folder.text("longer.gltf", &longer);
    let out = folder.file("longer.glb");
    text!("animate {file} --fps=60 --into {out}");
    let scene = gltf::read(&out).unwrap();
    let [original, added] = ["walk", "walk at 60"].map(|clip| scene.clip(clip).unwrap().duration());
    assert!((original - added).abs() < 1e-6, "{original} {added}");
}

#[test]
fn solved_pose_is_a_clip_with_one_key() {
    let folder = Folder::new("scene-poses");
    let (file, out) = (
        folder.text("walker.gltf", WALKER),
        folder.file("posed.gltf"),
    );
    let solved = answer!("solve {file} --target=knee=0.5,1,0 --into {out} @output.clip_name=kick");
    assert_eq!(solved["reached"], true);
    let scene = keeps(&out);
    assert_eq!(scene.clip("kick").unwrap().span(), [0.0, 0.0]);
    let pose = at(&scene, "kick", 0.0);
    let mut placements = Vec::new();
    scene
        .armature
        .local_to_model(&pose, &mut placements)
        .unwrap();
    let knee = placements[1].translation;
    assert!(
        (knee - kinopt::glam::Vec3A::new(0.5, 1.0, 0.0)).length() < 1e-5,
        "{knee}"
    );
    // The rest pose is unchanged.
    assert_eq!(scene.armature, gltf::read(&file).unwrap().armature);
    refused!("solve {file} --target=knee=0.5,1,0 --into {out} @output.clip_name=kick" => 1, "`kick`");
    let rig = folder.rig();
    refused!("solve {rig} --target=bone/1=0,1,0 --into {out}" => 2, "--into | rig");
}

#[test]
fn rig_is_written_as_one_animated_file() {
    let folder = Folder::new("rig-animated");
    let (rig_file, out) = (folder.rig(), folder.file("rig.glb"));
    let document = answer!("animate {rig_file} --fps=20 --format=glb --out {out}");
    has!(document, {"clip": "keys", "duration": 1.5});
    let scene = gltf::read(&out).unwrap();
    assert!(scene.meshes[0].skin.is_some());
    let rig_data = rig();
    let mut q = vec![0.0; rig_data.skeleton.angles()];
    rig_data.clip.sample(1.0, Playback::Hold, &mut q).unwrap();
    let posed = rig_data.skeleton.pose(&q).unwrap();
    let mut placements = Vec::new();
    // The first frame is the first key, at 0.5 s.
    scene
        .armature
        .local_to_model(&at(&scene, "keys", 0.5), &mut placements)
        .unwrap();
    for (bone, placement) in rig_data.skeleton.bone_ids().zip(&placements) {
        let tail = posed.tail(bone).unwrap().to_array().map(|x| x as f32);
        assert!(
            placement
                .translation
                .distance(kinopt::glam::Vec3A::from(tail))
                < 1e-5
        );
    }
    let fewer = folder.file("fewer.glb");
    let less = answer!("animate {rig_file} --fps=20 --reduce-keys=0.05,0.05 --out {fewer}");
    assert!(count(&less["keys"]) < count(&document["keys"]));
    let folded = folder.file("frames");
    refused!("animate {rig_file} --fps=20 --close-seam=0.2 --out {folded}" => 2, "--close-seam | .glb");
    refused!("animate {rig_file} --fps=20 --close-seam=9 --out {fewer}" => 1, "9 s | 1.5");
    refused!("animate {rig_file} --fps=20 --into {fewer}" => 2, "--into | rig");
    refused!("animate {rig_file} --time=1 --into {fewer}" => 2, "--into");
}

#[test]
fn clip_is_rejected_for_a_file_with_other_bones() {
    let folder = Folder::new("other-bones");
    let file = folder.text("walker.gltf", WALKER);
    let other = folder.text("other.gltf", WALKER.replace("knee", "elbow"));
    refused!("animate {file} --fps=10 --into {other}" => 1, "other.gltf | bones");
}
