//! Promise: known defects of other solvers are absent here.
#![allow(clippy::unwrap_used)]

use kinopt::arm::{Arm, PoseBounds, QueryError};
use kinopt::model::{Limits, Model};
use kinopt::robot::Robot;
use kinopt::solver::Termination;
use kinopt::spatial::{Placement, Vector3};
use nalgebra::Isometry3;
use support::arms::{apart, panda, robot, within_limits};
use support::random::Random;
use support::urdf_matrices::Tree;

const X: Vector3<f64> = Vector3::<f64>::UNITS[0];
const Z: Vector3<f64> = Vector3::<f64>::UNITS[2];

fn along(x: f64, y: f64, z: f64) -> Placement<f64> {
    Placement::translation(Vector3::new(x, y, z))
}

/// A prismatic joint of 10 m, then a planar arm whose first joint is continuous.
fn gantry(scale: f64) -> Model {
    let mut b = Model::builder("gantry");
    let slide = b.prismatic(
        "slide",
        None,
        along(0.0, 0.0, 0.0),
        X,
        Limits::new(0.0, 10.0 * scale),
    );
    let turn = b.continuous("turn", Some(slide), along(0.0, 0.0, 0.5 * scale), Z);
    let bend = b.revolute(
        "bend",
        Some(turn),
        along(0.5 * scale, 0.0, 0.0),
        Z,
        Limits::new(-2.5, 2.5),
    );
    b.frame("base", None, Placement::identity());
    b.frame("tip", Some(bend), along(0.4 * scale, 0.0, 0.0));
    b.build().unwrap()
}

#[test]
fn prismatic_values_are_not_wrapped() {
    let arm = Arm::new(&gantry(1.0), "base", "tip").unwrap();
    let goal = arm.base_from_tool(&[8.0, 0.4, 1.0]).unwrap();
    let solution = arm.solve(goal, &[7.0, 0.0, 0.5]).unwrap();
    assert!(solution.reached, "{}", solution.explain());
    assert!((solution.q[0] - 8.0).abs() < 2.0);
}

#[test]
fn continuous_joints_stay_near_the_start() {
    let arm = Arm::new(&gantry(1.0), "base", "tip").unwrap();
    let mut random = Random::split_mix(9);
    for k in 0..30 {
        let goal = arm.base_from_tool(&random.configuration(&arm)).unwrap();
        let mut start = random.configuration(&arm);
        start[1] += std::f64::consts::TAU * f64::from(k);
        let solution = arm.solve(goal, &start).unwrap();
        assert!(solution.reached && solution.q.iter().all(|v| v.is_finite()));
        assert!((solution.q[1] - start[1]).abs() <= std::f64::consts::PI + 1e-9);
    }
}

#[test]
fn success_is_judged_on_the_returned_q() {
    let (robot, base, tip) = panda();
    let arm = Arm::new(&robot, base, tip).unwrap();
    let mut random = Random::split_mix(10);
    for _ in 0..20 {
        // Outside the limits: not reachable by clamping.
        let beyond: Vec<f64> = random.configuration(&arm).iter().map(|v| v * 1.5).collect();
        let goal = arm.base_from_tool(&beyond).unwrap();
        let solution = arm.solve(goal, &[0.0; 7]).unwrap();
        let at = arm.base_from_tool(&solution.q).unwrap();
        let (metres, radians) = apart(&Isometry3::from(&at), &Isometry3::from(&goal));
        assert!(within_limits(&arm, &solution.q));
        assert_eq!(
            solution.reached,
            metres <= 1e-6 && radians <= 1e-6,
            "{metres} {radians}"
        );
        let task = solution.tasks().next().unwrap();
        assert!((task.position_error().unwrap() - metres).abs() < 1e-9);
        assert!((task.orientation_error().unwrap() - radians).abs() < 1e-7);
    }
}

#[test]
fn starts_are_projected_and_nan_is_rejected() {
    let (robot, base, tip) = panda();
    let arm = Arm::new(&robot, base, tip).unwrap();
    let goal = arm
        .base_from_tool(&[0.3, 0.2, 0.1, -1.5, 0.2, 1.7, 0.4])
        .unwrap();
    for start in [[9.0; 7], [-40.0; 7], [1e9; 7]] {
        let solution = arm.solve(goal, &start).unwrap();
        assert!(solution.reached && within_limits(&arm, &solution.q));
    }
    let mut start = [0.0; 7];
    start[2] = f64::NAN;
    let error = arm.solve(goal, &start).unwrap_err();
    assert!(
        matches!(&error, QueryError::StartNotFinite { joint, .. } if joint == "joint3"),
        "{error}"
    );
    let mut invalid = goal;
    invalid.translation.y = f64::NAN;
    assert!(matches!(
        arm.solve(invalid, &[0.0; 7]),
        Err(QueryError::Target { .. })
    ));
    assert!(matches!(
        arm.solve(goal, &[0.0; 6]),
        Err(QueryError::Length { .. })
    ));
}

