//! Promise: a robot moves on the base that `--base-joint` puts under it, within `--base-room`, while links that
//! `--hold` names stay where they are.

use crate::forked_rig::*;
use serde_json::Value;

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
fn a_free_base_goes_where_the_arm_does_not_reach() {
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
fn a_base_stays_in_its_room() {
    let ask = format!("solve {UR5E} --target flange=3,-2,1.5 --base-joint");
    let room = "--base-room x=-0.1..0.2,y=-1..1";
    let solution = answer!("{ask} planar {room}");
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
    refused!("{ask} slide-x {room}" => 2, "--base-room y | does not move along y");
    refused!("{ask} hover" => 2, "hover | free");
    refused!("{ask} planar --base-room x=1..0" => 2, "1..0 | wrong order");
}

#[test]
fn a_link_that_is_held_stays_as_it_is_turned() {
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
fn a_body_crouches_from_bent_knees_over_its_feet() {
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
    // What is told of it has the legs too, which the target alone does not move.
    says(
        &text!("solve {body} --start bent {target}"),
        "left_knee_pitch | right_ankle_roll | hold left_sole",
    );
    refused!("solve {NAO} --hold left_sole --start bent {target}" => 2, "--start bent | --base-joint free");
    // Beyond reach the feet hardly move: they count ten times as much as the hand.
    let missed = answer!("solve {body} --start bent --target left_hand=2,0.1,0 --attempts 1");
    let q = format!("--q={}", commas(&numbers(&missed["q"])));
    assert!(
        missed["reached"] == false
            && norm(&placed(&q, "left_sole"), &placed("", "left_sole")) < 0.05
    );
}

#[test]
fn a_quaternion_without_length_is_refused_by_name() {
    let q = "0,0,0,0,0,0,0,0,0,0,0,0,0";
    refused!("fk {UR5E} --base-joint free --q {q} --frame flange" => 1, "root_joint | quaternion without length");
}
