//! Promise: a file of targets returns one solution per target, bitwise equal for any number of threads, within the
//! limits and on the target. The error of a malformed file has its name and the location.

use crate::forked_rig::*;
use crate::seeded_robot::Seeded;
use serde_json::{Value, json};

fn robots() -> [Seeded; 4] {
    [
        Seeded::panda(),
        Seeded::new("universal_ur5e", "base", "flange"),
        Seeded::new("adept_cobra_s600", "base", "flange"),
        Seeded::new("rethink_baxter", "torso", "right_tool"),
    ]
}

/// Configurations of all solutions.
fn configurations(document: &Value) -> Vec<Vec<f64>> {
    let solutions = list(&document["solutions"]).iter();
    solutions.map(|solution| numbers(&solution["q"])).collect()
}

#[test]
fn every_reachable_target_is_reached() {
    let folder = Folder::new("reached");
    for seeded in robots() {
        let file = folder.text("targets.json", seeded.targets(15));
        for options in ["", "--search=first", "--together --threads=2"] {
            let document = answer!("batch {seeded} --targets {file} {options}");
            let summary = &document["summary"];
            has!(summary, {"solved": 15, "total": 15});
            assert!(number(&summary["micros_mean"]) > 0.0);
            let alone = !options.contains("--together");
            for key in ["micros_median", "micros_p99"] {
                assert_eq!(summary.get(key).is_some(), alone, "{options:?}");
            }
            let model = seeded.robot.model();
            assert_eq!(list(&document["joints"]).len(), model.degrees_of_freedom());
            let solutions = list(&document["solutions"]).iter();
            for (solution, pose) in solutions.zip(seeded.poses(15)) {
                has!(solution, {"reached": true, "tasks/0/frame": seeded.tip});
                assert_eq!(solution.get("micros").is_some(), alone);
                seeded.check(&numbers(&solution["q"]), &pose);
            }
        }
    }
}

#[test]
fn results_are_bitwise_equal_for_any_thread_count() {
    let folder = Folder::new("threads");
    // More targets than one thread takes at once in `--together`.
    let ur5e = Seeded::new("universal_ur5e", "base", "flange");
    for (seeded, count, ways) in [
        (Seeded::panda(), 150, ["--together", "--search=first"]),
        (
            ur5e,
            30,
            ["--search=start", "@solve.solver=levenberg-marquardt"],
        ),
    ] {
        let file = folder.text("targets.json", seeded.targets(count));
        for options in ways {
            let on = |threads: &str| {
                configurations(&answer!(
                    "batch {seeded} --targets {file} {options} {threads}"
                ))
            };
            let one = on("--threads=1");
            assert!(one == on("--threads=8") && one == on(""), "{options}");
        }
    }
}

#[test]
fn path_continues_from_the_last_solution() {
    let folder = Folder::new("track");
    for seeded in robots() {
        // Straight joint-space segment between two configurations.
        let (from, to) = (seeded.configuration(21), seeded.configuration(22));
        let targets = (0..=200).map(|step| {
            let share = f64::from(step) / 2000.0;
            let pairs = from.iter().zip(&to);
            let q: Vec<f64> = pairs.map(|(a, b)| a + share * (b - a)).collect();
            seeded.pose(&q)
        });
        let targets: Vec<Vec<f64>> = targets.collect();
        let start = vec![&from; targets.len()];
        let model = seeded.robot.model();
        let moving = model.moving_joints().iter();
        let names: Vec<&str> = moving
            .map(|id| model.joints()[id.index()].name.as_str())
            .collect();
        let content = json!({"targets": targets, "starts": start, "joint_names": names,
            "tip_link": seeded.tip, "base_link": seeded.base});
        let file = folder.text("path.json", content);
        let document = answer!("track {seeded} --targets {file}");
        has!(document["summary"], {"solved": 201, "jumps": []});
        let q = configurations(&document);
        for (q, pose) in q.iter().zip(&targets) {
            seeded.check(q, pose);
        }
        for (a, b) in q.iter().zip(&q[1..]) {
            assert!(distance(a, b) < 0.2, "a jump from {a:?} to {b:?}");
        }
    }
}

