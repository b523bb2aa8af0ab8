//! Promise: the command closes the loops of files and of `connect` and `weld`. `fk` moves passive joints to close
//! loops and reports loops that stay open.

use crate::forked_rig::*;
use serde_json::json;

const LEG: &str = "../tests/solver/loops/files/knee.xml";
const BAXTER: &str = "../models/rethink_baxter.urdf";

#[test]
fn info_lists_loops_and_passive_joints() {
    let info = answer!("info {LEG}");
    let knee = json!({"name": "knee_rod", "kind": "connect", "frames": ["knee_rod", "shank"],
        "joints": ["knee_rod", "knee_motor", "knee"]});
    assert_eq!(info["loops"][0], knee);
    assert_eq!(info["loops"][1]["name"], "ankle_rod/connect");
    assert!(list(&info["passive_joints"]).contains(&json!("knee")));
    assert!(text!("info {LEG}").contains("knee_rod, ankle_rod/connect"));
}

#[test]
fn fk_closes_loops_by_passive_joints() {
    let motors = |knee: f64| format!("0,0,0.9,1,0,0,0,0.2,{knee},1,0,0,0,0,0,0,0");
    let placed = answer!("fk {LEG} --q {} --frame foot", motors(0.5));
    let q = numbers(&placed["q"]);
    assert_eq!((q[7], q[8]), (0.2, 0.5));
    assert!(q[13] > 0.3, "the knee bends: {q:?}");
    for closure in list(&placed["loops"]) {
        assert_eq!(closure["closed"], true);
    }
    refused!("fk {LEG} --q {} --frame foot", motors(1.6) => 1, "loop `knee_rod` is open by | no values of knee_rod, knee");
    // Without passive joints the configuration is used as given.
    let as_given = answer!(
        "fk {BAXTER} @model.weld=[{{\"frames\":[\"left_tool\",\"right_tool\"]}}] --frame left_tool"
    );
    assert_eq!(as_given["loops"][0]["closed"], false);
}

#[test]
fn solve_closes_loops_of_files_and_options() {
    let solution = answer!("solve {LEG} --target foot=0.1,0.1,0.2");
    has!(solution, {"reached": true, "open_loops": []});

    // Box held by two hands; the target is for one of them.
    let grip = [0.0, 0.0, 0.2, 0.5_f64.sqrt(), 0.5_f64.sqrt(), 0.0, 0.0];
    let mut other = grip;
    other[4] = -other[4];
    let hands = json!([{"frames": ["left_tool", "right_tool"], "placements": [grip, other]}]);
    let solution = answer!("solve {BAXTER} @model.weld={hands} --target left_tool=0.7,0.2,0.3");
    has!(solution, {"reached": true, "open_loops": []});
    let q = commas(&numbers(&solution["q"]));
    let placed = answer!("fk {BAXTER} @model.weld={hands} --q={q} --frame left_tool");
    assert!(placed["loops"][0]["gap"].as_f64().unwrap() <= 1e-9);
}

#[test]
fn invalid_loops_are_rejected_by_name() {
    let ask = format!("solve {BAXTER} --target left_tool=0.7,0.2,0.3");
    let connect = |first: &str, placement: &str| {
        format!(
            r#"{ask} @model.connect=[{{"frames":["{first}","right_tool"],"placements":[{placement},[0,0,0]]}}]"#
        )
    };
    refused(&connect("left_tool", "[1,2]"), 1, "model: | 3 numbers");
    refused(&connect("left_tool", "[1e200,0,0]"), 1, "model: | 1e150");
    refused(&connect("left_tol", "[0,0,0]"), 1, "connect | left_tool");
    let open = "loop `left_tool=right_tool` cannot close";
    refused(&connect("left_tool", "[99,0,0]"), 1, open);
    refused!("{ask} @model.connect=[1]" => 1, "model: | ClosedLoop");
    refused!("{ask} @model.passive=[\"elbow\"]" => 1, "passive | elbow");
    let rig = "../models/robot-arm/robot-arm.json";
    refused!("fk {rig} @model.passive=[\"a\"]" => 2, "`passive` is for robots");
}
