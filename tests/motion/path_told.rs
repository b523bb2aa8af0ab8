//! Promise: what is told of a path is so: why a point is missed, which joint leaps furthest, and a path is not begun where it misses.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::f64::consts::TAU;

use kinopt::Arm;
use kinopt::collision::{Checker, CollisionModel, World};
use kinopt::motion::path::{CartesianPath, MissReason, PathSolver, Traversal};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use support::arms::robot;

/// Two slides along one line and two hinges about one axis.
const TWICE: &str = r#"<robot name="twice">
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

/// The tool stays, and what it hangs on goes from one way to be there to another in a step.
#[test]
fn the_joint_that_leaps_furthest_is_told_by_what_its_metres_weigh() {
    let robot = Robot::parse(TWICE, "twice.urdf").unwrap();
    // The slides by 0.4 m, the hinges by 0.5 rad, each.
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
        let [told] = &solution.reconfigurations[..] else {
            panic!("{:?}", solution.reconfigurations)
        };
        assert_eq!(told.joint < 2, is_slide, "{told:?}");
        assert!(
            (told.distance - distance).abs() < 1e-12,
            "{}",
            told.distance
        );
    }
}

/// An arm of one joint that touches a ball wherever it turns: where its tool would come is missed for the ball's sake, and elsewhere
/// it was not found, ball or not.
#[test]
fn what_touches_where_the_tool_does_not_come_is_not_found() {
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
        // A centimetre lower, where this joint alone never brings it.
        point.translation.z += if k < 5 { 0.0 } else { -0.01 };
        point
    });
    let path = CartesianPath::new(points.collect::<Vec<_>>()).unwrap();
    let solution = PathSolver::new(&arm).solve(&path).unwrap();
    assert_eq!(solution.missed.len(), 10);
    for missed in &solution.missed {
        match missed.index < 5 {
            true => assert!(
                matches!(&missed.reason, MissReason::Touches(pair) if pair.second == "ball"),
                "{missed:?}"
            ),
            false => assert!(matches!(missed.reason, MissReason::NotFound), "{missed:?}"),
        }
    }
}

/// Round about the tool twice; where it is out of reach for a point, a branch is left, and there a path might be entered.
#[test]
fn a_path_is_not_entered_where_more_of_it_is_missed() {
    let arm = Arm::new(&robot("universal_ur5e"), "base", "flange").unwrap();
    let begin = arm
        .base_from_tool(&[0.3, -1.2, 1.4, -1.6, -1.5, 0.0])
        .unwrap();
    let far = [10, 20, 30];
    let points = (0..40).map(|k: usize| {
        let angle = 2.0 * TAU * k as f64 / 40.0;
        let turned = begin.rotation * rotation_exp(Vector3::new(0.0, 0.0, angle));
        let out = if far.contains(&k) { 3.0 } else { 0.0 };
        Placement::new(turned, begin.translation + Vector3::new(out, 0.0, 0.0))
    });
    let path = CartesianPath::new(points.collect::<Vec<_>>()).unwrap();
    let path = path.with_traversal(Traversal::AnyStart);
    let solver = PathSolver::new(&arm).with_max_step(0.5);
    let told = solver.solve(&path).unwrap();
    assert!(!far.contains(&told.entry), "entered at {}", told.entry);
    // Each once: entered where one is, the path would end there as well.
    let missed = told
        .missed
        .iter()
        .map(|missed| (told.entry + missed.index) % 40);
    let mut missed: Vec<usize> = missed.collect();
    missed.sort_unstable();
    assert_eq!(missed, far);
}

/// The tool stays while what it hangs on is to come past a ball to the other side of it, which the steps around could share: they would
/// come through the ball, so the leap is told, and no point is where it touches.
#[test]
fn a_leap_over_an_obstacle_is_not_shared_by_steps_through_it() {
    let body = r#"<link name="a"><collision><origin xyz="0 0.2 0"/><geometry><sphere radius="0.05"/></geometry></collision></link>"#;
    let robot = Robot::parse(&TWICE.replace(r#"<link name="a"/>"#, body), "twice.urdf").unwrap();
    let (from, to) = ([0.1, 0.5, 0.0, 0.5], [0.5, 0.1, 0.0, 0.5]);
    let alone = Arm::new(&robot, "base", "tool").unwrap();
    let stand = alone.base_from_tool(&from).unwrap();
    let path = CartesianPath::new(vec![stand; 33]).unwrap();
    let shared = PathSolver::new(&alone).with_start(&from).with_end(&to);
    assert!(shared.solve(&path).unwrap().is_whole());
    let mut world = World::new();
    world
        .add_sphere("ball", 0.05, Vector3::new(0.3, 0.2, 0.0))
        .unwrap();
    let checker = Checker::new(CollisionModel::of(&robot).unwrap());
    let checker = checker.with_world(&world).unwrap();
    let arm = alone.with_checker(&checker, &[0.0; 4]).unwrap();
    let solver = PathSolver::new(&arm).with_start(&from).with_end(&to);
    let solution = solver.solve(&path).unwrap();
    assert_eq!(solution.reconfigurations.len(), 1);
    assert!(solution.missed.is_empty(), "{:?}", solution.missed);
    for q in solution.rows() {
        assert!(arm.collisions(q).unwrap().is_empty(), "{q:?}");
    }
}
