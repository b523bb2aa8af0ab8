//! Promise: a robot arm starts from the state `ready` or `home` of its SRDF file, else from the middle of its limits.
//! Python and JavaScript have the same rule. Bodies and figures start at rest.

use crate::forked_rig::*;
use serde_json::json;

const PANDA: &str = "../models/franka_panda.urdf";
const TARGET: &str = "--target flange=0.45,0.05,0.55,0,1,0,0";
/// Middle of the Panda's joint limits, with the fingers at rest.
const MIDDLE_CONFIGURATION: &str = "0,0,0,-1.5708,0,1.8675,0,0,0";
const READY_CONFIGURATION: &str = "0,-0.785,0,-2.356,0,1.571,0.785,0,0";

fn q_of(solution: &serde_json::Value) -> Vec<f64> {
    numbers(&solution["q"])
}

fn assert_near(a: &[f64], b: &[f64]) {
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(b) {
        assert!((a - b).abs() < 1e-4, "{a} {b}");
    }
}

#[test]
fn arm_starts_in_the_middle_of_its_limits() {
    let plain = answer!("solve {PANDA} {TARGET}");
    let middle = answer!("solve {PANDA} {TARGET} --start={MIDDLE_CONFIGURATION}");
    assert_eq!(plain["reached"], true);
    assert_near(&q_of(&plain), &q_of(&middle));
    assert_eq!(q_of(&plain)[7..], [0.0, 0.0]);
    let rest = answer!("solve {PANDA} {TARGET} --start=rest");
    assert!(
        q_of(&rest)
            .iter()
            .zip(q_of(&plain))
            .any(|(a, b)| (a - b).abs() > 1e-3)
    );
    // A tiny step bound shows the start configuration.
    let step = answer!("solve {PANDA} {TARGET} --max-move 0.000001");
    let start: Vec<f64> = MIDDLE_CONFIGURATION
        .split(',')
        .map(|number| number.parse().unwrap())
        .collect();
    assert_near(&q_of(&step), &start);
}

#[test]
fn arm_starts_at_the_srdf_state() {
    let folder = Folder::new("default-start");
    let file = folder.file("panda.srdf");
    let joints = READY_CONFIGURATION
        .split(',')
        .take(7)
        .enumerate()
        .map(|(index, value)| format!("<joint name='joint{}' value='{value}'/>", index + 1));
    let state = joints.collect::<String>();
    let text = format!(
        "<robot name='panda'><group name='arm'><chain base_link='base' tip_link='flange'/></group>\
         <group_state name='ready' group='arm'>{state}</group_state></robot>"
    );
    std::fs::write(&file, text).unwrap();
    let step = answer!("solve {PANDA} {TARGET} @model.srdf={file} --max-move 0.000001");
    let start: Vec<f64> = READY_CONFIGURATION
        .split(',')
        .map(|number| number.parse().unwrap())
        .collect();
    assert_near(&q_of(&step), &start);
    // `--start` has priority over the SRDF state.
    let step = answer!(
        "solve {PANDA} {TARGET} @model.srdf={file} --start={MIDDLE_CONFIGURATION} --max-move 0.000001"
    );
    let middle: Vec<f64> = MIDDLE_CONFIGURATION
        .split(',')
        .map(|number| number.parse().unwrap())
        .collect();
    assert_near(&q_of(&step), &middle);
}

#[test]
fn targets_of_a_file_start_at_the_default_start() {
    let folder = Folder::new("default-start-many");
    let file = folder.text("targets.json", json!({"targets": [[0.45, 0.05, 0.55]]}));
    let many = answer!("batch {PANDA} --targets {file} --tip flange --max-move 0.000001");
    let one = answer!("solve {PANDA} --target flange=0.45,0.05,0.55 --max-move 0.000001");
    let solutions = list(&many["solutions"]);
    assert_near(&q_of(&solutions[0]), &q_of(&one));
}
