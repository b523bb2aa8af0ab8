//! Promise: `--base-joint` gives a robot a moving base within `base_bounds`, and `--hold` keeps links in place.

use crate::forked_rig::*;
use serde_json::{Value, json};

const UR5E: &str = "../models/universal_ur5e.urdf";
const NAO: &str = "../models/aldebaran_nao.urdf";

fn norm(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b) * (a - b))
        .sum::<f64>()
        .sqrt()
}

fn position(answer: &Value, frame: &str) -> Vec<f64> {
    numbers(&answer["frames"][frame]["position"])
}

#[test]
fn free_base_moves_where_the_arm_does_not_reach() {
    let ask = format!("solve {UR5E} --target flange=3,-2,1.5,1,0,0,0");
    assert_eq!(answer!("{ask}")["reached"], false);
    let solution = answer!("{ask} --base-joint free");
    assert_eq!(solution["reached"], true);
    let q = numbers(&solution["q"]);
    assert_eq!(q.len(), 7 + 6);
    let length: f64 = q[3..7].iter().map(|part| part * part).sum();
    assert!((length - 1.0).abs() < 1e-12);
    let placed = answer!(
        "fk {UR5E} --base-joint free --q={} --frame flange",
        commas(&q)
    );
    assert!(norm(&position(&placed, "flange"), &[3.0, -2.0, 1.5]) < 1e-6);
}

#[test]
fn base_stays_within_its_bounds() {
    let ask = format!("solve {UR5E} --target flange=3,-2,1.5 --base-joint");
    let bounds = "@model.base_bounds.x=[-0.1,0.2] @model.base_bounds.y=[-1,1]";
    let solution = answer!("{ask} planar {bounds}");
    assert_eq!(solution["reached"], false);
    let q = numbers(&solution["q"]);
    assert!(
        (-0.1..=0.2).contains(&q[0]) && (-1.0..=1.0).contains(&q[1]),
        "{q:?}"
    );
    let limits: Vec<&str> = list(&solution["active_limits"])
        .iter()
        .map(|l| word(&l["joint"]))
        .collect();
    assert!(
        limits.contains(&"root_joint/x") && limits.contains(&"root_joint/y"),
        "{limits:?}"
    );
    let rail = answer!("{ask} slide-x");
    assert_eq!(rail["reached"], false, "it is 2 m beside the rail");
    refused!("{ask} slide-x {bounds}" => 2, "base_bounds of a slide-x base | `y`");
    refused!("{ask} hover" => 2, "hover | free");
    refused!("{ask} planar @model.base_bounds.x=[1,0]" => 1, "root_joint/x");
}

#[test]
fn held_link_keeps_its_pose() {
    let start = "--start=0.1,0.2,0.3,0.9,0.1,-0.3,0.2,0.1,-1.2,1.1,0.2,0.3,0.4";
    let base = format!("{UR5E} --base-joint free");
    let before = answer!("fk {base} --q={} --frame flange --frame link1", &start[8..]);
    let at = position(&before, "link1");
    let goal: Vec<f64> = position(&before, "flange")
        .iter()
        .map(|value| value + 0.1)
        .collect();
    let target = format!("--target flange={}", commas(&goal));
    let solution = answer!("solve {base} {start} {target} --hold link1");
    assert_eq!(solution["reached"], true);
    let q = commas(&numbers(&solution["q"]));
    let after = answer!("fk {base} --q={q} --frame link1");
    assert!(norm(&position(&after, "link1"), &at) < 1e-5);
    let turned = |answer: &Value| numbers(&answer["frames"]["link1"]["quaternion"]);
    assert!(norm(&turned(&after), &turned(&before)) < 1e-5);
}

#[test]
fn body_crouches_over_its_held_feet() {
    let feet = "--base-joint free --hold left_sole --hold right_sole";
    let body = format!("{NAO} {feet}");
    let placed = |q: &str, frame: &str| {
        let placed = answer!("fk {NAO} --base-joint free {q} --frame {frame}");
        position(&placed, frame)
    };
    let target = "--target left_hand=0.12,0.1,-0.2";
    let solution = answer!("solve {body} --start bent {target}");
    assert_eq!(solution["reached"], true);
    let q = format!("--q={}", commas(&numbers(&solution["q"])));
    for sole in ["left_sole", "right_sole"] {
        assert!(norm(&placed(&q, sole), &placed("", sole)) < 1e-5);
    }
    let joints = list(&solution["joints"]);
    let knee = joints
        .iter()
        .position(|name| name == "left_knee_pitch")
        .unwrap();
    assert!(numbers(&solution["q"])[knee] > 0.5, "the knees give way");
    // The text lists the leg joints, which move only because of the held feet.
    says!(text!("solve {body} --start bent {target}") => "left_knee_pitch | right_ankle_roll | hold left_sole");
    refused!("solve {NAO} --hold left_sole --start bent {target}" => 2, "--start bent | --base-joint free");
    // For a target out of reach the feet hardly move, as their weight is ten times that of the hand.
    let missed = answer!("solve {body} --start bent --target left_hand=2,0.1,0 @solve.attempts=1");
    let q = format!("--q={}", commas(&numbers(&missed["q"])));
    assert!(
        missed["reached"] == false
            && norm(&placed(&q, "left_sole"), &placed("", "left_sole")) < 0.05
    );
}

#[test]
fn zero_quaternion_is_rejected_by_name() {
    let q = "0,0,0,0,0,0,0,0,0,0,0,0,0";
    refused!("fk {UR5E} --base-joint free --q {q} --frame flange" => 2, "root_joint | length 0");
}

