//! Promise: locked joints keep their values, `only` moves the listed joints alone, and a tool is attached to its
//! frame. This holds for every solver and any number of targets.

use crate::forked_rig::*;
use crate::seeded_robot::{Seeded, seven, typed};
use kinopt::spatial::{Placement, Vector3};
use serde_json::{Value, json};

/// Value of a joint in a solution.
fn value(solution: &Value, joints: &Value, joint: &str) -> f64 {
    let at = list(joints).iter().position(|name| name == joint).unwrap();
    numbers(&solution["q"])[at]
}

#[test]
fn locked_joint_keeps_its_value() {
    let panda = Seeded::panda();
    let mut q = panda.configuration(11);
    q[2] = 0.25;
    let target = typed("tool", &panda.pose(&q));
    for solver in ["", "--search=first", "@solve.solver=levenberg-marquardt"] {
        for lock in [
            "--lock=joint3=0.25",
            "--lock=joint3=14.32394487827058 --degrees",
        ] {
            let solution = answer!("solve {panda} {target} {lock} {solver}");
            assert_eq!(solution["reached"], true, "{lock} {solver}");
            let locked = value(&solution, &solution["joints"], "joint3");
            assert!((locked - 0.25).abs() < 1e-12, "{lock} {solver}: {locked}");
            panda.check(&numbers(&solution["q"]), &panda.pose(&q));
        }
    }
    // A lock without a value keeps the start value, also for a joint that no target depends on.
    let start = "--start=0,0,0.3,-1,0,1,0,0.01,0.01";
    let locks = "--lock=joint3 --lock=finger_left_slide=0.02";
    let solution = answer!("solve {panda} {target} {start} {locks}");
    let joints = &solution["joints"];
    assert_eq!(value(&solution, joints, "joint3"), 0.3);
    assert_eq!(value(&solution, joints, "finger_right_slide"), 0.02);
}

#[test]
fn only_selected_joints_move() {
    let ur5e = Seeded::new("universal_ur5e", "base", "flange");
    let start = ur5e.configuration(2);
    let info = answer!("info {ur5e}");
    let names: Vec<&str> = list(&info["moving_joints"]).iter().map(word).collect();
    let (first, second, fourth) = (names[0], names[2], names[3]);
    let mut q = start.clone();
    q[3..6].iter_mut().for_each(|value| *value += 0.2);
    let (typed_start, target) = (commas(&start), typed("flange", &ur5e.pose(&q)));
    let only = format!("@model.only=[\"{}\"]", names[3..].join("\",\""));
    for solver in ["--search=start", "@solve.solver=gauss-newton"] {
        let solution = answer!("solve {ur5e} {target} --start={typed_start} {only} {solver}");
        assert_eq!(solution["reached"], true, "{solver}");
        assert_eq!(numbers(&solution["q"])[..3], start[..3]);
    }
    let ask = format!("solve {ur5e} {target}");
    refused!("{ask} {only} --lock={fourth}=0" => 2, "{fourth} | `only`");
    refused!("{ask} --lock={first}=0 --lock={first}=0" => 1, "{first} | locked twice");
    refused!("{ask} --lock=elbo" => 1, "moving joint | `elbo` | {second}");
    refused!("{ask} --lock={first}=99" => 1, "{first} | 99");
    refused!("{ask} --lock=x=y" => 2, "`y` is not a number");
}

#[test]
fn many_targets_and_paths_keep_locked_joints() {
    let panda = Seeded::panda();
    let folder = Folder::new("held");
    let tool = Placement::translation(Vector3::new(0.02, 0.0, 0.1));
    let mut q = panda.configuration(5);
    // A path stays on the branch of its start.
    let start = commas(&q);
    let mut next = || {
        (q[0], q[2], q[3]) = (q[0] + 0.02, 0.2, q[3] - 0.01);
        seven(&(panda.base_from("tool", &q) * tool))
    };
    let targets: Vec<Vec<f64>> = (0..6).map(|_| next()).collect();
    let file = folder.text("path.json", json!({"targets": targets, "tip_link": "tool"}));
    let held = format!("--lock=joint3=0.2 --start={start} --tool=0.02,0,0.1");
    for (subcommand, options) in [
        ("batch", ""),
        ("batch", "--together"),
        ("track", ""),
        ("batch", "@solve.solver=levenberg-marquardt"),
    ] {
        let all = answer!("{subcommand} {panda} --targets {file} {held} {options}");
        assert_eq!(all["summary"]["solved"], 6, "{subcommand} {options}");
        for (solution, target) in list(&all["solutions"]).iter().zip(&targets) {
            assert_eq!(value(solution, &all["joints"], "joint3"), 0.2);
            let placed = panda.base_from("tool", &numbers(&solution["q"])) * tool;
            assert!(distance(&seven(&placed)[..3], &target[..3]) < 1.1e-6);
        }
    }
}