/// A SCARA arm rotates about its base until the first joint reaches its limit. The path continues only with the elbow
/// bent to the other side.
#[test]
fn jump_is_reported() {
    let folder = Folder::new("flip");
    let file = model("adept_cobra_s600.urdf");
    let robot = kinopt::robot::Robot::read(&file).unwrap();
    let arm = kinopt::arm::Arm::new(&robot, "base", "flange").unwrap();
    let first = arm.limits().next().unwrap().upper - 0.3;
    let start = [first, -0.9, 0.1, 0.0];
    let p = arm.base_from_tool(&start).unwrap().translation;
    let turned = |step: u32| {
        let (sin, cos) = (0.01 * f64::from(step)).sin_cos();
        [cos * p.x - sin * p.y, sin * p.x + cos * p.y, p.z]
    };
    let targets: Vec<[f64; 3]> = (0..60).map(turned).collect();
    let starts = vec![start; targets.len()];
    let content = json!({"targets": targets, "starts": starts, "tip_link": "flange"});
    let path = folder.text("path.json", content);
    let track = format!("track {file} --targets {path} --base=base");
    // The default stays on its branch.
    assert_eq!(answer!("{track}")["summary"]["jumps"], json!([]));
    let document = answer!("{track} @solve.global_search_on_miss=true");
    let jumps = list(&document["summary"]["jumps"]);
    assert_eq!(jumps.len(), 1, "{jumps:?}");
    has!(jumps[0], {"index": 31, "reconfiguration": true});
    assert!(number(&jumps[0]["distance"]) > 0.2);
    let text = text!("{track} @solve.global_search_on_miss=true");
    says!(text => &format!("step 31 | {}", word(&jumps[0]["joint"])));
    // Independent targets have no jumps.
    let alone = answer!("batch {file} --targets {path}");
    assert!(alone["summary"].get("jumps").is_none());
}

#[test]
fn starts_are_given_by_name_or_in_order() {
    let folder = Folder::new("starts");
    let panda = Seeded::panda();
    let q = panda.configuration(31);
    let pose = panda.pose(&q);
    // An arm that starts at a solution stays there.
    let backwards: Vec<String> = (1..=7).rev().map(|k| format!("joint{k}")).collect();
    let reversed: Vec<f64> = q[..7].iter().rev().copied().collect();
    for content in [
        json!({"targets": [pose], "starts": [reversed], "joint_names": backwards}),
        json!({"targets": [pose], "starts": [&q[..7]]}),
        json!({"targets": [pose], "starts": [q]}),
    ] {
        let file = folder.text("targets.json", content);
        let answer = answer!("batch {panda} --targets {file} --tip=tool");
        assert!(distance(&configurations(&answer)[0][..7], &q[..7]) < 1e-6);
    }
}

#[test]
fn command_line_overrides_the_file() {
    let folder = Folder::new("override");
    let seeded = Seeded::new("franka_panda", "link1", "hand");
    let mut content = seeded.targets(10);
    content["tip_link"] = "flange".into();
    content["base_link"] = "base".into();
    let file = folder.text("targets.json", content);
    let document = answer!("batch {seeded} --targets {file} --tip=hand --base=link1");
    for (q, pose) in configurations(&document).iter().zip(seeded.poses(10)) {
        seeded.check(q, &pose);
    }
    assert_eq!(document["solutions"][0]["tasks"][0]["frame"], "hand");
}

#[test]
fn positions_and_unreached_targets_are_summarised() {
    let folder = Folder::new("misses");
    let panda = Seeded::panda();
    let mut points: Vec<Vec<f64>> = panda.poses(6).iter().map(|p| p[..3].to_vec()).collect();
    points[4] = vec![3.0, 0.0, 0.0];
    let file = folder.text(
        "targets.json",
        json!({"targets": points, "tip_link": "tool"}),
    );
    let document = answer!("batch {panda} --targets {file}");
    has!(document["summary"], {"solved": 5, "total": 6});
    assert_eq!(document["solutions"][4]["reached"], false);
    let output = kinopt!("batch {panda} --targets {file}");
    assert_eq!((output.status.code(), stderr(&output)), (Some(0), ""));
    says!(stdout(&output) => "5 of 6 | median | target 4: Not reached | misses by");
    let text = text!("batch {panda} --targets {file} --together");
    assert!(text.contains("mean") && !text.contains("median"));
}

