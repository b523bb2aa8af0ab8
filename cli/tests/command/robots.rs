//! Promise: a URDF robot is shown as a tree of links, placed by its joints' values, and solved for one
//! target or several, within its limits.

use crate::forked_rig::{Folder, distance, json, kinopt, numbers, says, stderr, stdout};
use crate::seeded_robot::{Seeded, seven, typed};
use serde_json::json;

#[test]
fn info_shows_the_tree() {
    let panda = Seeded::panda();
    let output = kinopt(&["info", &panda.file]);
    let text = stdout(&output);
    let line = |name: &str| {
        let mut lines = text
            .lines()
            .filter(|line| line.trim_start().starts_with(name));
        let line = lines.next().unwrap();
        (line.len() - line.trim_start().len(), line)
    };
    for (name, words) in [
        ("link4 ", ["joint4", "revolute", "-176.001°", "-3.999°"]),
        ("flange ", ["flange_mount", "fixed", "", ""]),
        ("finger_left ", ["prismatic", "0.040000 m", "y", "7"]),
        (
            "finger_right ",
            ["follows finger_left_slide", "-y", "8", "m"],
        ),
    ] {
        let (_, line) = line(name);
        assert!(words.iter().all(|word| line.contains(word)), "{line}");
    }
    assert_eq!(line("link2 ").0, line("link1 ").0 + 2);
    assert_eq!(line("finger_left ").0, line("finger_right ").0);
    for words in [
        "9 degrees of freedom, 8 of them free",
        "tool, finger_left, finger_right",
    ] {
        assert!(text.contains(words), "{text}");
    }

    for told in [
        "speed",
        "effort",
        "124.618°/s",
        "87.000 N·m",
        "0.050 m/s",
        "70.000 N ",
    ] {
        assert!(
            stdout(&output).contains(told),
            "no {told} in {}",
            stdout(&output)
        );
    }
    let info = json(&["info", &panda.file, "--json"]);
    assert_eq!(info["kind"], "robot");
    assert_eq!(info["root"], "base");
    assert_eq!(info["name"], "franka_panda");
    assert_eq!(info["tips"], json!(["tool", "finger_left", "finger_right"]));
    assert_eq!(info["moving_joints"][8], "finger_right_slide");
    let follower = &info["joints"][8];
    assert_eq!(follower["mimic"]["joint"], "finger_left_slide");
    assert_eq!(follower["mimic"]["ratio"], 1.0);
    assert_eq!(follower["parent_link"], "hand");
    assert_eq!(follower["child_link"], "finger_right");
    assert_eq!(follower["axis"], json!([0.0, -1.0, 0.0]));
    assert_eq!(follower["free"], false);
}

#[test]
fn fk_places_links_in_any_base() {
    let panda = Seeded::panda();
    let q = panda.configuration(3);
    let typed: Vec<String> = q.iter().map(f64::to_string).collect();
    let given = format!("--q={}", typed.join(","));
    let fk = json(&["fk", &panda.file, &given, "--frame=tool", "--json"]);
    assert_eq!(fk["joints"].as_array().unwrap().len(), 9);
    let pose = panda.pose(&q);
    assert!(distance(&numbers(&fk["frames"]["tool"]["position"]), &pose[..3]) < 1e-14);
    // The tool's offset from the hand is the file's, whatever the arm does.
    let fk = json(&format!(
        "fk {panda} {given} --frame=tool --base=hand --json"
    ));
    assert!(
        distance(
            &numbers(&fk["frames"]["tool"]["position"]),
            &[0.0, 0.0, 0.1034]
        ) < 1e-14
    );

    // By name, in any order: joints without a number are at rest, followers follow.
    let folder = Folder::new("by-name");
    let file = folder.file("q.json");
    let content = json!({"joints": ["finger_left_slide", "joint2"], "q": [0.03, 0.5]});
    std::fs::write(&file, content.to_string()).unwrap();
    let fk = json(&["fk", &panda.file, "--q-file", &file, "--json"]);
    let rest = -0.0698;
    assert_eq!(
        fk["q"],
        json!([0.0, 0.5, 0.0, rest, 0.0, 0.0, 0.0, 0.03, 0.03])
    );
    // Fingers that do not go together are worth a note.
    let output = kinopt(&["fk", &panda.file, "--q=0,0,0,-1,0,1,0,0.01,0.02"]);
    says(stderr(&output), "finger_right_slide");
}

