//! Promise: MuJoCo's MJCF files are robots to the command as URDF is, told by the document's own element.

use crate::forked_rig::*;
use serde_json::json;

const GRIPPER: &str = "../tests/mjcf/files/gripper.xml";

#[test]
fn info_fk_and_solve_take_mjcf() {
    let info = answer!("info {GRIPPER}");
    has(
        &info,
        json!({"kind": "robot", "name": "gripper", "degrees_of_freedom": 6, "free": 3}),
    );
    let joints = ["lift", "turn", "left", "left_tip", "right", "right_tip"];
    assert_eq!(info["moving_joints"], json!(joints));
    // The joint that an equality holds, and the followers, as the relations have them.
    let q = "0.1,0.55,0.2,-0.2,-0.2,0.35";
    let placed = answer!("fk {GRIPPER} --q {q} --frame pad");
    let position = numbers(&placed["frames"]["pad"]["position"]);
    let target = position.iter().map(f64::to_string).collect::<Vec<_>>();
    let solution = answer!("solve {GRIPPER} --target pad={}", target.join(","));
    assert_eq!(solution["reached"], true);
    let solved = numbers(&solution["q"]);
    assert!((solved[4] - (0.1 - 1.5 * solved[2])).abs() < 1e-12);
    assert!((solved[1] - 0.55).abs() < 1e-12);
}
