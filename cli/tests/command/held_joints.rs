//! Promise: joints that are locked stay where they are put, joints that alone are free move alone, and
//! a tool goes with its frame, whichever solver answers and however many targets there are.

use crate::forked_rig::{Folder, distance, json, kinopt, numbers, refused, stdout};
use crate::seeded_robot::{Seeded, seven, typed};
use kinopt::spatial::{Placement, Vector3};
use serde_json::{Value, json};

/// The joint's value in an answer.
fn value(solution: &Value, joints: &Value, joint: &str) -> f64 {
    let names = joints.as_array().unwrap();
    let at = names.iter().position(|name| name == joint).unwrap();
    numbers(&solution["q"])[at]
}

#[test]
fn a_locked_joint_stays() {
    let panda = Seeded::panda();
    let mut q = panda.configuration(11);
    q[2] = 0.25;
    let target = typed("tool", &panda.pose(&q));
    for solver in [
        &[][..],
        &["--search=first"],
        &["--solver=levenberg-marquardt"],
    ] {
        for (lock, degrees) in [("joint3=0.25", false), ("joint3=14.32394487827058", true)] {
            let lock = format!("--lock={lock}");
            let mut arguments = vec!["solve", &panda.file, &target, &lock, "--json"];
            arguments.extend(solver);
            arguments.extend(degrees.then_some("--degrees"));
            let solution = json(&arguments);
            assert_eq!(solution["reached"], true, "{arguments:?}");
            let locked = value(&solution, &solution["joints"], "joint3");
            assert!((locked - 0.25).abs() < 1e-12, "{arguments:?}: {locked}");
            panda.check(&numbers(&solution["q"]), &panda.pose(&q));
        }
    }
    // Without a value it stays at the start; what no target feels is held too.
    let start = "--start=0,0,0.3,-1,0,1,0,0.01,0.01";
    let solution = json(&[
        "solve",
        &panda.file,
        &target,
        start,
        "--lock=joint3",
        "--lock=finger_left_slide=0.02",
        "--json",
    ]);
    assert_eq!(value(&solution, &solution["joints"], "joint3"), 0.3);
    assert_eq!(
        value(&solution, &solution["joints"], "finger_right_slide"),
        0.02
    );
}

#[test]
fn only_some_joints_move() {
    let ur5e = Seeded::new("universal_ur5e", "base", "flange");
    let start = ur5e.configuration(2);
    let names: Vec<String> = json(&["info", &ur5e.file, "--json"])["moving_joints"]
        .as_array()
        .unwrap()
        .iter()
        .map(|n| n.as_str().unwrap().to_owned())
        .collect();
    let mut q = start.clone();
    for value in &mut q[3..6] {
        *value += 0.2;
    }
    let typed_start: Vec<String> = start.iter().map(f64::to_string).collect();
    let (start_option, target) = (
        format!("--start={}", typed_start.join(",")),
        typed("flange", &ur5e.pose(&q)),
    );
    let only = format!("--only={}", names[3..].join(","));
    for solver in ["--search=start", "--solver=gauss-newton"] {
        let solution = json(&format!(
            "solve {ur5e} {target} {start_option} {only} {solver} --json"
        ));
        assert_eq!(solution["reached"], true, "{solver}");
        assert_eq!(numbers(&solution["q"])[..3], start[..3]);
    }
    refused(
        &[
            "solve",
            &ur5e.file,
            &target,
            &only,
            &format!("--lock={}=0", names[3]),
        ],
        2,
        &format!("{} | --only", names[3]),
    );
    let twice = format!("--lock={}=0", names[0]);
    refused(
        &["solve", &ur5e.file, &target, &twice, &twice],
        1,
        &format!("{} | locked twice", names[0]),
    );
    refused(
        &["solve", &ur5e.file, &target, "--lock=elbo"],
        1,
        &format!("moving joint | `elbo` | {}", names[2]),
    );
    refused(
        &[
            "solve",
            &ur5e.file,
            &target,
            &format!("--lock={}=99", names[0]),
        ],
        1,
        &format!("{} | 99", names[0]),
    );
    refused!("solve {ur5e} {target} --lock=x=y" => 2, "`y` is not a number");
}