#[test]
fn quaternion_of_another_length_is_reported() {
    let ask = format!("fk {UR5E} --base-joint free --frame base");
    let with = |parts: &str| format!("{ask} --q=0,0,0,{parts},0,0,0,0,0,0");
    let [unit, long, typed] = ["0.6,0,0,0.8", "1.2,0,0,1.6", "0.6001,0,0,0.7999"].map(with);
    let quiet = answer!("{unit}");
    let (answer, messages) = answer!(with_messages "{long}");
    says!(messages => "--q | `root_joint/rotation` | length 2.000000");
    assert_eq!(answer["frames"], quiet["frames"]);
    let (_, messages) = answer!(with_messages "{typed}");
    assert!(!messages.contains("length"), "{messages}");
}

#[test]
fn frame_with_a_target_cannot_be_held() {
    let ask = format!("solve {UR5E} --base-joint free --target flange=3,-2,1.5");
    refused!("{ask} --hold flange" => 2, "--hold flange | target");
    refused!("{ask} --hold link1 --hold flange" => 2, "--hold flange | target");
}

fn turn(from: &[f64], to: &[f64]) -> f64 {
    let dot: f64 = from.iter().zip(to).map(|(a, b)| a * b).sum();
    2.0 * dot.abs().min(1.0).acos()
}

#[test]
fn body_keeps_its_move_limits() {
    let start = [
        0.1, 0.2, 0.3, 0.9, 0.1, -0.3, 0.3, 0.1, -1.2, 1.1, 0.2, 0.3, 0.4,
    ];
    let stood = start[3..7].to_vec();
    let body = format!("{UR5E} --base-joint free --start={}", commas(&start));
    let ask = format!("solve {body} --target flange=3,-2,1.5,1,0,0,0");
    let within = |q: &[f64], max_distance: f64| {
        for k in (0..3).chain(7..13) {
            assert!((q[k] - start[k]).abs() <= max_distance, "{k}: {q:?}");
        }
        assert!(turn(&q[3..7], &stood) <= max_distance + 1e-9, "{q:?}");
    };
    let solution = answer!("{ask} --max-move 0.05");
    assert_eq!(solution["reached"], false);
    let q = numbers(&solution["q"]);
    within(&q, 0.05);
    assert!(turn(&q[3..7], &stood) > 0.05 - 1e-6 && q[0] - start[0] > 0.05 - 1e-12);
    let kinds: Vec<&str> = list(&solution["active_limits"])
        .iter()
        .map(|l| word(&l["kind"]))
        .collect();
    assert!(kinds.contains(&"move"), "{kinds:?}");
    // `--degrees` applies to rotations only; translations remain in metres.
    let each = [&[0.01; 3][..], &[2.0; 4], &[3.0; 6]].concat();
    let rest = format!("solve {UR5E} --base-joint free --target flange=3,-2,1.5,1,0,0,0 --degrees");
    let q = numbers(&answer!("{rest} --max-move={}", commas(&each))["q"]);
    let turned = turn(&q[3..7], &[1.0, 0.0, 0.0, 0.0]).to_degrees();
    assert!(q[0].abs() <= 0.01 && turned <= 2.0 + 1e-9, "{q:?}");
    assert!(q[7..].iter().all(|angle| angle.to_degrees() <= 3.0 + 1e-9) && turned > 1.0);
    refused!("{ask} --max-move=1,2" => 2, "--max-move | 2 numbers | 13 | root_joint/rotation w");
    refused!("{ask} --max-move=-1" => 1, "max_move is -1");
    // `--max-move` also bounds general solvers, the steps of a path and figures.
    let q = numbers(&answer!("{ask} @solve.solver=gauss-newton --max-move 0.02")["q"]);
    within(&q, 0.02);
    let folder = Folder::new("moves-of-a-path");
    let targets = json!({"targets": [[0.2, 0.3, 1.0], [0.5, 0.3, 1.0], [2.0, 0.3, 1.0]]});
    let targets = folder.text("path.json", &targets);
    let path =
        answer!("track {UR5E} --base-joint free --tip flange --targets {targets} --max-move 0.1");
    let mut before = vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    for step in list(&path["solutions"]) {
        let q = numbers(&step["q"]);
        let farthest = (0..3).map(|k| (q[k] - before[k]).abs()).fold(0.0, f64::max);
        assert!(
            farthest <= 0.1 && turn(&q[3..7], &before[3..7]) <= 0.1 + 1e-9,
            "{q:?}"
        );
        before = q;
    }
    let humanoid = "../models/humanoid/humanoid.json";
    let q =
        numbers(&answer!("solve {humanoid} --target left_hand=0.3,0.6,1.9 --max-move 0.04")["q"]);
    let farthest = q
        .iter()
        .fold(0.0_f64, |largest, angle| largest.max(angle.abs()));
    assert!(farthest <= 0.04 && farthest > 0.03, "{farthest}");
}

/// The option that a miss suggests lowers the cost.
#[test]
fn global_search_after_a_miss_lowers_the_cost() {
    let ask = format!("solve {NAO} --base-joint free --hold left_sole --hold right_sole");
    let ask = format!("{ask} --target left_hand=0.6,0.1,0.1");
    let solution = answer!("{ask}");
    assert_eq!(solution["reached"], false);
    let anywhere = answer!("{ask} @solve.global_search_on_miss=true");
    assert!(anywhere["cost"].as_f64().unwrap() <= solution["cost"].as_f64().unwrap());
}
