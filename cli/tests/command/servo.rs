//! Promise: `kinopt servo` keeps velocity and position limits, reaches the last target if there is time, and reports the
//! active limits.

use crate::forked_rig::*;
use crate::seeded_robot::Seeded;
use serde_json::{Value, json};

/// File of targets that descend by 5 cm at 0.2 m/s and 1000 targets per second, then rest.
fn targets(folder: &Folder, seeded: &Seeded, start: &[f64]) -> (String, Vec<f64>) {
    let mut pose = seeded.pose(start);
    let down = |tick| {
        pose[2] -= if tick < 250 { 2e-4 } else { 0.0 };
        pose.clone()
    };
    let poses: Vec<Vec<f64>> = (0..400).map(down).collect();
    let starts = vec![start; poses.len()];
    let (tip, base) = (seeded.tip, seeded.base);
    let content = json!({"targets": poses, "starts": starts, "tip_link": tip, "base_link": base});
    (folder.text("line.json", content), pose)
}

/// Configuration with a bent elbow, away from limits, with closed fingers.
const START: [f64; 7] = [0.1, -0.6, 0.2, -2.2, 0.1, 1.8, 0.7];

fn start(seeded: &Seeded) -> Vec<f64> {
    let mut q = seeded.configuration(1);
    q[..7].copy_from_slice(&START);
    q
}

/// Velocities between control cycles, computed from the configurations, by joint of the arm.
fn speeds(ticks: &[Value], start: &[f64]) -> Vec<Vec<f64>> {
    let mut before = start.to_vec();
    let speeds_of = |tick: &Value| {
        let q = numbers(&tick["q"]);
        let speeds = q.iter().zip(&before).map(|(a, b)| 1e3 * (a - b).abs());
        let speeds = speeds.take(7).collect();
        before = q;
        speeds
    };
    ticks.iter().map(speeds_of).collect()
}

#[test]
fn line_is_followed_within_velocity_limits() {
    let folder = Folder::new("servo");
    let seeded = Seeded::panda();
    let start = start(&seeded);
    let (file, last) = targets(&folder, &seeded, &start);
    let document = answer!("servo {seeded} --targets {file} --rate 1000");
    let ticks = list(&document["ticks"]);
    assert_eq!(ticks.len(), 400);
    let moving = seeded.robot.model().moving_joints()[..7].iter();
    let limits: Vec<f64> = moving
        .map(|&id| seeded.robot.velocity_limit(id).unwrap())
        .collect();
    assert_eq!(numbers(&document["velocity_limits"]), limits);
    for speeds in speeds(ticks, &start) {
        for (speed, limit) in speeds.iter().zip(&limits) {
            assert!(*speed <= limit * (1.0 + 1e-9), "{speed} of {limit}");
        }
    }
    seeded.check(&numbers(&ticks[399]["q"]), &last);
    assert_eq!(ticks[399]["status"], "on target");
    // The top speed of a joint is its largest absolute velocity.
    let top_speeds = numbers(&document["summary"]["top_speeds"]);
    let velocities: Vec<Vec<f64>> = (ticks.iter())
        .map(|tick| numbers(&tick["velocity"]))
        .collect();
    for (joint, top) in top_speeds.iter().enumerate() {
        let speeds = velocities.iter().map(|velocity| velocity[joint].abs());
        assert_eq!(*top, speeds.fold(0.0, f64::max), "joint {joint}");
    }
    assert!(top_speeds.iter().any(|top| *top > 0.1), "{top_speeds:?}");
    let text = text!("servo {seeded} --targets {file} --rate 1000");
    assert!(text.starts_with("cycles    400 at 1000 Hz"), "{text}");
    says!(text => "end       on target");
}

#[test]
fn slower_limits_hold_and_are_reported() {
    let folder = Folder::new("slow-servo");
    let seeded = Seeded::panda();
    let start = start(&seeded);
    let (file, last) = targets(&folder, &seeded, &start);
    let slow = "--rate 1000 --velocity-limits 0.05 --json --fail-on-miss";
    let missed = kinopt!("servo {seeded} --targets {file} {slow}");
    let document: Value = serde_json::from_str(stdout(&missed)).unwrap();
    let ticks = list(&document["ticks"]);
    let all = speeds(ticks, &start).concat();
    assert!(all.iter().all(|speed| *speed <= 0.05 * (1.0 + 1e-9)));
    assert!(all.iter().any(|speed| *speed > 0.05 * (1.0 - 1e-9)));
    let mut held = ticks[200]["held"].as_object().unwrap().values();
    assert!(held.any(|limit| word(limit).starts_with("velocity limit")));
    // After 0.2 s the arm is still moving, and the exit code reports it.
    let [metres, _] = seeded.errors(&numbers(&ticks[399]["q"]), &last);
    assert!(metres > 1e-3, "{metres}");
    assert_eq!(missed.status.code(), Some(3), "{}", stderr(&missed));
}

#[test]
fn invalid_servo_options_are_rejected() {
    let folder = Folder::new("no-servo");
    let seeded = Seeded::panda();
    let (file, _) = targets(&folder, &seeded, &start(&seeded));
    let command = format!("servo {seeded} --targets {file}");
    refused!("{command}" => 2, "--rate");
    refused!("{command} --rate 0" => 2, "--rate");
    refused!("{command} --rate 1000 @solve.max_move=1" => 2, "`max_move`");
    refused!("{command} --rate 1000 @solve.solver=gauss-newton" => 2, "servo | `solver`");
    let too_few = "--velocity-limits: 2 numbers given";
    refused!("{command} --rate 1000 --velocity-limits 1,2" => 2, "{too_few}");
    let rig = model("humanoid/humanoid.json");
    let ours = "--tip left_hand --rate 1000";
    refused!("servo {rig} --targets {file} {ours}" => 2, "kinopt servo is for robots");
}

#[test]
fn contact_is_reported_and_target_unreached() {
    let folder = Folder::new("servo-touching");
    let seeded = Seeded::panda();
    let start = start(&seeded);
    let pose = seeded.pose(&start);
    let (tip, base) = (seeded.tip, seeded.base);
    let content = json!({"targets": [pose], "starts": [start], "tip_link": tip, "base_link": base});
    let targets = folder.text("one.json", content);
    let position = json!([pose[0], pose[1], pose[2] - 0.02]);
    let world = folder.text(
        "world.json",
        json!({"boxes": [{"name": "block", "size": [0.1, 0.1, 0.1], "position": position}]}),
    );
    let line = format!("servo {seeded} --targets {targets} --rate 100 --world {world}");
    let text = text!("{line}");
    says!(text => "1 in contact | obstacle `block`");
    let document = answer!("{line}");
    let tick = &document["ticks"][0];
    assert_eq!(tick["status"], "in contact");
    assert_eq!(tick["collisions"][0]["second"], "block");
    assert!(tick["collisions"][0]["distance"].as_f64().unwrap() < 0.0);
    assert_eq!(kinopt!("{line} --fail-on-miss").status.code(), Some(3));
}
