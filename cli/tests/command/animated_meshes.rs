//! Promise: `animate` writes the mesh that the keyframes pose, at one time or frame by frame.

use crate::forked_rig::{Folder, json, kinopt, refused, rig, says, stderr, stdout};
use glam::Vec3;
use kinopt::animation::Playback;
use kinopt::io::ply;
use kinopt::skinning::SkinningMethod;

/// The mesh at a time: each vertex moved by its bone, in double precision.
fn expected(time: f64, playback: Playback) -> Vec<Vec3> {
    let rig = rig();
    let mut q = vec![0.0; rig.skeleton.angles()];
    rig.clip.sample(time, playback, &mut q).unwrap();
    let pose = rig.skeleton.pose(&q).unwrap();
    let transforms: Vec<_> = pose.skinning_transforms(&rig.skeleton).collect();
    // Every vertex of this rig follows one bone: 1 and 2 on the left, 3 and 4 on the right.
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

fn close(got: &[Vec3], expected: &[Vec3]) {
    assert_eq!(got.len(), expected.len());
    for (got, expected) in got.iter().zip(expected) {
        assert!(
            (*got - *expected).length() < 1e-5,
            "{got} is not {expected}"
        );
    }
}

#[test]
fn one_time_is_one_file() {
    let folder = Folder::new("animate-time");
    let (rig, out) = (folder.rig(), folder.file("posed.ply"));
    for (skinning, looped) in [("lbs", false), ("dqs", true)] {
        let mut arguments = vec![
            "animate",
            &rig,
            "--time=2.3",
            "--out",
            &out,
            "--skinning",
            skinning,
        ];
        let playback = match looped {
            true => Playback::Loop,
            false => Playback::Hold,
        };
        if looped {
            arguments.push("--loop");
        }
        let output = kinopt(&arguments);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert!(stdout(&output).contains("20 vertices") && stdout(&output).contains("2.3 s"));
        close(
            ply::read(&out).unwrap().positions(),
            &expected(2.3, playback),
        );
    }
}

#[test]
fn frames_are_numbered_files_at_even_times() {
    let folder = Folder::new("animate-frames");
    let (rig, out) = (folder.rig(), folder.file("deep/frames"));
    let document = json(&format!(
        "animate {rig} --fps=10 --from=0.7 --to=1.4 --format=ply --out {out} --json"
    ));
    let frames = document["frames"].as_array().unwrap();
    assert_eq!((frames.len(), document["vertices"].as_u64()), (8, Some(20)));
    for (number, frame) in frames.iter().enumerate() {
        let time = frame["time"].as_f64().unwrap();
        assert!((time - (0.7 + 0.1 * number as f64)).abs() < 1e-12);
        let file = frame["file"].as_str().unwrap();
        assert!(file.ends_with(&format!("frame-{number:04}.ply")), "{file}");
        close(
            ply::read(file).unwrap().positions(),
            &expected(time, Playback::Hold),
        );
    }
    assert_eq!(std::fs::read_dir(&out).unwrap().count(), 8);

    // By itself it is all keyframes, 0.5 s to 2 s.
    let all = folder.file("all");
    let document = json(&["animate", &rig, "--fps=4", "--out", &all, "--json"]);
    assert_eq!(document["frames"].as_array().unwrap().len(), 7);
    assert_eq!(document["skinning"], SkinningMethod::default().name());
    let text = std::fs::read_to_string(format!("{all}/frame-0006.obj")).unwrap();
    assert_eq!(
        text.lines().filter(|line| line.starts_with("v ")).count(),
        20
    );
}

#[test]
fn what_cannot_be_animated_is_said() {
    let folder = Folder::new("animate-refused");
    let (rig_file, out) = (folder.rig(), folder.file("frames"));
    let file = folder.file("posed.obj");
    refused!("animate {rig_file} --out {out}" => 2, "--time | --fps");
    // What only frames have is not silently left out for one time.
    for option in ["--from=1", "--to=1", "--format=ply"] {
        let name = option.split_once('=').unwrap().0;
        refused!("animate {rig_file} --time=1 {option} --out {file}" => 2, "{name} | --time");
    }
    refused!("animate {rig_file} --time=1 --fps=2 --out {out}" => 2, "--fps");
    refused!("animate {rig_file} --time=1 --out {out}" => 2, "frames | .obj | .ply");
    refused!("animate {rig_file} --fps=2 --out {file}" => 2, "posed.obj | folder");
    refused!("animate {rig_file} --fps=0 --out {out}" => 2, "above 0");
    refused!("animate {rig_file} --fps=1e9 --out {out}" => 2, "1000000");
    let turned = [
        "animate", &rig_file, "--fps=2", "--from=2", "--to=1", "--out", &out,
    ];
    refused(&turned, 2, "--from 2 | --to 1");
    refused!("animate {rig_file} --time=1 --out {file} --skinning best" => 2, "lbs | dqs");
    assert!(!std::path::Path::new(&out).exists() && !std::path::Path::new(&file).exists());

    let mut still = rig();
    still.clip = Default::default();
    let still = folder.write("still.json", &still);
    refused!("animate {still} --time=1 --out {file}" => 1, "still.json | keyframes");
    let mut bare = rig();
    (bare.weights, bare.mesh) = (None, None);
    let bare = folder.write("bare.json", &bare);
    refused!("animate {bare} --time=1 --out {file}" => 1, "bare.json | a mesh");
    let blocked = folder.file("rig.json/frames");
    refused!("animate {rig_file} --fps=2 --out {blocked}" => 1, "cannot be made");
}

#[test]
fn a_mesh_without_weights_follows_the_nearest_bones() {
    let folder = Folder::new("animate-no-weights");
    let mut bare = rig();
    bare.weights = None;
    let bare = folder.write("bare.json", &bare);
    let out = folder.file("posed.ply");
    let output = kinopt(&["animate", &bare, "--time=2.3", "--out", &out]);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(0), "{message}");
    assert!(message.contains("bare.json") && message.contains("no skin weights"));
    assert!(message.contains("heat"), "{message}");
    // The skin goes with the limbs it is on, within its own thickness at the joints.
    let posed = ply::read(&out).unwrap();
    let rest = rig().mesh.unwrap();
    let expected = expected(2.3, Playback::Hold);
    let off = |got: &[Vec3]| -> f32 {
        let each = got.iter().zip(&expected);
        each.map(|(got, expected)| got.distance(*expected)).sum()
    };
    let (posed, still) = (off(posed.positions()), off(rest.positions()));
    assert!(posed < 0.25 * still, "off by {posed}, at rest by {still}");
}

