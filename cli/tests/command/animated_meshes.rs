//! Promise: `animate` writes the mesh in the pose of the keyframes, at one time or frame by frame.

use crate::forked_rig::*;
use glam::Vec3;
use kinopt::animation::{EulerInterpolation, Playback};
use kinopt::io::ply;
use kinopt::skinning::SkinningMethod;

/// Mesh at a time: each vertex moved by its bone, in double precision.
fn expected(time: f64, playback: Playback) -> Vec<Vec3> {
    let rig = rig();
    let mut q = vec![0.0; rig.skeleton.angles()];
    rig.clip.sample(time, playback, &mut q).unwrap();
    let pose = rig.skeleton.pose(&q).unwrap();
    let transforms: Vec<_> = pose.skinning_transforms(&rig.skeleton).collect();
    // Every vertex of this rig has one influence: bones 1 and 2 on the left, 3 and 4 on the right.
    let bone = |p: &Vec3| match (p.x < 0.0, p.x.abs() < 2.0) {
        (true, true) => 1,
        (true, false) => 2,
        (false, true) => 3,
        (false, false) => 4,
    };
    let mesh = rig.mesh.unwrap();
    let posed = mesh.positions().iter().map(|p| {
        let [x, y, z] = p.to_array().map(f64::from);
        let moved = transforms[bone(p)].apply([x, y, z].into());
        Vec3::from_array(moved.to_array().map(|x| x as f32))
    });
    posed.collect()
}

fn close(actual: &[Vec3], expected: &[Vec3]) {
    assert_eq!(actual.len(), expected.len());
    for (actual, expected) in actual.iter().zip(expected) {
        assert!(
            actual.distance(*expected) < 1e-5,
            "{actual} is not {expected}"
        );
    }
}

/// Vertices of a written file.
fn posed(file: &str) -> Vec<Vec3> {
    ply::read(file).unwrap().positions().to_vec()
}

#[test]
fn single_time_writes_one_file() {
    let folder = Folder::new("animate-time");
    let (rig, out) = (folder.rig(), folder.file("posed.ply"));
    for (options, playback) in [("lbs", Playback::Hold), ("dqs --loop", Playback::Loop)] {
        let text = text!("animate {rig} --time=2.3 --out {out} @output.skinning={options}");
        says!(text => "20 vertices | 2.3 s");
        close(&posed(&out), &expected(2.3, playback));
    }
}

#[test]
fn frames_are_numbered_files_at_even_times() {
    let folder = Folder::new("animate-frames");
    let (rig, out) = (folder.rig(), folder.file("deep/frames"));
    let document = answer!("animate {rig} --fps=10 --from=0.7 --to=1.4 --format=ply --out {out}");
    let frames = list(&document["frames"]);
    assert_eq!((frames.len(), count(&document["vertices"])), (8, 20));
    for (index, frame) in frames.iter().enumerate() {
        let (time, file) = (number(&frame["time"]), word(&frame["file"]));
        assert!((time - (0.7 + 0.1 * index as f64)).abs() < 1e-12);
        assert!(file.ends_with(&format!("frame-{index:04}.ply")), "{file}");
        close(&posed(file), &expected(time, Playback::Hold));
    }
    assert_eq!(std::fs::read_dir(&out).unwrap().count(), 8);

    // 0.29 · 100 is 28.999999999999996; the last frame is still written.
    let document = answer!("animate {rig} --fps=100 --from=0 --to=0.29 --out {out}");
    assert_eq!(list(&document["frames"]).len(), 30);

    // The default range is all keyframes, 0.5 s to 2 s.
    let all = folder.file("all");
    let document = answer!("animate {rig} --fps=4 --out {all}");
    assert_eq!(list(&document["frames"]).len(), 7);
    assert_eq!(document["skinning"], SkinningMethod::default().name());
    let text = std::fs::read_to_string(format!("{all}/frame-0006.obj")).unwrap();
    let vertices = text.lines().filter(|line| line.starts_with("v "));
    assert_eq!(vertices.count(), 20);
}

#[test]
fn unanimatable_input_is_an_error() {
    let folder = Folder::new("animate-refused");
    let (rig_file, out) = (folder.rig(), folder.file("frames"));
    let file = folder.file("posed.obj");
    refused!("animate {rig_file} --out {out}" => 2, "--time | --fps");
    // Options of frames are errors for one time.
    for option in ["--from=1", "--to=1", "--format=ply"] {
        let name = option.split_once('=').unwrap().0;
        refused!("animate {rig_file} --time=1 {option} --out {file}" => 2, "{name} | --time");
    }
    refused!("animate {rig_file} --time=1 --fps=2 --out {out}" => 2, "--fps");
    refused!("animate {rig_file} --time=1 --out {out}" => 2, "frames | .obj | .ply");
    refused!("animate {rig_file} --fps=2 --out {file}" => 2, "posed.obj | folder");
    refused!("animate {rig_file} --fps=0 --out {out}" => 2, "above 0");
    refused!("animate {rig_file} --fps=1e9 --out {out}" => 2, "1000000");
    refused!("animate {rig_file} --fps=2 --from=2 --to=1 --out {out}" => 2, "--from 2 | --to 1");
    refused!("animate {rig_file} --time=1 --out {file} @output.skinning=best" => 1, "lbs | dqs");
    assert!(!std::path::Path::new(&out).exists() && !std::path::Path::new(&file).exists());

    let unanimated = folder.changed("still.json", |rig| rig.clip = Default::default());
    refused!("animate {unanimated} --time=1 --out {file}" => 1, "still.json | keyframes");
    let bare = folder.changed("bare.json", |rig| (rig.weights, rig.mesh) = (None, None));
    refused!("animate {bare} --time=1 --out {file}" => 1, "bare.json | a mesh");
    let blocked = folder.file("rig.json/frames");
    refused!("animate {rig_file} --fps=2 --out {blocked}" => 1, "cannot be created");
}

