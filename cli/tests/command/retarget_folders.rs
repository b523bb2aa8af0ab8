//! Promise: `retarget` accepts folders. Each movement becomes one complete file, and a repeated command keeps
//! finished files. Failures are reported and do not stop other movements. A folder holds the results of one query.

use std::path::Path;

use kinopt::motion::retarget::{BodyMap, FootShapes, RetargetOptions, UpAxis};
use kinopt::robot::{BaseJoint, Robot};
use kinopt_bindings::retarget_folder::{FolderSettings, MotionFolder};

use crate::forked_rig::*;

/// Figure of three joints that sinks for a second.
fn capture(named: &str) -> String {
    let joint = |name: &str, x: f64| {
        format!(
            "JOINT {name}\n{{\nOFFSET {x} -0.9 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{{\nOFFSET 0 0 0.1\n}}\n}}\n"
        )
    };
    let rows: String = (0..10)
        .map(|frame| format!("0 {} 0{}\n", 0.9 - 0.005 * f64::from(frame), " 0".repeat(9)))
        .collect();
    format!(
        "HIERARCHY\nROOT {named}\n{{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n\
         {}{}}}\nMOTION\nFrames: 10\nFrame Time: 0.1\n{rows}",
        joint("LeftFoot", 0.1),
        joint("RightFoot", -0.1)
    )
}

#[test]
fn interrupted_folder_is_continued() {
    let folder = Folder::new("retarget-folder");
    let (from, into) = (folder.file("from"), folder.file("into"));
    std::fs::create_dir_all(format!("{from}/deeper")).unwrap();
    for name in ["one.bvh", "two.bvh", "deeper/three.bvh"] {
        std::fs::write(format!("{from}/{name}"), capture("Hips")).unwrap();
    }
    std::fs::write(format!("{from}/broken.bvh"), "none").unwrap();
    std::fs::write(
        format!("{from}/nobody.bvh"),
        capture("Hips").replace("Foot", "Fin"),
    )
    .unwrap();
    std::fs::write(format!("{from}/notes.txt"), "not read").unwrap();
    let robot = model("aldebaran_nao.urdf");
    let command = format!("retarget {from} {robot} --base-joint free --out {into} --json");
    let run_with = |extra: &str, code: i32| -> serde_json::Value {
        let run = kinopt!("{command} {extra}");
        assert_eq!(
            run.status.code(),
            Some(code),
            "{}",
            String::from_utf8_lossy(&run.stderr)
        );
        serde_json::from_slice(&run.stdout).unwrap()
    };
    let first = run_with("", 1);
    has!(first, {"done": 3, "done_before": 0, "failed": 2});
    let errors: Vec<&str> = list(&first["clips"])
        .iter()
        .filter_map(|clip| clip["error"].as_str())
        .collect();
    assert!(
        errors[0].contains("HIERARCHY") && errors[1].contains("match no body parts"),
        "{errors:?}"
    );
    let written = |name: &str| Path::new(&into).join(name);
    for name in ["one.npz", "two.npz", "deeper/three.npz"] {
        assert!(written(name).exists(), "{name}");
    }
    assert!(!written("broken.npz").exists() && !written("nobody.npz").exists());
    // Simulated interruption: one file is missing, and a partial one has a temporary name.
    let complete = std::fs::read(written("two.npz")).unwrap();
    std::fs::rename(written("two.npz"), written(".part.two.npz")).unwrap();
    std::fs::write(format!("{from}/broken.bvh"), capture("Hips")).unwrap();
    std::fs::remove_file(format!("{from}/nobody.bvh")).unwrap();
    let second = run_with("", 0);
    has!(second, {"done": 2, "done_before": 2, "failed": 0});
    assert_eq!(std::fs::read(written("two.npz")).unwrap(), complete);
    assert!(!written(".part.two.npz").exists());
    assert_eq!(run_with("--overwrite", 0)["done"], 4);
    // Other options.
    refused!("{command} --whole" => 1, "results of other settings");
}

/// The command continues a folder that Python began through the library.
#[test]
fn folder_begun_by_the_library_is_continued() {
    let folder = Folder::new("retarget-begun");
    let (from, into) = (folder.file("from"), folder.file("into"));
    std::fs::create_dir_all(&from).unwrap();
    for name in ["one.bvh", "two.bvh"] {
        std::fs::write(format!("{from}/{name}"), capture("Hips")).unwrap();
    }
    let text = "{\"drives\": {\"Hips\": \"torso\", \"LeftFoot\": \"left_sole\"}, \"fps\": 20}";
    let map = folder.text("map.json", text);
    let file = model("aldebaran_nao.urdf");
    let robot = Robot::read(&file)
        .unwrap()
        .with_base_joint(BaseJoint::FREE)
        .unwrap();
    let mut options = RetargetOptions::default().with_shapes(FootShapes::of_files(&robot));
    options.contacts.speed = 0.2;
    let given = BodyMap::from_json(text, "").unwrap();
    let folder_query = FolderSettings::new(&robot, options)
        .with_map(&given)
        .with_up(UpAxis::Z)
        .with_whole(true);
    let found = MotionFolder::find(from.as_ref(), into.as_ref(), "npz").unwrap();
    std::fs::write(&found.begin(&folder_query, false).unwrap()[0].out, "done").unwrap();
    let command = format!(
        "retarget {from} {file} --base-joint free --map {map} --up z --whole --contact-speed 0.2 --out {into}"
    );
    let report = answer!("{command}");
    has!(report, {"done": 1, "done_before": 1});
    refused!("{command} --contact-height 0.1" => 1, "(contact_height): use another folder, or --overwrite");
    // The map has changed.
    std::fs::write(&map, text.replace("20", "25")).unwrap();
    refused!("{command}" => 1, "(fps)");
    std::fs::write(&map, text.replace("left", "right")).unwrap();
    refused!("{command}" => 1, "(map)");
}

#[test]
fn invalid_folders_are_rejected() {
    let folder = Folder::new("retarget-folders-wrong");
    let (from, into) = (folder.file("from"), folder.file("into"));
    std::fs::create_dir_all(&from).unwrap();
    let robot = model("aldebaran_nao.urdf");
    let command = format!("retarget {from} {robot} --base-joint free --out {into}");
    refused!("{command}" => 1, "allowed are .npy");
    std::fs::write(format!("{from}/a.bvh"), capture("Hips")).unwrap();
    std::fs::write(format!("{from}/a.npy"), "").unwrap();
    refused!("{command}" => 1, "would both be written");
    refused!("{command} --format bvh" => 2, "requires a figure");
    refused!("{command} --print-map" => 2, "to one movement");
    assert!(!Path::new(&into).exists());
}
