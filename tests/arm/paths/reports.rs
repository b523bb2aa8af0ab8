//! Promise: a path's report is correct: the reason why a point is unreached, and the joint that moves furthest in a
//! jump. A path is not entered where more points are unreached.

use std::f64::consts::TAU;

use kinopt::Arm;
use kinopt::collision::{Checker, CollisionModel, World};
use kinopt::motion::path::{CartesianPath, MissReason, PathSolver, Traversal};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use support::arms::robot;

/// Two prismatic joints along one line and two revolute joints about one axis.
const REDUNDANT_ROBOT: &str = r#"<robot name="twice">
<link name="base"/><link name="a"/><link name="b"/><link name="c"/><link name="tool"/>
<joint name="slide 1" type="prismatic"><parent link="base"/><child link="a"/><axis xyz="1 0 0"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="slide 2" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="1 0 0"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="turn 1" type="revolute"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/>
<limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
<joint name="turn 2" type="revolute"><parent link="c"/><child link="tool"/><axis xyz="0 0 1"/>
<limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
</robot>"#;

/// The tool does not move, while its joints change to another configuration in one step.
#[test]
fn furthest_joint_of_a_jump_is_weighted_by_unit() {
    let robot = Robot::parse(REDUNDANT_ROBOT, "twice.urdf").unwrap();
    // Prismatic joints by 0.4 m and revolute ones by 0.5 rad, each.
    let (from, to) = ([0.1, 0.5, 0.0, 0.5], [0.5, 0.1, 0.5, 0.0]);
    for (metres_per_radian, is_slide, distance) in
        [(1.0, false, 0.5), (0.25, true, 1.6), (0.1, true, 4.0)]
    {
        let arm = Arm::builder(&robot, "base", "tool")
            .with_metres_per_radian(metres_per_radian)
            .build()
            .unwrap();
        let stand = arm.base_from_tool(&from).unwrap();
        let path = CartesianPath::new(vec![stand; 2]).unwrap();
        let solver = PathSolver::new(&arm).with_start(&from).with_end(&to);
        let solution = solver.solve(&path).unwrap();
        let [reported] = &solution.jumps[..] else {
            panic!("{:?}", solution.jumps)
        };
        assert_eq!(reported.joint < 2, is_slide, "{reported:?}");
        assert!(
            (reported.distance - distance).abs() < 1e-12,
            "{}",
            reported.distance
        );
    }
}

/// An arm of one joint that always touches a ball. Points it could reach are unreached because of the contact; all
/// others are reported as not found.
#[test]
fn unreachable_points_in_contact_are_not_found() {
    let robot = robot("franka_panda");
    let mut whole = robot.model().neutral();
    whole[..7].copy_from_slice(&[0.3, -0.4, 0.5, -2.0, 0.2, 1.6, 0.8]);
    let arm = Arm::builder(&robot, "base", "flange")
        .with_only(["joint1"], &whole)
        .build()
        .unwrap();
    let mut world = World::new();
    world
        .add_sphere("ball", 0.1, Vector3::new(0.0, 0.0, 0.45))
        .unwrap();
    let bodies = CollisionModel::of(&robot).unwrap();
    let checker = Checker::new(bodies).with_world(&world).unwrap();
    let arm = arm.with_checker(&checker, &whole).unwrap();
    let points = (0..10).map(|k| {
        let mut point = arm.base_from_tool(&[0.05 * f64::from(k)]).unwrap();
        // A centimetre lower, which this joint cannot reach.
        point.translation.z += if k < 5 { 0.0 } else { -0.01 };
        point
    });
    let path = CartesianPath::new(points.collect::<Vec<_>>()).unwrap();
    let solution = PathSolver::new(&arm).solve(&path).unwrap();
    assert_eq!(solution.report.missed.len(), 10);
    for missed in &solution.report.missed {
        match missed.index < 5 {
            true => assert!(
                matches!(&missed.reason, MissReason::Touches(pair) if pair.second == "ball"),
                "{missed:?}"
            ),
            false => assert!(matches!(missed.reason, MissReason::NotFound), "{missed:?}"),
        }
    }
}

/// Two full rotations about the tool. An unreachable point interrupts the branch, where the path could be entered.
#[test]
fn path_is_not_entered_where_more_is_unreached() {
    let arm = Arm::new(&robot("universal_ur5e"), "base", "flange").unwrap();
    let begin = arm
        .base_from_tool(&[0.3, -1.2, 1.4, -1.6, -1.5, 0.0])
        .unwrap();
    let unreachable = [10, 20, 30];
    let points = (0..40).map(|k: usize| {
        let angle = 2.0 * TAU * k as f64 / 40.0;
        let turned = begin.rotation * rotation_exp(Vector3::new(0.0, 0.0, angle));
        let out = if unreachable.contains(&k) { 3.0 } else { 0.0 };
        Placement::new(turned, begin.translation + Vector3::new(out, 0.0, 0.0))
    });
    let path = CartesianPath::new(points.collect::<Vec<_>>()).unwrap();
    let path = path.with_traversal(Traversal::AnyStart);
    let solver = PathSolver::new(&arm).with_max_step(0.5);
    let reported = solver.solve(&path).unwrap();
    assert!(
        !unreachable.contains(&reported.report.entry),
        "entered at {}",
        reported.report.entry
    );
    // Each one once: entered at one of them, the path would end there as well.
    let missed = reported
        .report
        .missed
        .iter()
        .map(|missed| (reported.report.entry + missed.index) % 40);
    let mut missed: Vec<usize> = missed.collect();
    missed.sort_unstable();
    assert_eq!(missed, unreachable);
}

/// The tool does not move while its joints have to pass a ball. Distributing this over neighbouring steps would lead
/// through the ball, so the jump is reported, and no point is in contact.
#[test]
fn jump_over_an_obstacle_is_not_distributed() {
    let body = r#"<link name="a"><collision><origin xyz="0 0.2 0"/><geometry><sphere radius="0.05"/></geometry></collision></link>"#;
    let robot = Robot::parse(
        &REDUNDANT_ROBOT.replace(r#"<link name="a"/>"#, body),
        "twice.urdf",
    )
    .unwrap();
    let (from, to) = ([0.1, 0.5, 0.0, 0.5], [0.5, 0.1, 0.0, 0.5]);
    let alone = Arm::new(&robot, "base", "tool").unwrap();
    let stand = alone.base_from_tool(&from).unwrap();
    let path = CartesianPath::new(vec![stand; 33]).unwrap();
    let shared = PathSolver::new(&alone).with_start(&from).with_end(&to);
    assert!(shared.solve(&path).unwrap().reached());
    let mut world = World::new();
    world
        .add_sphere("ball", 0.05, Vector3::new(0.3, 0.2, 0.0))
        .unwrap();
    let checker = Checker::new(CollisionModel::of(&robot).unwrap());
    let checker = checker.with_world(&world).unwrap();
    let arm = alone.with_checker(&checker, &[0.0; 4]).unwrap();
    let solver = PathSolver::new(&arm).with_start(&from).with_end(&to);
    let solution = solver.solve(&path).unwrap();
    assert_eq!(solution.jumps.len(), 1);
    assert!(
        solution.report.missed.is_empty(),
        "{:?}",
        solution.report.missed
    );
    for q in solution.rows() {
        assert!(arm.collisions(q).unwrap().is_empty(), "{q:?}");
    }
}