#[test]
fn one_target_by_every_search_and_solver() {
    let panda = Seeded::panda();
    let pose = panda.pose(&panda.configuration(11));
    let target = typed("tool", &pose);
    for arguments in [
        vec![],
        vec!["--search=first"],
        vec!["--search=nearest"],
        vec!["--search=distinct:3"],
        vec!["--start=random", "--rng-seed=4"],
        vec!["--posture=0,0,0,-1.5,0,1.5,0"],
        vec!["--attempts=50", "--time-limit=1000"],
        vec!["--solver=levenberg-marquardt"],
        vec!["--solver=gauss-newton", "--jacobian=dual"],
        vec!["--restarts=40", "--jacobian=central"],
        // Out of many attempts from elsewhere.
        vec!["--solver=projected-gradient-bb", "--max-iterations=2000"],
    ] {
        let mut all = vec!["solve", &panda.file, &target, "--json"];
        all.extend(&arguments);
        let solution = json(&all);
        assert_eq!(solution["reached"], true, "{arguments:?}: {solution}");
        let q = numbers(&solution["q"]);
        panda.check(&q, &pose);
        // The fingers are not asked for: they stay together, where the start has them.
        assert_eq!(q[7], q[8]);
        assert!(q[7] == 0.0 || arguments.contains(&"--start=random"));
        assert_eq!(solution["joints"][3], "joint4");
        let task = &solution["tasks"][0];
        assert_eq!(task["frame"], "tool");
        assert_eq!(task["reached"], true);
        assert!(task["orientation_error"].as_f64().unwrap() <= 1e-6);
        assert!(solution["micros"].as_f64().unwrap() > 0.0);
        if arguments == ["--search=distinct:3"] {
            let others = solution["alternatives"].as_array().unwrap();
            assert_eq!(others.len(), 2);
            for other in others {
                panda.check(&numbers(other), &pose);
                assert!(distance(&numbers(other), &q) > 0.5);
            }
        }
    }
}

#[test]
fn parts_of_a_pose() {
    let panda = Seeded::panda();
    let pose = panda.pose(&panda.configuration(11));
    let whole = typed("tool", &pose);
    let point = typed("tool", &pose[..3]);
    for (target, option) in [(&point, "--degrees"), (&whole, "--position-only")] {
        let solution = json(&["solve", &panda.file, target, option, "--json"]);
        assert_eq!(solution["reached"], true);
        let [position, orientation] = panda.errors(&numbers(&solution["q"]), &pose);
        assert!(position <= 1.001e-6 && orientation > 1e-3);
        assert!(solution["tasks"][0]["orientation_error"].is_null());
    }
    let solution = json(&["solve", &panda.file, &whole, "--free-axis=z", "--json"]);
    assert_eq!(solution["reached"], true);
    let q = numbers(&solution["q"]);
    let base_from_tool = panda.base_from("tool", &q);
    let wanted = panda.base_from("tool", &panda.configuration(11));
    let between = wanted.rotation.z.dot(base_from_tool.rotation.z);
    assert!((between - 1.0).abs() < 1e-11, "{between}");
    assert!(panda.errors(&q, &pose)[0] <= 1.001e-6);
}

#[test]
fn a_move_can_be_bounded() {
    let ur5e = Seeded::new("universal_ur5e", "base", "flange");
    let start = ur5e.configuration(2);
    let near: Vec<f64> = start.iter().map(|value| value + 0.05).collect();
    let typed_start: Vec<String> = start.iter().map(f64::to_string).collect();
    let start_option = format!("--start={}", typed_start.join(","));
    let near_target = typed("flange", &ur5e.pose(&near));
    let common = [ur5e.file.as_str(), &start_option, "--json"];
    let solve = |target: &str, bound: &str| {
        json(&["solve", common[0], common[1], common[2], target, bound])
    };
    let solution = solve(&near_target, "--max-move=0.1");
    assert_eq!(solution["reached"], true);
    for (value, from) in numbers(&solution["q"]).iter().zip(&start) {
        assert!((value - from).abs() <= 0.1);
    }
    let solution = solve(&near_target, "--max-move=0.01");
    assert_eq!(solution["reached"], false);
    assert_eq!(solution["termination"], "cannot_continue");
    let blocking = solution["active_limits"].as_array().unwrap();
    assert!(!blocking.is_empty() && blocking.iter().all(|limit| limit["kind"] == "move"));
    for (value, from) in numbers(&solution["q"]).iter().zip(&start) {
        assert!((value - from).abs() <= 0.01);
    }
}

#[test]
fn targets_are_in_the_base_frame() {
    // The world's own z is not link1's, and link3 moves with the arm.
    for base in ["link1", "link3"] {
        let panda = Seeded::new("franka_panda", base, "tool");
        let pose = panda.pose(&panda.configuration(8));
        let target = typed("tool", &pose);
        for solver in ["--search=start", "--solver=levenberg-marquardt"] {
            let solution = json(&format!(
                "solve {panda} {target} --base {base} {solver} --json"
            ));
            assert_eq!(solution["reached"], true, "{base} {solver}");
            panda.check(&numbers(&solution["q"]), &pose);
        }
    }
}