/// As some rigs are published: bones, keyframes and mesh work, and what is missing is said.
#[test]
fn a_rig_whose_weights_file_is_missing_is_posed() {
    let folder = Folder::new("animate-missing-weights");
    let file = folder.rig();
    std::fs::remove_file(folder.file("rig.dmat")).unwrap();
    let note = "rig.dmat does not exist";
    let out = folder.file("posed.ply");
    for way in ["heat", "distance"] {
        let arguments = ["animate", &file, "--time=2.3", "--out", &out, "--json"];
        let output = kinopt(&[&arguments[..], &["--skin-weights", way]].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert!(stderr(&output).contains(note), "{}", stderr(&output));
        let document: serde_json::Value = serde_json::from_str(stdout(&output)).unwrap();
        let notes = &document["notes"];
        assert!(notes[0].as_str().unwrap().contains(note), "{notes}");
        let follows = if way == "heat" { "heat" } else { "nearest" };
        assert!(notes[1].as_str().unwrap().contains(follows), "{notes}");
        assert_eq!(
            ply::read(&out).unwrap().positions().len(),
            rig().mesh.unwrap().positions().len()
        );
    }
    for command in [&["info", &file][..], &["fk", &file, "--time=1"]] {
        let output = kinopt(&[command, &["--json"]].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert!(stderr(&output).contains(note));
        let document: serde_json::Value = serde_json::from_str(stdout(&output)).unwrap();
        let notes = &document["notes"];
        assert!(notes[0].as_str().unwrap().contains(note), "{notes}");
    }
    // What the file does give may be made up anew, which is said too.
    let other = Folder::new("animate-other-weights");
    let output = kinopt(&[
        "animate",
        &other.rig(),
        "--time=1",
        "--out",
        &out,
        "--skin-weights=heat",
    ]);
    says(stderr(&output), "not taken");
}

#[test]
fn keys_are_interpolated_as_asked() {
    let folder = Folder::new("animate-interpolation");
    let (file, out) = (folder.rig(), folder.file("posed.ply"));
    let angles = |more: &[&str], file: &str| {
        let fixed = ["fk", file, "--time=1.1", "--json"];
        let document = json(&[&fixed[..], more].concat());
        let q = document["q"].as_array().unwrap().clone();
        q.iter().map(|q| q.as_f64().unwrap()).collect::<Vec<f64>>()
    };
    // A straight line between the keys on either side, by hand.
    let own = rig();
    let mut straight = vec![0.0; own.skeleton.angles()];
    for track in own.clip.tracks() {
        let next = track.keys.iter().position(|key| key.time > 1.1).unwrap();
        let (a, b) = (track.keys[next - 1], track.keys[next]);
        let u = (1.1 - a.time) / (b.time - a.time);
        for k in 0..3 {
            straight[3 * track.bone.index() + k] = a.angles[k] + u * (b.angles[k] - a.angles[k]);
        }
    }
    let linear = angles(&["--interpolation", "linear"], &file);
    for (got, expected) in linear.iter().zip(&straight) {
        assert!((got - expected).abs() < 1e-14);
    }
    // The default is Catmull-Rom, which is Kochanek-Bartels with zeros.
    let apart = |a: &[f64], b: &[f64]| {
        let each = a.iter().zip(b).map(|(a, b)| (a - b).abs());
        each.fold(0.0, f64::max)
    };
    let default = angles(&[], &file);
    assert_eq!(angles(&["--interpolation=catmull-rom"], &file), default);
    let zeros = angles(&["--interpolation=kochanek-bartels:0,0,0"], &file);
    assert!(apart(&zeros, &default) < 1e-14 && apart(&linear, &default) > 1e-3);
    let tense = angles(&["--interpolation=kochanek-bartels:0.8,0,-0.3"], &file);
    assert!(apart(&tense, &default) > 1e-3);

    // A file's own word counts where the command says nothing, and `animate` takes it too.
    let mut asked = rig();
    asked.clip = asked
        .clip
        .interpolated(|_| kinopt::animation::EulerInterpolation::Linear)
        .unwrap();
    let linear_file = folder.write("linear.json", &asked);
    for (file, name) in [(&file, "catmull-rom"), (&linear_file, "linear")] {
        let info = json(&["info", file, "--json"]);
        assert_eq!(info["keyframes"]["interpolation"][0], name);
        assert!(stdout(&kinopt(&["info", file])).contains(name));
    }
    assert!(apart(&angles(&[], &linear_file), &linear) < 1e-14);
    let animated = |arguments: &[&str]| {
        let fixed = ["--time=1.1", "--out", &out];
        let output = kinopt(&[&["animate"][..], arguments, &fixed].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        ply::read(&out).unwrap().positions().to_vec()
    };
    let by_option = animated(&[&file, "--interpolation=linear"]);
    close(&animated(&[&linear_file]), &by_option);
    let off = by_option.iter().zip(expected(1.1, Playback::Hold));
    assert!(off.map(|(a, b)| a.distance(b)).fold(0.0, f32::max) > 1e-3);

    for (value, words) in [
        ("smooth", "smooth | catmull-rom"),
        ("kochanek-bartels:1,2", "tension | 3 numbers"),
        ("linear:1", "linear | no numbers"),
        ("kochanek-bartels:1e300,0,0", "--interpolation | 1e150"),
    ] {
        refused!("fk {file} --time=1 --interpolation {value}" => 2, "{words}");
    }
}
