//! Promise: soft limits are read and apply only on request: then no solution violates them.

use kinopt::arm::Arm;
use kinopt::model::{JointKind, Limits};
use kinopt::robot::Robot;
use support::fault_tables::ExpectedError;
use support::random::Random;

fn chain(safety: [&str; 3], elbow: &str) -> String {
    let joint = |i: usize, kind: &str, axis: &str, safety: &str| {
        let next = i + 1;
        format!(
            "<link name='l{next}'/><joint name='j{i}' type='{kind}'><parent link='l{i}'/>\
             <child link='l{next}'/><origin xyz='0.3 0 0.1'/><axis xyz='{axis}'/>\
             <limit lower='-2' upper='2' velocity='1' effort='40'/>{safety}</joint>"
        )
    };
    let joints = joint(0, "revolute", "0 0 1", safety[0])
        + &joint(1, "revolute", "0 1 0", &(safety[1].to_owned() + elbow))
        + &joint(2, "continuous", "1 0 0", safety[2]);
    format!("<robot name='soft'><link name='l0'/>{joints}</robot>")
}

const SOFT_LIMITS: [&str; 3] = [
    "<safety_controller k_position='100' k_velocity='10' soft_lower_limit='-1.5' soft_upper_limit='2.5'/>",
    "<safety_controller k_velocity='10' soft_upper_limit='0.5'/>",
    "<safety_controller k_velocity='10'/>",
];

#[test]
fn soft_limits_are_read_and_apply_on_request() {
    let robot = Robot::parse(&chain(SOFT_LIMITS, ""), "soft.urdf").unwrap();
    let ids: Vec<_> = robot.model().joint_ids().collect();
    let infinite = f64::INFINITY;
    assert_eq!(robot.soft_limits(ids[0]), Some(Limits::new(-1.5, 2.5)));
    assert_eq!(robot.soft_limits(ids[1]), Some(Limits::new(-infinite, 0.5)));
    assert_eq!(robot.soft_limits(ids[2]), None);
    assert_eq!(robot.effort_limit(ids[0]), Some(40.0));
    let hard = Limits::new(-2.0, 2.0);
    let before: Vec<_> = robot.model().limits().collect();
    assert_eq!(before, [hard, hard, Limits::UNBOUNDED]);

    let soft = robot.with_soft_limits().unwrap();
    let after: Vec<_> = soft.model().limits().collect();
    let both = [Limits::new(-1.5, 2.0), Limits::new(-2.0, 0.5)];
    assert_eq!(after, [both[0], both[1], Limits::UNBOUNDED]);
    assert_eq!(soft.velocity_limit(ids[0]), Some(1.0));
    // Solvers keep them.
    let arm = Arm::builder(&soft, "l0", "l3").with_atlas(false);
    let arm = arm.build().unwrap();
    let mut random = Random::split_mix(5);
    for _ in 0..50 {
        let target = arm.base_from_tool(&random.configuration(&arm)).unwrap();
        let solution = arm.solve(target, &[0.0; 3]).unwrap();
        for (value, limits) in solution.q.iter().zip(soft.model().limits()) {
            assert!(limits.contains(*value), "{value} {limits:?}");
        }
    }
}

#[test]
fn mimic_soft_limits_apply_on_request() {
    let endless = "<safety_controller soft_lower_limit='-1' soft_upper_limit='1'/>";
    let follower = "<mimic joint='j0' multiplier='-1'/>";
    let text = chain(["", SOFT_LIMITS[1], endless], follower);
    let robot = Robot::parse(&text, "soft.urdf").unwrap();
    assert_eq!(robot.map().upper(), [2.0, f64::INFINITY]);
    let soft = robot.with_soft_limits().unwrap();
    assert_eq!(soft.model().joints()[2].kind, JointKind::Revolute);
    assert_eq!(soft.map().lower()[1], -1.0);
    assert_eq!(soft.map().upper(), [2.0, 1.0]);
    let restricted = soft.clone().with_mimic_limits().unwrap();
    assert!(soft.map().lower()[0] < -0.5);
    assert_eq!(restricted.map().lower(), [-0.5, -1.0]);
    assert_eq!(restricted.map().upper(), [2.0, 1.0]);
}

#[test]
fn empty_soft_limits_name_the_joint() {
    let beyond = "<safety_controller soft_lower_limit='3' soft_upper_limit='4'/>";
    let text = chain([beyond, "", ""], "");
    let robot = Robot::parse(&text, "soft.urdf").unwrap();
    robot.with_soft_limits().says("`j0`");
}

#[test]
fn invalid_soft_limits_fail_unless_lenient() {
    let text = chain(["<safety_controller soft_lower_limit='low'/>", "", ""], "");
    Robot::parse(&text, "soft.urdf").says("joint `j0`, <safety_controller>");
    let robot = Robot::reader().lenient().parse(&text, "soft.urdf").unwrap();
    assert_eq!(robot.repairs().len(), 1);
    assert_eq!(robot.soft_limits(robot.model().joint("j0").unwrap()), None);
}