#[test]
fn both_arms_at_once() {
    for base in ["torso", "left_upper_arm"] {
        let baxter = Seeded::new("rethink_baxter", base, "left_tool");
        let q = baxter.configuration(5);
        let (left, right) = (baxter.pose(&q), seven(&baxter.base_from("right_tool", &q)));
        let (one, other) = (typed("left_tool", &left), typed("right_tool", &right));
        let solution = json(&format!(
            "solve {baxter} {one} {other} --base {base} --json"
        ));
        assert_eq!(
            solution["reached"], true,
            "{base}: {}",
            solution["explanation"]
        );
        let q = numbers(&solution["q"]);
        baxter.check(&q, &left);
        Seeded::new("rethink_baxter", base, "right_tool").check(&q, &right);
    }
}

#[test]
fn people_see_what_matters() {
    let panda = Seeded::panda();
    let target = typed("tool", &panda.pose(&panda.configuration(11)));
    let output = kinopt(&["solve", &panda.file, &target, "--search=distinct:3"]);
    let text = stdout(&output);
    says(
        text,
        "Reached | joint7 | 3 answers in all | orientation error (rad)",
    );
    assert!(!text.contains("finger"), "{text}");
}

#[test]
fn out_of_reach_is_an_answer() {
    let scara = Seeded::new("adept_cobra_s600", "base", "flange");
    let output = kinopt(&["solve", &scara.file, "--target=flange=2,0,0.2"]);
    assert_eq!(output.status.code(), Some(0));
    says(stdout(&output), "Not reached");
    let solution = json(&["solve", &scara.file, "--target=flange=2,0,0.2", "--json"]);
    assert_eq!(solution["reached"], false);
    // 325 mm and 275 mm of arm, stretched along x.
    let error = solution["tasks"][0]["position_error"].as_f64().unwrap();
    assert!((error - 1.4).abs() < 1e-6, "{error}");
}

#[test]
fn wrong_names_and_options() {
    let panda = Seeded::panda();
    let rig = Folder::new("rig-options");
    let rig = rig.rig();
    let (pose, both) = ("--target=tool=0.4,0,0.5,0,1,0,0", "--target=hand=0.4,0,0.5");
    let point = "--target=bone/2=-2.5,0.5,0";
    refused!("solve {panda} --target=claw=1,2,3" => 1, "`claw` | no link named | `kinopt info` lists all");
    refused!("solve {panda} {pose} --base=Link_77" => 1, "`Link_77` | did you mean `link7`");
    refused!("fk {panda} --base=toool" => 1, "`toool` | did you mean `tool`");
    refused!("solve {panda} {pose} --max-move=1,2" => 1, "--max-move | 7 | joint4 | 9");
    refused!("solve {panda} {pose} --start=1,2" => 1, "--start | joint4");
    refused!("solve {panda} {pose} --search=best" => 2, "nearest | distinct:K");
    refused!("solve {panda} {pose} --search=first --solver=gauss-newton" => 2, "--solver");
    refused!("solve {panda} {pose} {both} --search=first" => 2, "--search | 2 targets");
    refused!("solve {panda} {pose} --attempts=0" => 2, "0");
    refused!("solve {panda} {pose} --free-axis=w" => 2, "w");
    refused!("solve {panda} {both} --free-axis=z" => 2, "--free-axis | orientation");
    refused!("solve {panda} {pose} --track" => 2, "--track");
    refused!("solve {rig} {point} --search=nearest" => 2, "--search | rig | start or first");
    refused!("info robot.xacro" => 1, ".xacro | .urdf | .json");
}

/// What no target feels stays at its start, whatever the method and however many attempts it takes.
#[test]
fn the_other_arm_stays() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/rethink_baxter.urdf");
    let robot = kinopt::robot::Robot::read(file).unwrap();
    let start = robot.model().random_configuration(0);
    let methods = [
        "levenberg-marquardt",
        "levenberg-marquardt-error",
        "gauss-newton",
        "projected-gradient",
        "projected-gradient-bb",
    ];
    for target in [
        "--target=left_tool=0.6,0.4,0.2",
        "--target=left_tool=6,0.4,0.2",
    ] {
        for solver in methods {
            for jacobian in ["--jacobian=analytic", "--jacobian=fd"] {
                let solver = format!("--solver={solver}");
                let more = [
                    "--start=random",
                    "--attempts=4",
                    "--max-iterations=30",
                    "--json",
                ];
                let all = [&["solve", file, target, &solver, jacobian][..], &more].concat();
                let solution = json(&all);
                let names = solution["joints"].as_array().unwrap();
                let pairs = numbers(&solution["q"]).into_iter().zip(&start);
                for ((q, start), name) in pairs.zip(names) {
                    assert!(
                        !name.as_str().unwrap().starts_with("right") || q == *start,
                        "{all:?}"
                    );
                }
            }
        }
    }
}
