//! Promise: the command reads MJCF files as robots, recognised by their root element. An SRDF file's passive joints
//! are locked, and `group` moves one group alone.

use crate::forked_rig::*;
use serde_json::json;

const GRIPPER: &str = "../tests/robot/mjcf/files/gripper.xml";

#[test]
fn info_fk_and_solve_take_mjcf() {
    let info = answer!("info {GRIPPER}");
    has!(info, {"kind": "robot", "name": "gripper", "degrees_of_freedom": 6, "free": 3});
    let joints = ["lift", "turn", "left", "left_tip", "right", "right_tip"];
    assert_eq!(info["moving_joints"], json!(joints));
    // Configuration that satisfies the joint equality and the mimic relations.
    let q = "0.1,0.55,0.2,-0.2,-0.2,0.35";
    let placed = answer!("fk {GRIPPER} --q {q} --frame pad");
    let position = numbers(&placed["frames"]["pad"]["position"]);
    let target = position.iter().map(f64::to_string).collect::<Vec<_>>();
    // The loops of this model cannot all be closed.
    let ask = format!("solve {GRIPPER} --target pad={}", target.join(","));
    let solution = answer!("{ask}");
    assert_eq!(solution["reached"], false);
    assert!(!list(&solution["open_loops"]).is_empty());
    let solution = answer!("{ask} @model.without_loops=true");
    assert_eq!(solution["reached"], true);
    let solved = numbers(&solution["q"]);
    assert!((solved[4] - (0.1 - 1.5 * solved[2])).abs() < 1e-12);
    assert!((solved[1] - 0.55).abs() < 1e-12);
}

#[test]
fn info_reports_limits_of_ball_joints() {
    let walker = "../tests/robot/mjcf/files/walker.xml";
    let info = answer!("info {walker}");
    let balls = list(&info["joints"])
        .iter()
        .filter(|joint| joint["kind"] == "ball");
    let limited = balls.filter(|joint| joint["cone"].is_object());
    let limited: Vec<_> = limited.collect();
    assert!(!limited.is_empty());
    for ball in limited {
        let max_angle = ball["cone"]["angle"].as_f64().unwrap().to_degrees();
        let text = text!("info {walker}");
        says!(text => &format!("{} | within a rotation of {max_angle:.3}", word(&ball["name"])));
    }
}

#[test]
fn srdf_fixes_passive_joints_and_moves_one_group() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    let file = folder.join("panda.srdf");
    let text = r#"<robot name="panda"><group name="arm"><chain base_link="base" tip_link="flange"/></group>
        <group name="front"><chain base_link="link3" tip_link="flange"/></group><passive_joint name="joint5"/></robot>"#;
    std::fs::write(&file, text).unwrap();
    let start = [0.1, -0.4, 0.2, -1.5, 0.3, 1.5, 0.4, 0.01, 0.01];
    let typed = start.map(|value: f64| value.to_string()).join(",");
    let ask = format!(
        "solve ../models/franka_panda.urdf --target flange=0.45,0.05,0.55 --start={typed} @model.srdf={}",
        file.display()
    );
    let all = numbers(&answer!("{ask}")["q"]);
    assert_eq!((all[4], all[0] == 0.1), (0.3, false));
    let front = numbers(&answer!("{ask} @model.group=front")["q"]);
    assert_eq!(front[..3], start[..3]);
    assert_eq!(front[4], 0.3);
    assert_ne!(front[3], start[3]);
    // An SRDF file for another version of the robot.
    let text = text.replace("</robot>", r#"<passive_joint name="joint9"/></robot>"#);
    std::fs::write(&file, text).unwrap();
    refused!("{ask}" => 1, "panda.srdf:2: passive_joint `joint9` | --lenient");
    let (mended, notes) = answer!(with_messages "{ask} @model.group=front --lenient");
    says!(notes => "panda.srdf:2: passive_joint `joint9`: left out: ");
    assert_eq!(
        notes.matches("passive_joint `joint9`").count(),
        1,
        "{notes}"
    );
    assert_eq!(numbers(&mended["q"]), front);
}
