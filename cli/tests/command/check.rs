//! Promise: `check` reports pairs in contact with their penetration depth, or the nearest pair. It exits with code 1
//! if a pair is nearer than the margin.

use crate::forked_rig::*;
use serde_json::json;

/// Bar of 1 m along x that rotates about z, collision-free next to its pole.
const BAR: &str = r#"<robot name="bar">
  <link name="pole"/>
  <link name="bar"><collision><origin xyz="0.5 0 0"/><geometry><box size="1 0.1 0.1"/></geometry></collision></link>
  <joint name="turn" type="revolute"><parent link="pole"/><child link="bar"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/></joint></robot>"#;
const WORLD: &str = r#"{"spheres": [{"name": "ball", "radius": 0.2, "position": [0.5, 0.5, 0]}],
  "boxes": [{"name": "wall", "size": [0.1, 4, 4], "position": [2, 0, 0]}]}"#;
const SCENE: &str = "world:
  collision_objects:
    - id: can
      primitive_poses: [{position: [0, 0.9, 0], orientation: [0, 0, 0, 1]}]
      primitives: [{type: cylinder, dimensions: [0.4, 0.1]}]
";

#[test]
fn contacts_are_reported_with_their_depth() {
    let folder = Folder::new("check");
    let (robot, world) = (
        folder.text("bar.urdf", BAR),
        folder.text("world.json", WORLD),
    );
    // At 0° the ball's lowest point is 0.3 m above the axis, and the bar's side is at 0.05 m.
    let free = answer!("check {robot} --q 0 --world {world}");
    has!(free, {"free": true, "q": [0.0], "margin": 0.0, "collisions": []});
    has!(free["nearest"], {"first": "bar", "second": "ball"});
    let apart = free["nearest"]["distance"].as_f64().unwrap();
    assert!((apart - 0.25).abs() < 1e-12, "{apart}");
    let text = text!("check {robot} --q 0 --world {world}");
    assert_eq!(
        text,
        "free: link `bar` and obstacle `ball` are nearest, 250.000 mm apart\n"
    );

    // At 45° the ball's centre is on the bar's axis: the penetration depth is the radius plus half the bar's width.
    let run = kinopt!("check {robot} --q 45 --degrees --world {world} --json");
    assert_eq!(run.status.code(), Some(1));
    let report: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
    let [pair] = list(&report["collisions"]) else {
        panic!("{report}")
    };
    has!(pair, {"first": "bar", "second": "ball", "on_the_way": false});
    has!(pair, {"first_kind": "link", "second_kind": "obstacle"});
    let depth = -pair["distance"].as_f64().unwrap();
    assert!((depth - 0.25).abs() < 1e-12, "{depth}");
    assert_eq!(report["free"], false);
    let messages = String::from_utf8(run.stderr).unwrap();
    says!(messages => "1 pair is in contact");
}

#[test]
fn margin_counts_nearby_pairs() {
    let folder = Folder::new("check-margin");
    let (robot, world) = (
        folder.text("bar.urdf", BAR),
        folder.text("world.json", WORLD),
    );
    let run = kinopt!("check {robot} --q 0 --world {world} --margin 0.3");
    assert_eq!(run.status.code(), Some(1));
    let text = String::from_utf8(run.stdout).unwrap();
    assert!(
        text.contains("ball") && text.contains("250.000 mm") && !text.contains("wall"),
        "{text}"
    );
    refused!("check {robot} --q 0 --margin -1" => 2, "--margin | `-1` is below 0");
}

#[test]
fn moveit_scenes_are_worlds() {
    let folder = Folder::new("check-scene");
    let (robot, scene) = (
        folder.text("bar.urdf", BAR),
        folder.text("scene.yaml", SCENE),
    );
    let run = kinopt!("check {robot} --q 90 --degrees --world {scene} --json");
    assert_eq!(run.status.code(), Some(1));
    let report: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
    assert_eq!(report["collisions"][0]["second"], "can");
    let allowed = format!("allowed_collision_matrix: {{default_entry_names: [can]}}\n{SCENE}");
    let allowed = folder.text("allowed.yaml", allowed);
    let run = kinopt!("check {robot} --world {allowed}");
    let messages = stderr(&run);
    says!(messages => "note: | allowed.yaml: defaults of `allowed_collision_matrix` are ignored");
    let text = text!("check {robot}");
    assert_eq!(text, "free: no enabled pairs\n");
}

/// An obstacle can have a link's name.
#[test]
fn link_and_obstacle_of_one_name_are_distinguished() {
    let folder = Folder::new("check-names");
    let robot = folder.text("bar.urdf", BAR);
    let world = folder.text("world.json", WORLD.replace("ball", "bar"));
    let run = kinopt!("check {robot} --q 45 --degrees --world {world}");
    let text = String::from_utf8(run.stdout).unwrap();
    says!(text => "link bar | obstacle bar");
}