#[test]
fn tip_of_a_rig_reaches_many_targets() {
    let (folder, rig) = Folder::with_rig("rig");
    let targets = json!({"targets": [[-2.5, 0.5, 0.2], [-2.6, 0.4, 0.1], [-9.0, 0.0, 0.0]]});
    let file = folder.text("targets.json", targets);
    for line in ["track RIG", "batch RIG --together", "batch RIG --threads=2"] {
        let line = line.replace("RIG", &rig);
        let document = answer!("{line} --targets {file} --tip=bone/2");
        assert_eq!(document["summary"]["solved"], 2);
        let tasks = &document["solutions"][0]["tasks"];
        has!(tasks[1], {"frame": "bone/4", "held": true});
        assert!(number(&tasks[0]["position_error"]) < 1e-8);
        assert!(document.get("joints").is_none());
    }
    refused!("batch {rig} --targets {file}" => 1, "--tip");
}

#[test]
fn malformed_files_are_named_with_the_location() {
    let folder = Folder::new("malformed");
    let panda = Seeded::panda();
    // Content of each file, and the expected words of its error.
    let files = r#"
 => is empty
hello => is not JSON | line 1
{"targets": [[NaN,0,0]]} => is not JSON
[1,2] => not an object
{} => no key `targets`
{"targets": 3} => targets: is a number, not a list
{"targets": []} => targets: the list is empty
{"targets": [[]]} => targets: the list is empty
{"targets": [[1,2]]} => targets[0] | 2 numbers
{"targets": [POSE,[1,2,3]]} => targets[1] | 3 numbers
{"targets": [POSE,[1,2,3,1,0,null,0]]} => targets[1][5] | null
{"targets": [[1,2,1e999]]} => is not JSON | range
{"targets": [[1,2,3,1,1,0,0]]} => targets[0] | length 1.41
{"targets": [POSE], "starts": []} => starts | 1 targets
{"tip_link": "tool", "targets": [POSE], "starts": [[1]]} => starts[0] | joint4
{"tip_link": "tool", "targets": [POSE], "starts": [["a"]]} => starts[0][0] | a string
{"tip_link": "tool", "targets": [POSE], "starts": [[1]], "joint_names": ["elbow"]} => joint_names | `elbow` | joint4
{"tip_link": "tool", "targets": [POSE], "starts": [[1]], "joint_names": ["hand_mount"]} => joint_names | `hand_mount` | fixed
{"tip_link": "tool", "targets": [POSE], "starts": [[1]], "joint_names": ["joint1", "joint2"]} => starts[0] | 1 numbers | 2 joint_names
{"targets": [POSE], "joint_names": [1]} => joint_names[0]
{"targets": [POSE], "tip_link": "claw"} => `claw` | no link named
{"targets": [POSE], "tip_link": 4} => tip_link | a name
{"targets": [POSE]} => tip_link | --tip | finger_left
{"targets": [POSE], "tip_link": "tool", "base_link": "flange"} => no free joint
"#;
    for line in files.trim_start_matches('\n').lines() {
        let (content, words) = line.split_once(" => ").unwrap();
        let content = content.replace("POSE", "[0.4,0,0.5,0,1,0,0]");
        let file = folder.text("targets.json", content);
        refused!("batch {panda} --targets {file} --json" => 1, "{words}");
    }
    let missing = folder.file("missing.json");
    refused!("batch {panda} --targets {missing}" => 1, "missing.json");
}

#[test]
fn wrong_usage_is_rejected() {
    let panda = Seeded::panda();
    refused!("batch {panda}" => 2, "--targets");
    let file = "--targets=poses.json";
    refused!("batch {panda} {file} --target=tool=1,2,3" => 2, "--target");
    refused!("batch {panda} {file} @goal.target=[\"tool=1,2,3\"]" => 2, "`target`");
    refused!("track {panda} {file} --together" => 2, "--together");
    refused!("track {panda} {file} @output.derivative=true" => 2, "`derivative`");
    refused!("batch {panda} {file} --threads=0" => 2, "0");
    refused!("batch {panda} {file} --out=posed.obj" => 2, "--out");
    refused!("solve {panda} --target=1,2,3" => 1, "--tip | finger_left");
}

#[test]
fn target_without_a_frame_is_of_the_tip() {
    let panda = Seeded::panda();
    let named = answer!("solve {panda} --target=tool=0.4,0.1,0.5");
    let of_tip = answer!("solve {panda} --tip=tool --target=0.4,0.1,0.5");
    assert_eq!(named["q"], of_tip["q"]);
    // A robot with one tip needs no name.
    let scara = Seeded::new("adept_cobra_s600", "base", "flange");
    let only = answer!("solve {scara} --target=0.4,0.1,0.2");
    has!(only, {"reached": true, "tasks/0/frame": "flange"});
}
