//! Promise: held frames and balance have a higher priority level than targets, and `--level` sets other levels.

use crate::forked_rig::*;
use serde_json::{Value, json};

const NAO: &str = "../models/aldebaran_nao.urdf";
const UNREACHABLE_OPTIONS: &str =
    "--base-joint free --hold left_sole --hold right_sole --target left_hand=2,0.5,0";

fn task<'a>(answer: &'a Value, name: &str) -> &'a Value {
    let mut tasks = list(&answer["tasks"]).iter();
    tasks.find(|task| task["name"] == name).unwrap()
}

fn level(answer: &Value, name: &str) -> u64 {
    task(answer, name)["level"].as_u64().unwrap()
}

fn miss(answer: &Value, name: &str) -> f64 {
    number(&task(answer, name)["position_error"])
}

#[test]
fn feet_stay_where_a_hand_is_out_of_reach() {
    let answer = answer!("body {NAO} {UNREACHABLE_OPTIONS} @solve.attempts=1");
    assert_eq!(answer["reached"], false);
    for foot in ["hold left_sole", "hold right_sole"] {
        assert_eq!(task(&answer, foot)["reached"], true);
        assert_eq!(level(&answer, foot), 0);
    }
    assert_eq!(level(&answer, "target left_hand"), 2);
    assert!(miss(&answer, "target left_hand") > 0.5);
    let text = text!("body {NAO} {UNREACHABLE_OPTIONS} @solve.attempts=1");
    says!(text => "Level 2 gives way");

    let traded = answer!(
        "body {NAO} {UNREACHABLE_OPTIONS} --weight left_hand=100 @body.no_priorities=true @solve.attempts=1"
    );
    assert_eq!(level(&traded, "target left_hand"), 0);
    assert!(miss(&traded, "hold left_sole") > 0.1, "{traded}");
}

#[test]
fn reachable_solution_is_independent_of_levels() {
    let near =
        "--base-joint free --hold left_sole --hold right_sole --target left_hand=0.12,0.1,-0.05";
    let ranked = answer!("solve {NAO} {near}");
    let weighed = answer!("solve {NAO} {near} @body.no_priorities=true");
    assert_eq!(ranked["reached"], true, "{ranked}");
    // The rows have another order, so the last bits can differ.
    let apart = distance(&numbers(&ranked["q"]), &numbers(&weighed["q"]));
    assert!(apart < 1e-9, "{apart}");
}

#[test]
fn levels_are_set_by_target_and_task_names() {
    let tasks = json!([
        {"task": "gaze", "frame": "head", "axis": [1, 0, 0], "direction": [-1, 0, 0], "half_angle": 0.1,
            "level": 3},
        {"task": "joint coupling", "coefficients": {"left_shoulder_roll": 1, "right_shoulder_roll": 2},
            "tolerance": 1e-6, "name": "arms"},
    ]);
    let hands = "--target left_hand=2,0.5,0 --target right_hand=0.1,-0.2,0.05";
    let answer = answer!(
        "body {NAO} {hands} '@tasks={tasks}' --level left_hand=1 --level arms=4 @solve.max_iterations=5"
    );
    let levels = ["target left_hand", "target right_hand", "gaze head", "arms"];
    assert_eq!(levels.map(|name| level(&answer, name)), [1, 0, 3, 4]);
    let held = answer!(
        "body {NAO} {UNREACHABLE_OPTIONS} '@tasks={tasks}' --level left_sole=5 @solve.max_iterations=5"
    );
    let levels = [
        "target left_hand",
        "hold left_sole",
        "hold right_sole",
        "gaze head",
        "arms",
    ];
    assert_eq!(levels.map(|name| level(&held, name)), [2, 5, 0, 3, 2]);
}

#[test]
fn invalid_levels_are_rejected() {
    refused!("body {NAO} {UNREACHABLE_OPTIONS} --level nose=1" => 1, "no target, held frame or task named `nose`; valid names: left_hand, left_sole, right_sole");
    for wrong in [
        "left_hand",
        "left_hand=-1",
        "left_hand=high",
        "=1",
        "left_hand=1.5",
    ] {
        refused!("body {NAO} {UNREACHABLE_OPTIONS} --level {wrong}" => 2, "--level");
    }
}

#[test]
fn commands_of_the_page_miss_only_the_far_hand() {
    let page = include_str!("../../../docs/guide/priorities.md");
    let (_, fenced) = page.split_once("```sh\n").unwrap();
    let lines: Vec<&str> = fenced.split("```").next().unwrap().lines().collect();
    assert_eq!(lines.len(), 2);
    for line in lines {
        let words = line.strip_prefix("kinopt ").unwrap();
        let answer = answer!("{}", words.replace("models/", "../models/"));
        for task in list(&answer["tasks"]) {
            let is_unreachable = task["name"] == "target left_hand";
            assert_eq!(task["reached"], !is_unreachable, "{task}");
        }
    }
}