#[test]
fn joints_beyond_limits_are_reported_by_name() {
    let folder = Folder::new("check-limits");
    let robot = folder.text("bar.urdf", BAR);
    let report = answer!("check {robot} --q 3.2");
    let outside = json!({"joint": "turn", "value": 3.2, "lower": -3.0, "upper": 3.0});
    has!(report, {"free": true, "outside_limits": [outside]});
    let text = text!("check {robot} --q 3.2");
    assert!(
        text.ends_with("`turn` is outside its limits: 3.2 is not within [-3, 3]\n"),
        "{text}"
    );
    assert_eq!(answer!("check {robot} --q 3")["outside_limits"], json!([]));
}

/// The example of the help text is a valid command.
#[test]
fn example_of_the_help_fits_the_panda() {
    let help = text!("check --help");
    let example = help.split("robot.urdf --q ").nth(1).unwrap();
    let q = example.split_whitespace().next().unwrap();
    let (panda, table) = (model("franka_panda.urdf"), model("worlds/table.json"));
    let report = answer!("check {panda} --q {q} --world {table}");
    assert_eq!(report["outside_limits"], json!([]));
}

#[test]
fn invalid_worlds_are_one_line_errors() {
    let folder = Folder::new("check-wrong");
    let robot = folder.text("bar.urdf", BAR);
    let twice = folder.text("twice.json", WORLD.replace("wall", "ball"));
    refused!("check {robot} --world {twice}" => 1, "already");
    let attached = WORLD.replace("\"radius\"", "\"attached\": \"hand\", \"radius\"");
    let attached = folder.text("attached.json", attached);
    refused!("check {robot} --world {attached}" => 1, "hand");
    refused!("check {robot} --world {robot}" => 1, ".json");
}

#[test]
fn package_meshes_are_found_from_within_the_package() {
    let folder = Folder::new("check-within-a-package");
    for inner in ["lamp/urdf", "lamp/meshes"] {
        std::fs::create_dir_all(folder.file(inner)).unwrap();
    }
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    folder.text("lamp/meshes/arm.obj", corners);
    let mesh = r#"<mesh filename="package://lamp/meshes/arm.obj"/>"#;
    let link =
        format!(r#"<link name="arm"><collision><geometry>{mesh}</geometry></collision></link>"#);
    folder.text(
        "lamp/urdf/lamp.urdf",
        format!(r#"<robot name="lamp">{link}</robot>"#),
    );
    // Relative file names are searched from the current folder and its parents.
    for (current_folder, robot) in [
        ("lamp/urdf", "lamp.urdf"),
        ("lamp", "urdf/lamp.urdf"),
        (".", "lamp/urdf/lamp.urdf"),
    ] {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_kinopt"));
        let run = command
            .current_dir(folder.file(current_folder))
            .args(["check", robot])
            .output()
            .unwrap();
        assert!(run.status.success(), "{current_folder}: {}", stderr(&run));
    }
}

/// World of an MJCF file with a floor, a slab and an excluded pair.
#[test]
fn world_of_an_mjcf_file_is_checked() {
    let folder = Folder::new("check-mjcf");
    let arm = |world: &str, contact: &str| {
        format!(
            r#"<mujoco><worldbody>{world}<body name="arm" pos="0 0 1"><joint axis="0 1 0"/>
            <geom type="capsule" size=".05" fromto="0 0 0 .5 0 0"/></body></worldbody>{contact}</mujoco>"#
        )
    };
    let floor = r#"<geom name="floor" type="plane" size="0 0 1" pos="0 0 .6"/>"#;
    let slab = r#"<geom type="box" size=".1 .1 .1" pos=".4 0 .875"/>"#;
    let robot = folder.text("floor.xml", arm(floor, ""));
    let report = answer!("check {robot} --q 0");
    let apart = report["nearest"]["distance"].as_f64().unwrap();
    assert!((apart - 0.35).abs() < 1e-12, "{report}");
    let run = kinopt!("check {robot} --q 90 --degrees");
    assert_eq!(run.status.code(), Some(1));
    let text = String::from_utf8(run.stdout).unwrap();
    says!(text => "link arm | link world | 150.000 mm");
    let robot = folder.text("slab.xml", arm(slab, ""));
    let run = kinopt!("check {robot} --q 0");
    let text = String::from_utf8(run.stdout).unwrap();
    says!(text => "25.000 mm");
    let exclude = r#"<contact><exclude body1="world" body2="arm"/></contact>"#;
    let robot = folder.text("excluded.xml", arm(slab, exclude));
    assert_eq!(answer!("check {robot} --q 0")["free"], true);
    let hills = r#"<geom name="hills" type="hfield" hfield="h"/>"#;
    let robot = folder.text("hills.xml", arm(hills, ""));
    let run = kinopt!("check {robot} --q 0");
    let messages = String::from_utf8(run.stderr).unwrap();
    says!(messages => "note: | hills.xml:1: geom `hills` | hfield");
}