#[test]
fn many_targets_and_paths_keep_to_it() {
    let panda = Seeded::panda();
    let folder = Folder::new("held");
    let tool = Placement::translation(Vector3::new(0.02, 0.0, 0.1));
    let mut q = panda.configuration(5);
    // A path stays on the branch that it starts on.
    let start: Vec<String> = q.iter().map(f64::to_string).collect();
    let start = format!("--start={}", start.join(","));
    let targets: Vec<Vec<f64>> = (0..6)
        .map(|_| {
            q[0] += 0.02;
            q[3] -= 0.01;
            q[2] = 0.2;
            seven(&(panda.base_from("tool", &q) * tool))
        })
        .collect();
    let file = folder.file("path.json");
    std::fs::write(
        &file,
        json!({"targets": targets, "tip_link": "tool"}).to_string(),
    )
    .unwrap();
    for way in [
        &[][..],
        &["--batch"],
        &["--track"],
        &["--solver=levenberg-marquardt"],
    ] {
        let mut arguments = vec![
            "solve",
            &panda.file,
            "--targets",
            &file,
            "--lock=joint3=0.2",
            &start,
            "--tool=0.02,0,0.1",
            "--json",
        ];
        arguments.extend(way);
        let all = json(&arguments);
        assert_eq!(all["summary"]["solved"], 6, "{arguments:?}");
        for (solution, target) in all["solutions"].as_array().unwrap().iter().zip(&targets) {
            assert_eq!(value(solution, &all["joints"], "joint3"), 0.2);
            let placed = panda.base_from("tool", &numbers(&solution["q"])) * tool;
            assert!(distance(&seven(&placed)[..3], &target[..3]) < 1.1e-6);
        }
    }
}

#[test]
fn held_joints_are_told_to_people_too() {
    let panda = Seeded::panda();
    let start = "--start=0,0,0.3,-1,0,1,0,0.01,0.01";
    let target = "--target=tool=0.4,0.1,0.5";
    for (option, held) in [
        ("--lock=joint3", &["joint3"][..]),
        (
            "--only=joint1,joint2,joint4",
            &["joint3", "joint5", "joint6", "joint7"],
        ),
    ] {
        let output = kinopt(&["solve", &panda.file, target, start, option]);
        let rows = stdout(&output).lines().map(str::split_whitespace);
        let rows: Vec<Vec<&str>> = rows.map(Iterator::collect).collect();
        let told = rows.iter().filter(|row| row.last() == Some(&"held"));
        let told: Vec<&str> = told.filter_map(|row| row.first().copied()).collect();
        assert_eq!(told, held, "{}", stdout(&output));
        assert!(rows.contains(&vec!["joint3", "0.300000", "held"]));
    }
}

#[test]
fn a_tool_on_the_tip() {
    let panda = Seeded::panda();
    let q = panda.configuration(11);
    let tool = "--tool=0,0.05,0.1,0.5,0.5,0.5,0.5";
    let target = typed("tool", &panda.pose(&q));
    for solver in ["--search=start", "--solver=levenberg-marquardt"] {
        // With the tool at the target the flange is elsewhere.
        let solution = json(&["solve", &panda.file, &target, tool, solver, "--json"]);
        assert_eq!(solution["reached"], true, "{solver}: {solution}");
        let position = numbers(&solution["q"]);
        let apart = panda.errors(&position, &panda.pose(&q))[0];
        assert!((apart - 0.05_f64.hypot(0.1)).abs() < 1e-5, "{apart}");
    }
    let other = "--target=hand=0.4,0,0.5";
    refused!("solve {panda} {target} {other} {tool}" => 2, "--tool | several");
    refused!("solve {panda} {target} --tool=1,2" => 2, "not 2");
}

#[test]
fn rigs_hold_bones_and_carry_tools() {
    let folder = Folder::new("held-bones");
    let rig = folder.rig();
    let info = json(&["info", &rig, "--json"]);
    let bones: Vec<&str> = info["bones"]
        .as_array()
        .unwrap()
        .iter()
        .map(|bone| bone["name"].as_str().unwrap())
        .collect();
    // Bones 1 and 2 are the left arm: held, only the elbow is left.
    let target = format!("--target={}=-1.9,0.9,0", bones[2]);
    for held in [
        format!("--lock={}", bones[1]),
        format!("--only={}", bones[2]),
        "--only=bone/2".to_owned(),
    ] {
        let solution = json(&["solve", &rig, &target, &held, "--free", "--json"]);
        let q = numbers(&solution["q"]);
        assert!(q[3..6].iter().all(|angle| *angle == 0.0), "{held}: {q:?}");
        assert!(q[6..9].iter().any(|angle| *angle != 0.0), "{held}: {q:?}");
    }
    // A sword in the left hand reaches what the hand cannot.
    let far = format!("--target={}=-3.2,0.6,0", bones[2]);
    let reached = |more: &[&str]| {
        let arguments = [&["solve", &rig, &far, "--json"][..], more].concat();
        json(&arguments)["reached"].clone()
    };
    assert_eq!(
        (reached(&[]), reached(&["--tool=0.5,0,0"])),
        (json!(false), json!(true))
    );
    let several = format!("--lock={}=0.1", bones[1]);
    refused(
        &["solve", &rig, &target, &several],
        2,
        &format!("{} | several angles", bones[1]),
    );
    refused!("solve {rig} {target} --lock=tail" => 1, "bone or joint | `tail`");
}
