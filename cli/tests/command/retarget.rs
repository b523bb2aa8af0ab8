//! Promise: `retarget` brings an array of joint positions onto a robot, frame by frame or as one problem, and writes
//! the files of humanoid learning. Errors of files and options are reported, and no file is written.

use kinopt::collision::{Checker, World};
use kinopt::robot::{BaseJoint, Robot};

use crate::forked_rig::*;

const MAP: &str = r#"{"joints": ["hips", "left", "right"], "fps": 30,
  "drives": {"hips": "torso", "left": "left_sole", "right": "right_sole"}}"#;

/// A .npy of (frames, 3, 3): a hip that sways over two feet.
fn sway(frames: usize) -> Vec<u8> {
    sway_over(frames, |_| 0.0)
}

/// Swaying hip, with the left foot at a height per frame, in metres.
fn sway_over(frames: usize, high: impl Fn(usize) -> f32) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({frames}, 3, 3), }}");
    bytes.extend(format!("{header:<117}\n").bytes());
    for frame in 0..frames {
        let aside = 0.05 * (frame as f32 * 0.2).sin();
        for position in [
            [0.0, aside, 0.9],
            [0.0, 0.15, high(frame)],
            [0.0, -0.15, 0.0],
        ] {
            bytes.extend(position.iter().flat_map(|number| number.to_le_bytes()));
        }
    }
    bytes
}