#[test]
fn held_joints_are_shown_in_text() {
    let panda = Seeded::panda();
    let start = "--start=0,0,0.3,-1,0,1,0,0.01,0.01";
    let target = "--target=tool=0.4,0.1,0.5";
    for (option, held) in [
        ("--lock=joint3", &["joint3"][..]),
        (
            "@model.only=[\"joint1\",\"joint2\",\"joint4\"]",
            &["joint3", "joint5", "joint6", "joint7"],
        ),
    ] {
        let text = text!("solve {panda} {target} {start} {option}");
        let rows = text.lines().map(|row| row.split_whitespace().collect());
        let rows: Vec<Vec<&str>> = rows.collect();
        let locked_joints = rows.iter().filter(|row| row.last() == Some(&"locked"));
        let locked_joints: Vec<&str> = locked_joints
            .filter_map(|row| row.first().copied())
            .collect();
        assert_eq!(locked_joints, held, "{text}");
        assert!(rows.contains(&vec!["joint3", "0.300000", "locked"]));
    }
}

#[test]
fn tool_is_attached_to_the_tip() {
    let panda = Seeded::panda();
    let q = panda.configuration(11);
    let tool = "--tool=0,0.05,0.1,0.5,0.5,0.5,0.5";
    let target = typed("tool", &panda.pose(&q));
    for solver in ["--search=start", "@solve.solver=levenberg-marquardt"] {
        // The flange is away from the target, by the length of the tool.
        let solution = answer!("solve {panda} {target} {tool} {solver}");
        assert_eq!(solution["reached"], true, "{solver}: {solution}");
        let apart = panda.errors(&numbers(&solution["q"]), &panda.pose(&q))[0];
        assert!((apart - 0.05_f64.hypot(0.1)).abs() < 1e-5, "{apart}");
    }
    let other = "--target=hand=0.4,0,0.5";
    refused!("solve {panda} {target} {other} {tool}" => 2, "--tool | several");
    refused!("solve {panda} {target} --tool=1,2" => 2, "not 2");
}

#[test]
fn rigs_lock_bones_and_carry_tools() {
    let (_folder, rig) = Folder::with_rig("held-bones");
    let info = answer!("info {rig}");
    let bones: Vec<&str> = list(&info["bones"])
        .iter()
        .map(|bone| word(&bone["name"]))
        .collect();
    // Bones 1 and 2 are the left arm. Only the elbow is free.
    let (upper, lower) = (bones[1], bones[2]);
    let target = format!("--target={lower}=-1.9,0.9,0");
    for held in [
        format!("--lock={upper}"),
        format!("@model.only=[\"{lower}\"]"),
        "@model.only=[\"bone/2\"]".to_owned(),
    ] {
        let solution = answer!("solve {rig} {target} {held} --hold none");
        let q = numbers(&solution["q"]);
        assert!(q[3..6].iter().all(|angle| *angle == 0.0), "{held}: {q:?}");
        assert!(q[6..9].iter().any(|angle| *angle != 0.0), "{held}: {q:?}");
    }
    // A tool of 0.5 at the left hand reaches a target that the hand cannot reach.
    for (tool, reached) in [("", false), ("--tool=0.5,0,0", true)] {
        let solution = answer!("solve {rig} --target={lower}=-3.2,0.6,0 {tool}");
        assert_eq!(solution["reached"], reached, "{tool}");
    }
    refused!("solve {rig} {target} --lock={upper}=0.1" => 2, "{upper} | several angles");
    refused!("solve {rig} {target} --lock=tail" => 1, "bone or joint | `tail`");
}