/// Fixed joints combine in file order, also rotated ones in the middle of a chain.
#[test]
fn fixed_joints_fold_in_the_right_order() {
    let limits = r#"<limit lower="-2" upper="2" effort="1" velocity="1"/>"#;
    let mut text = String::from("<robot name=\"crooked\"><link name=\"l0\"/>");
    // revolute, fixed, fixed, revolute, …: each fixed one rotated about two axes and translated.
    let kinds = ["revolute", "fixed", "fixed"];
    for k in 0..18 {
        let (kind, next) = (kinds[k % 3], k + 1);
        let turned = 0.3 + 0.1 * k as f64;
        let rpy = if kind == "fixed" {
            format!("{turned} -0.4 {turned}")
        } else {
            "0 0 0".into()
        };
        text.push_str(&format!(
            "<link name=\"l{next}\"/><joint name=\"j{k}\" type=\"{kind}\"><parent link=\"l{k}\"/>\
             <child link=\"l{next}\"/><origin xyz=\"0.1 0.0{k} -0.03\" rpy=\"{rpy}\"/>\
             <axis xyz=\"0 0.6 0.8\"/>{limits}</joint>"
        ));
    }
    text.push_str("</robot>");
    let robot = Robot::parse(&text, "crooked.urdf").unwrap();
    let tree = Tree::parse(&text);
    for (base, tip) in [("l0", "l18"), ("l2", "l17"), ("l17", "l1")] {
        let arm = Arm::new(&robot, base, tip).unwrap();
        let mut random = Random::split_mix(14);
        for _ in 0..10 {
            let q = random.configuration(&arm);
            let values: Vec<_> = arm.joints().zip(q.iter().copied()).collect();
            let target = tree.base_from_tip(base, tip, &values);
            let actual = support::urdf_matrices::from_placement(&arm.base_from_tool(&q).unwrap());
            let (metres, radians) = support::urdf_matrices::apart(&actual, &target);
            assert!(metres < 1e-14 && radians < 1e-14, "{metres:e} {radians:e}");
        }
    }
}

#[test]
fn floating_and_planar_joints_stay_movable() {
    let text = std::fs::read_to_string("../models/franka_panda.urdf").unwrap();
    let read = |kind: &str| {
        let changed = text.replacen(
            r#"name="joint4" type="revolute""#,
            &format!(r#"name="joint4" type="{kind}""#),
            1,
        );
        assert_ne!(changed, text);
        Robot::parse(&changed, "loose.urdf").unwrap()
    };
    let planar = Arm::new(&read("planar"), "base", "tool").unwrap();
    assert_eq!(planar.joint_count(), 6 + 3);
    // Joints of an arm have one coordinate each: a ball joint is named in the error.
    let floating = read("floating");
    assert_eq!(floating.model().degrees_of_freedom(), 8 + 6);
    let error = Arm::new(&floating, "base", "tool").unwrap_err().to_string();
    assert!(error.contains("joint4/rotation"), "{error}");
}

#[test]
fn two_joints_converge() {
    let mut b = Model::builder("planar");
    let first = b.revolute("a", None, Placement::identity(), Z, Limits::new(-3.0, 3.0));
    let second = b.revolute(
        "b",
        Some(first),
        along(1.0, 0.0, 0.0),
        Z,
        Limits::new(-2.5, 2.5),
    );
    b.frame("base", None, Placement::identity());
    b.frame("tip", Some(second), along(1.0, 0.0, 0.0));
    let model = b.build().unwrap();
    let arm = Arm::builder(&model, "base", "tip")
        .with_goal(PoseBounds::position())
        .build()
        .unwrap();
    let mut random = Random::split_mix(11);
    for _ in 0..50 {
        let goal = arm.base_from_tool(&random.configuration(&arm)).unwrap();
        let solution = arm.solve(goal, &random.configuration(&arm)).unwrap();
        assert!(solution.reached, "{}", solution.explain());
    }
}

#[test]
fn metres_and_millimetres_are_equivalent() {
    let (metres, millimetres) = (gantry(1.0), gantry(1000.0));
    let a = Arm::new(&metres, "base", "tip").unwrap();
    let b = Arm::builder(&millimetres, "base", "tip")
        .with_position_tolerance(1e-3)
        .build()
        .unwrap();
    let mut random = Random::split_mix(12);
    for _ in 0..30 {
        let truth = random.configuration(&a);
        let start = random.configuration(&a);
        let scaled = |q: &[f64]| vec![q[0] * 1000.0, q[1], q[2]];
        let x = a.solve(a.base_from_tool(&truth).unwrap(), &start).unwrap();
        let y = b
            .solve(b.base_from_tool(&scaled(&truth)).unwrap(), &scaled(&start))
            .unwrap();
        assert!(x.reached && y.reached, "{} {}", x.explain(), y.explain());
    }
}

#[test]
fn repeated_solves_are_equal() {
    let (robot, base, tip) = panda();
    let arm = Arm::new(&robot, base, tip).unwrap();
    let mut random = Random::split_mix(13);
    for _ in 0..20 {
        let goal = arm.base_from_tool(&random.configuration(&arm)).unwrap();
        let start = random.configuration(&arm);
        assert_eq!(
            arm.solve(goal, &start).unwrap().q,
            arm.solve(goal, &start).unwrap().q
        );
    }
}

#[test]
fn unreachable_target_reports_errors_and_reason() {
    let robot = robot("kuka_iiwa14");
    let arm = Arm::new(&robot, "base", "flange").unwrap();
    let solution = arm.solve(along(4.0, 0.0, 0.5), &[0.1; 7]).unwrap();
    assert!(!solution.reached && within_limits(&arm, &solution.q));
    assert!(solution.tasks().next().unwrap().position_error().unwrap() > 2.5);
    assert!(!solution.explain().is_empty());
}

#[test]
fn time_limit_ends_the_search() {
    let (robot, base, tip) = panda();
    let arm = Arm::builder(&robot, base, tip).with_time_limit(std::time::Duration::ZERO);
    let arm = arm.build().unwrap();
    let solution = arm.solve(along(7.0, 0.0, 0.0), &[0.0; 7]).unwrap();
    assert_eq!(solution.termination, Termination::TimeLimit);
}
