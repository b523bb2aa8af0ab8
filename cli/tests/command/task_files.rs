//! Promise: `tasks` of a problem file are added to targets and balance. Errors name the location in the file.

use crate::forked_rig::*;
use serde_json::{Value, json};

const NAO: &str = "../models/aldebaran_nao.urdf";

fn of_joint(answer: &Value, joint: &str) -> f64 {
    let joints = list(&answer["joints"]);
    let at = joints.iter().position(|name| name == joint).unwrap();
    numbers(&answer["q"])[at]
}

/// Position of a frame in a solution, and the image of its x axis.
fn placed(folder: &Folder, options: &str, answer: &Value, frame: &str) -> (Vec<f64>, [f64; 3]) {
    let file = folder.text("answer.json", answer);
    let placed = answer!("fk {NAO} {options} --q-file {file} --frame {frame}");
    let frame_placement = &placed["frames"][frame];
    let turned = numbers(&frame_placement["quaternion"]);
    let [w, x, y, z] = [0, 1, 2, 3].map(|part| turned[part]);
    let ahead = [
        1.0 - 2.0 * (y * y + z * z),
        2.0 * (x * y + w * z),
        2.0 * (x * z - w * y),
    ];
    (numbers(&frame_placement["position"]), ahead)
}

#[test]
fn each_task_has_its_effect() {
    let folder = Folder::new("task-file");
    let tasks = json!([
        {"task": "gaze", "frame": "head", "axis": [1, 0, 0], "direction": [1, 1, 0], "half_angle": 0.3},
        {"task": "frame velocity", "frame": "left_hand", "time_step_s": 0.1, "linear": [0.1, 0, 0.05]},
        {"task": "joint coupling", "coefficients": {"left_shoulder_roll": 1, "right_shoulder_roll": 2},
            "offset": 0.4, "name": "arms", "tolerance": 1e-9},
        {"task": "manipulability", "frame": "right_hand", "base": "torso", "least": 1e-5, "of": "position",
            "role": "preference"},
    ]);
    // A fixed arm with five joints cannot reach a velocity of six components.
    let free = "--base-joint free";
    let answer = answer!("body {NAO} {free} '@tasks={tasks}'");
    assert_eq!(answer["reached"], true);
    let names: Vec<&str> = list(&answer["tasks"])
        .iter()
        .map(|task| word(&task["name"]))
        .collect();
    let manipulability = "manipulability right_hand";
    assert_eq!(
        names,
        [
            "gaze head",
            "frame velocity left_hand",
            "arms",
            manipulability
        ]
    );
    let (_, ahead) = placed(&folder, free, &answer, "head");
    let angle = ((ahead[0] + ahead[1]) / 2f64.sqrt()).acos();
    assert!(angle < 0.3 + 1e-6, "{angle}");
    let rolls =
        of_joint(&answer, "left_shoulder_roll") + 2.0 * of_joint(&answer, "right_shoulder_roll");
    assert!((rolls - 0.4).abs() < 1e-8);
    // Hand position at the start, from a task of zero velocity.
    let at_rest = json!([{"task": "frame velocity", "frame": "left_hand", "time_step_s": 1}]);
    let begun = answer!("body {NAO} {free} '@tasks={at_rest}'");
    let (from, _) = placed(&folder, free, &begun, "left_hand");
    let (to, _) = placed(&folder, free, &answer, "left_hand");
    for (moved, direction) in to
        .iter()
        .zip(&from)
        .map(|(to, from)| to - from)
        .zip([0.01, 0.0, 0.005])
    {
        assert!((moved - direction).abs() < 1e-6, "{from:?} {to:?}");
    }
}

#[test]
fn posture_weights_distribute_the_null_space() {
    let moved = |weights: &Value| {
        let tasks = json!([{"task": "posture", "joint_weights": weights}]);
        let free = "--base-joint free --hold left_sole";
        let answer = answer!("body {NAO} {free} --target left_hand=0.25,0.1,0.05 '@tasks={tasks}'");
        assert_eq!(answer["reached"], true);
        ["left_shoulder_pitch", "left_hip_pitch"].map(|joint| of_joint(&answer, joint).abs())
    };
    let [_, hip] = moved(&json!({"left_hip_pitch": 0.1}));
    let [_, stiff] = moved(&json!({"left_hip_pitch": 30}));
    assert!(stiff < 0.1 * hip, "{stiff} {hip}");
    moved(&json!("by range"));
}

/// An arm with five joints misses a velocity of six components, so the weights decide how.
#[test]
fn weight_is_a_factor_of_the_default_weights() {
    let moved = |weight: &str| {
        let task = format!(
            "[{{\"task\": \"frame velocity\", \"frame\": \"left_hand\", \"time_step_s\": 0.5, \"linear\": [0.1, 0.2, 0.3]{weight}}}]"
        );
        answer!("body {NAO} '@tasks={task}'")["q"].clone()
    };
    assert_eq!(moved(", \"weight\": 1"), moved(""));
}

#[test]
fn invalid_task_files_are_rejected_by_location() {
    for (tasks, words) in [
        (json!({}), "not a list of tasks"),
        (json!([]), "the list has no task"),
        (json!([3]), "[0] | not an object"),
        (json!([{"frame": "head"}]), "[0] | `task` | gaze, look at"),
        (json!([{"task": "stare"}]), "[0] | `stare` | gaze, look at"),
        (
            json!([{"task": "look at", "frame": "head", "axis": [1, 0, 0]}]),
            "[0] | `target`",
        ),
        (
            json!([{"task": "look at", "frame": "hed", "axis": [1, 0, 0], "target": [1, 0, 0]}]),
            "[0] | `hed` | head",
        ),
        (
            json!([{"task": "gaze", "frame": "head", "axis": [1, 0, 0], "half_angle": 0.1}]),
            "[0] | `target` or `direction`",
        ),
        (
            json!([{"task": "gaze", "frame": "head", "axis": [1, 0, 0], "half_angle": 9, "target": [1, 0, 0]}]),
            "gaze head | half",
        ),
        (
            json!([{"task": "joint coupling", "coefficients": {}}]),
            "joint coupling | couples no joints",
        ),
        (
            json!([{"task": "joint coupling", "coefficients": {"elbow": 1}}]),
            "[0] | `elbow`",
        ),
        (
            json!([{"task": "posture", "q": [1, 2]}]),
            "[0] | 2 numbers | 24",
        ),
        (
            json!([{"task": "posture", "joint_weights": "evenly"}]),
            "[0] | by range",
        ),
        (
            json!([{"task": "posture", "weight": -1}]),
            "[0] | `weight` | below 0",
        ),
        (json!([{"task": "posture", "wieght": 1}]), "[0] | `wieght`"),
        (
            json!([{"task": "posture", "role": "wish"}]),
            "[0] | `wish` | goal",
        ),
    ] {
        refused!("body {NAO} '@tasks={tasks}'" => 1, "{words}");
    }
}