#[test]
fn mesh_without_weights_follows_the_nearest_bones() {
    let folder = Folder::new("animate-no-weights");
    let bare = folder.changed("bare.json", |rig| rig.weights = None);
    let out = folder.file("posed.ply");
    let (_, messages) = answer!(with_messages "animate {bare} --time=2.3 --out {out}");
    says!(messages => "bare.json | no skin weights | heat");
    // Each vertex follows its limb; at joints it deviates by at most the thickness of the limb.
    let rest = rig().mesh.unwrap();
    let expected = expected(2.3, Playback::Hold);
    let total_distance = |actual: &[Vec3]| -> f32 {
        let each = actual.iter().zip(&expected);
        each.map(|(actual, expected)| actual.distance(*expected))
            .sum()
    };
    let (posed, at_rest) = (
        total_distance(&posed(&out)),
        total_distance(rest.positions()),
    );
    assert!(
        posed < 0.25 * at_rest,
        "off by {posed}, at rest by {at_rest}"
    );
}

/// Some published rigs lack their weights file. Bones, keyframes and mesh still work, and a note reports the missing
/// file.
#[test]
fn rig_with_a_missing_weights_file_is_posed() {
    let (folder, file) = Folder::with_rig("animate-missing-weights");
    std::fs::remove_file(folder.file("rig.dmat")).unwrap();
    let note = "rig.dmat does not exist";
    let out = folder.file("posed.ply");
    for (method, follows) in [("heat", "heat"), ("distance", "nearest")] {
        let (document, messages) = answer!(with_messages "animate {file} --time=2.3 --out {out} @output.skin_weights={method}");
        says!(messages => note);
        says!(word(&document["notes"][0]) => note);
        says!(word(&document["notes"][1]) => follows);
        assert_eq!(posed(&out).len(), rig().mesh.unwrap().positions().len());
    }
    for command in ["info", "fk --time=1"] {
        let (document, messages) = answer!(with_messages "{command} {file}");
        says!(messages => note);
        says!(word(&document["notes"][0]) => note);
    }
    // `--skin-weights` replaces the weights of the file, with a note.
    let other = Folder::new("animate-other-weights");
    let complete_rig = other.rig();
    let output = kinopt!("animate {complete_rig} --time=1 --out {out} @output.skin_weights=heat");
    says!(stderr(&output) => "are ignored");
}

#[test]
fn interpolation_option_is_applied() {
    let folder = Folder::new("animate-interpolation");
    let (file, out) = (folder.rig(), folder.file("posed.ply"));
    let angles = |file: &str, more: &str| numbers(&answer!("fk {file} --time=1.1 {more}")["q"]);
    // Linear interpolation between the neighbouring keys, computed by hand.
    let rig_data = rig();
    let mut straight = vec![0.0; rig_data.skeleton.angles()];
    for track in rig_data.clip.tracks() {
        let next = track.keys.iter().position(|key| key.time > 1.1).unwrap();
        let (a, b) = (track.keys[next - 1], track.keys[next]);
        let u = (1.1 - a.time) / (b.time - a.time);
        for k in 0..3 {
            straight[3 * track.bone.index() + k] = a.angles[k] + u * (b.angles[k] - a.angles[k]);
        }
    }
    let linear = angles(&file, "--interpolation linear");
    let apart = |a: &[f64], b: &[f64]| {
        let each = a.iter().zip(b).map(|(a, b)| (a - b).abs());
        each.fold(0.0, f64::max)
    };
    assert!(apart(&linear, &straight) < 1e-14);
    // The default is Catmull-Rom: Kochanek-Bartels with zero parameters.
    let default = angles(&file, "");
    assert_eq!(angles(&file, "--interpolation=catmull-rom"), default);
    let zeros = angles(&file, "--interpolation=kochanek-bartels:0,0,0");
    assert!(apart(&zeros, &default) < 1e-14 && apart(&linear, &default) > 1e-3);
    let tense = angles(&file, "--interpolation=kochanek-bartels:0.8,0,-0.3");
    assert!(apart(&tense, &default) > 1e-3);

    // Without the option, `fk` and `animate` use the interpolation of the file.
    let linear_file = folder.changed("linear.json", |rig| {
        let clip = std::mem::take(&mut rig.clip);
        rig.clip = clip.interpolated(|_| EulerInterpolation::Linear).unwrap();
    });
    for (file, name) in [(&file, "catmull-rom"), (&linear_file, "linear")] {
        assert_eq!(
            answer!("info {file}")["keyframes"]["interpolation"][0],
            name
        );
        says!(text!("info {file}") => name);
    }
    assert!(apart(&angles(&linear_file, ""), &linear) < 1e-14);
    let animated = |arguments: &str| {
        text!("animate {arguments} --time=1.1 --out {out}");
        posed(&out)
    };
    let by_option = animated(&format!("{file} --interpolation=linear"));
    close(&animated(&linear_file), &by_option);
    let pairs = by_option.iter().zip(expected(1.1, Playback::Hold));
    assert!(pairs.map(|(a, b)| a.distance(b)).fold(0.0, f32::max) > 1e-3);

    for (value, words) in [
        ("smooth", "smooth | catmull-rom"),
        ("kochanek-bartels:1,2", "tension | 3 numbers"),
        ("linear:1", "linear | no numbers"),
        ("kochanek-bartels:1e300,0,0", "--interpolation | 1e150"),
    ] {
        refused!("fk {file} --time=1 --interpolation {value}" => 2, "{words}");
    }
}