fn array(folder: &Folder, name: &str, bytes: &[u8]) -> String {
    let path = folder.file(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

/// Two contact points of one foot are distinguished by their positions.
#[test]
fn contact_points_are_reported_with_their_frames() {
    let folder = Folder::new("retarget-standing");
    let drives = r#""left": {"frame": "left_sole", "offset": [0.05, 0, 0]}, "right": {"frame": "left_sole", "offset": [-0.05, 0.01, 0]}"#;
    let map = folder.text(
        "map.json",
        format!(
            r#"{{"joints": ["hips", "left", "right"], "drives": {{"hips": "torso", {drives}}}, "contacts": ["left", "right"]}}"#
        ),
    );
    let source = array(&folder, "sway.npy", &sway(6));
    let robot = model("aldebaran_nao.urdf");
    let out = folder.file("sway.json");
    let command = format!("retarget {source} {robot} --map {map} --base-joint free --fps 30");
    let _ = answer!("{command} --out {out}");
    let text = std::fs::read_to_string(&out).unwrap();
    let written: serde_json::Value = serde_json::from_str(&text).unwrap();
    has!(written, {"contact_frames": ["left_sole", "left_sole"], "contact_points": [[0.05, 0.0, 0.0], [-0.05, 0.01, 0.0]]});
}

/// Errors in the map's entries for an array name the map file.
#[test]
fn errors_of_a_map_name_the_map() {
    let folder = Folder::new("retarget-map-mistakes");
    let source = array(&folder, "sway.npy", &sway(2));
    let robot = model("aldebaran_nao.urdf");
    for (from, to, message) in [
        ("\"fps\": 30", "\"fps\": -30", "map.json: | frames a second"),
        (
            "\"right\"],",
            "\"left\"],",
            "map.json: | `left` is named twice",
        ),
    ] {
        assert!(MAP.contains(from));
        let map = folder.text("map.json", MAP.replacen(from, to, 1));
        let out = folder.file("sway.json");
        let command =
            format!("retarget {source} {robot} --map {map} --base-joint free --out {out}");
        refused!("{command}" => 1, "{message}");
        assert!(!std::path::Path::new(&out).exists());
    }
}

/// A foot on the ground, then on a step of 0.3 m. It moves fast only between them.
#[test]
fn contacts_are_detected_by_speed_and_height() {
    let folder = Folder::new("retarget-contacts");
    let text = MAP.replace("\"fps\"", "\"contacts\": [\"left\"], \"fps\"");
    let map = folder.text("map.json", &text);
    let high = |frame: usize| (frame as f32 / 10.0 - 1.0).clamp(0.0, 1.0) * 0.3;
    let source = array(&folder, "sway.npy", &sway_over(30, high));
    let robot = model("aldebaran_nao.urdf");
    for (options, frames) in [
        ("", [true, false, true]),
        ("--contact-speed 10", [true, true, true]),
        ("--contact-height 0.05", [true, false, false]),
    ] {
        let out = folder.file("sway.json");
        let _ = answer!(
            "retarget {source} {robot} --map {map} --base-joint free {options} --out {out}"
        );
        let text = std::fs::read_to_string(&out).unwrap();
        let written: serde_json::Value = serde_json::from_str(&text).unwrap();
        let contacts = list(&written["contacts"]);
        let in_contact = [3, 15, 26].map(|frame| contacts[frame][0] == true);
        assert_eq!(in_contact, frames, "{options}");
    }
    refused!("retarget {source} {robot} --map {map} --contact-speed=-1 --out {source}.npz" => 2, "contact-speed");
}

#[test]
fn swaying_subject_is_retargeted_to_a_robot() {
    let folder = Folder::new("retarget");
    let map = folder.text("map.json", MAP);
    let source = array(&folder, "sway.npy", &sway(12));
    let robot = model("aldebaran_nao.urdf");
    for mode in ["", "--whole"] {
        let out = folder.file("sway.json");
        let report =
            answer!("retarget {source} {robot} --map {map} --base-joint free {mode} --out {out}");
        assert_eq!(report["frames"], 12);
        assert_eq!(report["fps"], 30.0);
        let text = std::fs::read_to_string(&out).unwrap();
        let written: serde_json::Value = serde_json::from_str(&text).unwrap();
        let names = list(&written["names"]);
        assert_eq!(names[0], "root_joint/x");
        assert_eq!(list(&written["q"]).len(), 12);
        assert!(
            list(&written["q"])
                .iter()
                .all(|q| list(q).len() == names.len())
        );
        // The joint names do not identify feet, so there are no contacts.
        for none in ["contact_frames", "contact_points"] {
            assert!(list(&written[none]).is_empty());
        }
    }
    // A fixed root causes a note, unless it is requested.
    for (base, notes) in [("", 1), ("--base-joint fixed", 0), ("--base-joint free", 0)] {
        let out = folder.file("base.json");
        let (_, messages) =
            answer!(with_messages "retarget {source} {robot} --map {map} {base} --out {out}");
        assert_eq!(
            messages.matches("--base-joint free").count(),
            notes,
            "{messages}"
        );
    }
    let csv = folder.file("sway.csv");
    let _ = answer!("retarget {source} {robot} --map {map} --base-joint free --out {csv}");
    let text = std::fs::read_to_string(&csv).unwrap();
    assert_eq!(text.lines().count(), 12);
    let npz = folder.file("sway.npz");
    let _ = answer!("retarget {source} {robot} --map {map} --base-joint free --out {npz}");
    let bytes = std::fs::read(&npz).unwrap();
    for name in [
        "q.npy",
        "fps.npy",
        "names.npy",
        "contacts.npy",
        "contact_frames.npy",
        "contact_points.npy",
    ] {
        let found = bytes
            .windows(name.len())
            .any(|window| window == name.as_bytes());
        assert!(found, "{name}");
    }
}

#[test]
fn self_collisions_are_avoided_on_request() {
    let folder = Folder::new("retarget-clear");
    let map = folder.text("map.json", MAP);
    let source = array(&folder, "sway.npy", &sway(4));
    let robot = model("aldebaran_nao.urdf");
    let out = folder.file("sway.json");
    let command = format!("retarget {source} {robot} --map {map} --base-joint free --out {out}");
    for margin in ["0", "0.002"] {
        assert_eq!(answer!("{command} --margin {margin}")["frames"], 4);
    }
    refused!("{command} --margin=-1" => 2, "--margin");
}

/// A pole at the head is avoided, frame by frame and as one problem.
#[test]
fn world_collisions_are_avoided_on_request() {
    let folder = Folder::new("retarget-world");
    let map = folder.text("map.json", MAP);
    let source = array(&folder, "sway.npy", &sway(6));
    let robot = model("aldebaran_nao.urdf");
    let out = folder.file("sway.json");
    let command = format!("retarget {source} {robot} --map {map} --base-joint free --out {out}");
    let pole =
        r#"{"boxes": [{"name": "pole", "size": [0.04, 0.04, 2], "position": [0.08, 0, 0]}]}"#;
    let world = folder.text("pole.json", pole);
    let body = Robot::read(&robot).unwrap();
    let body = body.with_base_joint(BaseJoint::FREE).unwrap();
    let checker = Checker::of(&body).unwrap();
    let checker = checker.with_world(&World::read(&world).unwrap()).unwrap();
    let touches = || {
        let written: serde_json::Value =
            serde_json::from_str(&std::fs::read_to_string(&out).unwrap()).unwrap();
        let frames = list(&written["q"]).iter().filter(|q| {
            let q: Vec<f64> = list(q)
                .iter()
                .filter_map(serde_json::Value::as_f64)
                .collect();
            !checker.collisions(&q).unwrap().is_empty()
        });
        frames.count()
    };
    let report = answer!("{command} --margin 0");
    assert!(report["stride"].as_f64().unwrap() < 1.0, "{report}");
    assert!(touches() > 0);
    for how in ["", "--margin 0.002 --whole"] {
        let (_, messages) = answer!(with_messages "{command} --world {world} {how}");
        assert!(!messages.contains("remain in collision"), "{messages}");
        assert_eq!(touches(), 0, "{how}");
    }
    // The distance of the subject's pole is scaled by the ratio of step lengths.
    let stride = answer!("{command} --world {world}")["stride"]
        .as_f64()
        .unwrap();
    let persons = World::read(&world).unwrap().scaled(1.0 / stride).unwrap();
    let persons = folder.text("persons.json", persons.to_json());
    for scale in ["stride".to_owned(), stride.to_string()] {
        answer!("{command} --world {persons} --world-scale {scale}");
        assert_eq!(touches(), 0, "{scale}");
    }
    refused!("{command} --world {persons} --world-scale 0" => 2, "number > 0, or `stride`");
    refused!("{command} --world-scale 2" => 2, "--world");
    // A collision with an attached object cannot be avoided and is reported.
    let held = r#"{"boxes": [{"name": "crate", "size": [1, 1, 1], "attached": "torso"}]}"#;
    let world = folder.text("crate.json", held);
    let (_, messages) = answer!(with_messages "{command} --world {world}");
    says!(messages => "remain in collision, first frame 0");
    refused!("{command} --margin=-1" => 2, "margin");
    refused!("{command} --world none.json" => 1, "none.json");
    let rig = model("humanoid/humanoid.json");
    refused!("retarget {rig} {rig} --world {world} --out {out}" => 2, "--world applies to robots");
}

#[test]
fn errors_write_no_file() {
    let folder = Folder::new("retarget-wrong");
    let (map, robot) = (folder.text("map.json", MAP), model("aldebaran_nao.urdf"));
    let source = array(&folder, "sway.npy", &sway(3));
    let short = array(&folder, "short.npy", &sway(3)[..200]);
    let foreign = folder.text(
        "foreign.json",
        r#"{"joints": ["hips", "left", "right"], "drives": {"g1.urdf": {"hips": "pelvis"}}}"#,
    );
    let nobody = folder.text("nobody.json", MAP.replace("torso", "pelvis"));
    let nothing = folder.text(
        "nothing.json",
        r#"{"joints": ["hips", "left", "right"], "drives": {}}"#,
    );
    let out = folder.file("out.npz");
    let lacking = "foreign.json: the map drives no frame of this target;";
    let empty = "nothing.json: the map drives no frame";
    for (source, map, more, code, words) in [
        (&source, &map, ".txt", 2, ".npz"),
        (&robot, &map, "", 2, ".npy"),
        (&short, &map, "", 1, "damaged"),
        (&source, &foreign, "", 1, lacking),
        (&source, &nobody, "", 1, "pelvis"),
        (&source, &nothing, "", 1, empty),
        (&source, &map, " --fps 0", 2, "fps"),
    ] {
        let run = kinopt!("retarget {source} {robot} --map {map} --out {out}{more}");
        let messages = String::from_utf8(run.stderr).unwrap();
        assert_eq!(run.status.code(), Some(code), "{messages}");
        says!(messages => words);
        assert!(!std::path::Path::new(&out).exists());
    }
}
