//! Promise: the velocity limit of a joint is kept; a joint without one is unlimited.

use kinopt::model::JointKind;
use kinopt::robot::Robot;

/// Joints on one base, each from its type and content.
fn star(joints: &[(&str, &str)]) -> Robot {
    let joints: String = (joints.iter().enumerate())
        .map(|(i, (kind, body))| {
            format!(
                "<link name='l{i}'/><joint name='j{i}' type='{kind}'><parent link='base'/>\
                 <child link='l{i}'/>{body}</joint>"
            )
        })
        .collect();
    let text = format!("<robot name='star'><link name='base'/>{joints}</robot>");
    Robot::parse(&text, "star.urdf").unwrap()
}

fn speeds(robot: &Robot) -> Vec<Option<f64>> {
    let ids = robot.model().joint_ids();
    ids.map(|joint| robot.velocity_limit(joint)).collect()
}

#[test]
fn velocity_limits_are_kept_for_all_joints() {
    let robot = star(&[
        ("revolute", "<limit lower='-1' upper='1' velocity='2.5'/>"),
        ("continuous", "<limit velocity='7'/>"),
        ("prismatic", "<limit lower='0' upper='1' velocity='0.125'/>"),
        (
            "revolute",
            "<limit lower='-1' upper='1' velocity='3'/><mimic joint='j0'/>",
        ),
    ]);
    let expected = [2.5, 7.0, 0.125, 3.0].map(Some);
    assert_eq!(speeds(&robot), expected);
}

#[test]
fn zero_and_negative_limits_mean_none() {
    let robot = star(&[
        (
            "revolute",
            "<limit lower='-1' upper='1' velocity='0' effort='0'/>",
        ),
        (
            "prismatic",
            "<limit lower='-1' upper='1' velocity='-1' effort='-1'/>",
        ),
        ("continuous", ""),
        (
            "fixed",
            "<limit lower='0' upper='0' velocity='1' effort='1'/>",
        ),
    ]);
    assert_eq!(speeds(&robot), [None; 4]);
    let mut ids = robot.model().joint_ids();
    assert!(ids.all(|joint| robot.effort_limit(joint).is_none()));
    let other = Robot::read("../models/franka_panda.urdf").unwrap();
    let beyond = other.model().joint_ids().last().unwrap();
    assert_eq!(robot.velocity_limit(beyond), None);
}

#[test]
fn velocity_limits_do_not_depend_on_order() {
    // The hand's joint precedes the arm's joint that carries it.
    let text = "<robot name='r'><link name='a'/><link name='b'/><link name='c'/>
        <joint name='hand' type='continuous'><parent link='b'/><child link='c'/>
        <limit velocity='2'/></joint>
        <joint name='arm' type='continuous'><parent link='a'/><child link='b'/>
        <limit velocity='1'/></joint></robot>";
    let robot = Robot::parse(text, "r.urdf").unwrap();
    let speed = |name| robot.velocity_limit(robot.model().joint(name).unwrap());
    assert_eq!((speed("arm"), speed("hand")), (Some(1.0), Some(2.0)));
}

#[test]
fn shipped_arms_have_velocity_limits() {
    for file in [
        "franka_panda",
        "kuka_iiwa14",
        "universal_ur5e",
        "rethink_baxter",
    ] {
        let robot = Robot::read(format!("../models/{file}.urdf")).unwrap();
        let tool = robot.clone().with_tool(
            "probe",
            robot.model().frames()[0].name.as_str(),
            kinopt::spatial::Placement::identity(),
        );
        for robot in [robot, tool.unwrap()] {
            for (id, joint) in robot.model().joint_ids().zip(robot.model().joints()) {
                let speed = robot.velocity_limit(id);
                assert_eq!(
                    speed.is_some(),
                    joint.kind != JointKind::Fixed,
                    "{}",
                    joint.name
                );
            }
        }
    }
    let panda = Robot::read("../models/franka_panda.urdf").unwrap();
    let first = panda.model().joint("joint1").unwrap();
    assert_eq!(panda.velocity_limit(first), Some(2.175));
}

#[test]
fn control_step_keeps_velocity_limits() {
    let text = r#"<robot name="arm"><link name="a"/><link name="b"/><link name="c"/>
      <joint name="base" type="floating"><parent link="a"/><child link="b"/>
        <limit velocity="2" effort="1"/></joint>
      <joint name="hinge" type="revolute"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/>
        <limit lower="-2" upper="2" velocity="3" effort="1"/></joint></robot>"#;
    let robot = Robot::parse(text, "arm.urdf").unwrap();
    let max_moves = robot.moves_within(0.01);
    assert_eq!(max_moves.len(), 8);
    assert_eq!(max_moves[7], 0.03);
    let model = robot.model();
    let mut tasks = kinopt::Problem::builder(model);
    let tip = model.frame("c").unwrap();
    let turned = kinopt::spatial::Matrix3::from(nalgebra::Matrix3::new(
        0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
    ));
    tasks.add(kinopt::task::Orientation::new(tip, turned));
    let problem = tasks.build().unwrap();
    let start = model.neutral();
    let moves = kinopt::ik::MoveLimits::new(&problem, &max_moves, &start).unwrap();
    let question = kinopt::problem::ProblemInstance::from(&problem)
        .with_moves(&moves)
        .unwrap();
    let step = kinopt::Solver::default()
        .solve_once(question, &start)
        .unwrap();
    assert!((step.q[7] - 0.03).abs() < 1e-15 && step.q[7] <= 0.03);
    let negative = robot.moves_within(-0.01);
    assert!(kinopt::ik::MoveLimits::new(&problem, &negative, &start).is_err());
}
