//! Promise: any base and tip, any subset of joints and a tool on any frame are accepted. Unknown names are reported
//! with the valid ones.

use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{JointId, ModelError};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3, rotation_exp};

fn names(robot: &Robot, joints: &[JointId]) -> Vec<String> {
    let joint = |id: &JointId| robot.model().joints()[id.index()].name.clone();
    joints.iter().map(joint).collect()
}

#[test]
fn chain_passes_the_common_ancestor() {
    let robot = Robot::read("../models/rethink_baxter.urdf").unwrap();
    let arm = robot.chain("torso", "left_tool").unwrap();
    let seven = ["s0", "s1", "e0", "e1", "w0", "w1", "w2"];
    assert_eq!(names(&robot, &arm), seven.map(|n| format!("left_{n}")));

    let both = robot.chain("right_e0_link", "left_e0_link").unwrap();
    let expected = [
        "right_e0", "right_s1", "right_s0", "left_s0", "left_s1", "left_e0",
    ];
    assert_eq!(names(&robot, &both), expected);

    let forearm = robot.chain("left_upper_arm", "left_w0_link").unwrap();
    assert_eq!(names(&robot, &forearm), ["left_e0", "left_e1", "left_w0"]);
    assert!(robot.chain("torso", "torso").unwrap().is_empty());

    let message = robot.chain("torso", "left_hand").unwrap_err().to_string();
    assert!(message.starts_with("no frame named `left_hand`"));
    assert!(message.contains("`left_"), "{message}");
}

#[test]
fn tips_are_the_leaves_of_the_tree() {
    let tips = |file: &str| -> Vec<String> {
        let robot = Robot::read(file).unwrap();
        let name = |id: kinopt::model::FrameId| robot.model().frames()[id.index()].name.clone();
        robot.tips().into_iter().map(name).collect()
    };
    assert_eq!(tips("../models/universal_ur5e.urdf"), ["flange"]);
    assert_eq!(
        tips("../models/rethink_baxter.urdf"),
        ["left_tool", "right_tool"]
    );
    let panda = tips("../models/franka_panda.urdf");
    assert_eq!(panda, ["tool", "finger_left", "finger_right"]);
}

#[test]
fn subset_moves_and_the_rest_is_locked() {
    let robot = Robot::read("../models/kuka_iiwa14.urdf").unwrap();
    let rest = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7];
    let wrist = robot.joints(&["joint7", "joint5"]).unwrap();
    let map = robot.parameters().with_only(&wrist, &rest).build().unwrap();
    assert_eq!(map.variables(), 2);
    let mut q = [0.0; 7];
    map.expand(&[-0.5, -0.7], &mut q).unwrap();
    assert_eq!(q, [0.1, 0.2, 0.3, 0.4, -0.5, 0.6, -0.7]);

    let message = robot.joints(&["joint7", "joint9"]).unwrap_err().to_string();
    assert!(message.starts_with("no joint named `joint9`; valid names: joint1, joint2"));
}

#[test]
fn tool_is_fixed_to_its_frame() {
    let offset = Placement::new(
        rotation_exp(Vector3::new(0.3, -0.2, 1.1)),
        Vector3::new(0.01, -0.02, 0.2),
    );
    let robot = Robot::read("../models/franka_panda.urdf").unwrap();
    let coordinates = robot.model().degrees_of_freedom();
    let robot = robot.with_tool("welder", "hand", offset).unwrap();
    // A tool on a tool is relative to its axes.
    let next = Placement::new(
        rotation_exp(Vector3::new(-0.5, 0.7, 0.1)),
        Vector3::new(0.1, 0.0, -0.03),
    );
    let robot = robot.with_tool("wire", "welder", next).unwrap();
    assert_eq!(robot.model().degrees_of_freedom(), coordinates);
    let frames = ["hand", "welder", "wire"].map(|name| robot.model().frame(name).unwrap());
    let mut kinematics = ForwardKinematics::under(robot.model(), robot.map(), &frames).unwrap();
    let x: Vec<f64> = (0..kinematics.variables())
        .map(|i| 0.3 - 0.1 * i as f64)
        .collect();
    let placed = kinematics.place(&x).unwrap();
    let (hand, welder, wire) = (placed[0], placed[1], placed[2]);
    for (actual, expected) in [(welder, hand * offset), (wire, hand * offset * next)] {
        assert!((actual.translation - expected.translation).norm() < 1e-15);
        assert!((actual.rotation.x - expected.rotation.x).norm() < 1e-15);
        assert!((actual.rotation.y - expected.rotation.y).norm() < 1e-15);
    }
}

#[test]
fn invalid_tools_are_errors() {
    let robot = Robot::read("../models/universal_ur5e.urdf").unwrap();
    let put = |name, link, placement| robot.clone().with_tool(name, link, placement).unwrap_err();
    assert!(matches!(
        put("tool", "hand", Placement::identity()),
        ModelError::UnknownName(_)
    ));
    assert!(matches!(
        put("flange", "flange", Placement::identity()),
        ModelError::DuplicateName { .. }
    ));
    let invalid = Placement::translation(Vector3::new(f64::NAN, 0.0, 0.0));
    assert!(matches!(
        put("tool", "flange", invalid),
        ModelError::BadPlacement { .. }
    ));
}
