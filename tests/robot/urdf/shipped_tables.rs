//! Promise: the robots in `models/` have the makers' published parameters and limits. The test multiplies
//! Denavit-Hartenberg rows independently of any URDF.
// Limits are as published: -1.5707 is one of them.
#![allow(clippy::approx_constant)]

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use kinopt::kinematics::ForwardKinematics;
use kinopt::robot::Robot;
use nalgebra::{Isometry3, Translation3, Vector3};

type Pose = Isometry3<f64>;

fn shift(x: f64, y: f64, z: f64) -> Pose {
    Translation3::new(x, y, z).into()
}

fn turn_x(angle: f64) -> Pose {
    Pose::rotation(Vector3::x() * angle)
}

fn turn_z(angle: f64) -> Pose {
    Pose::rotation(Vector3::z() * angle)
}

/// Rz(θ) Tz(d) Tx(a) Rx(α).
fn standard([a, d, alpha]: [f64; 3], theta: f64) -> Pose {
    turn_z(theta) * shift(a, 0.0, d) * turn_x(alpha)
}

/// Rx(α) Tx(a) Rz(θ) Tz(d).
fn craig([a, d, alpha]: [f64; 3], theta: f64) -> Pose {
    turn_x(alpha) * shift(a, 0.0, 0.0) * turn_z(theta) * shift(0.0, 0.0, d)
}

/// Configurations spread over the limits of all joints, with mimic joints applied.
fn configurations(robot: &Robot) -> Vec<Vec<f64>> {
    let map = robot.map();
    (0..8)
        .map(|k| {
            let x: Vec<f64> = (map.lower().iter().zip(map.upper()).enumerate())
                .map(|(i, (low, high))| {
                    let part = (0.1 + 0.37 * k as f64 + 0.61 * i as f64).fract();
                    low + part * (high - low)
                })
                .collect();
            let mut q = vec![0.0; robot.model().degrees_of_freedom()];
            map.expand(&x, &mut q).unwrap();
            q
        })
        .collect()
}

fn assert_frame(robot: &Robot, frame: &str, q: &[f64], expected: &Pose) {
    let id = robot.model().frame(frame).unwrap();
    let mut kinematics = ForwardKinematics::of_frames(robot.model(), &[id]).unwrap();
    let actual: Pose = (&kinematics.place(q).unwrap()[0]).into();
    let deviation = (actual.to_homogeneous() - expected.to_homogeneous()).amax();
    assert!(
        deviation < 1e-12,
        "{}, {frame}: off by {deviation:e}",
        robot.name()
    );
}

fn assert_limits(robot: &Robot, expected: &[(f64, f64)]) {
    let limits: Vec<_> = robot.model().limits().collect();
    assert_eq!(limits.len(), expected.len());
    for (limits, (lower, upper)) in limits.iter().zip(expected) {
        assert!((limits.lower - lower).abs() < 1e-14 && (limits.upper - upper).abs() < 1e-14);
    }
}

fn assert_serial(file: &str, rows: &[[f64; 3]], limits_in_degrees: &[f64]) {
    let robot = Robot::read(file).unwrap();
    for q in configurations(&robot) {
        let expected = rows
            .iter()
            .zip(&q)
            .fold(Pose::identity(), |pose, (row, q)| pose * standard(*row, *q));
        assert_frame(&robot, "flange", &q, &expected);
    }
    let limits: Vec<_> = (limits_in_degrees.iter())
        .map(|degrees| (-degrees.to_radians(), degrees.to_radians()))
        .collect();
    assert_limits(&robot, &limits);
}

#[test]
fn ur5e_matches_its_published_table() {
    let rows = [
        [0.0, 0.1625, FRAC_PI_2],
        [-0.425, 0.0, 0.0],
        [-0.3922, 0.0, 0.0],
        [0.0, 0.1333, FRAC_PI_2],
        [0.0, 0.0997, -FRAC_PI_2],
        [0.0, 0.0996, 0.0],
    ];
    assert_serial("../models/universal_ur5e.urdf", &rows, &[360.0; 6]);
}

#[test]
fn ur10e_matches_its_published_table() {
    let rows = [
        [0.0, 0.1807, FRAC_PI_2],
        [-0.6127, 0.0, 0.0],
        [-0.57155, 0.0, 0.0],
        [0.0, 0.17415, FRAC_PI_2],
        [0.0, 0.11985, -FRAC_PI_2],
        [0.0, 0.11655, 0.0],
    ];
    assert_serial("../models/universal_ur10e.urdf", &rows, &[360.0; 6]);
}

#[test]
fn iiwa14_matches_its_published_table() {
    let rows = [
        [0.0, 0.36, -FRAC_PI_2],
        [0.0, 0.0, FRAC_PI_2],
        [0.0, 0.42, FRAC_PI_2],
        [0.0, 0.0, -FRAC_PI_2],
        [0.0, 0.4, -FRAC_PI_2],
        [0.0, 0.0, FRAC_PI_2],
        [0.0, 0.126, 0.0],
    ];
    let limits = [170.0, 120.0, 170.0, 120.0, 170.0, 120.0, 175.0];
    assert_serial("../models/kuka_iiwa14.urdf", &rows, &limits);
}

#[test]
fn panda_matches_its_published_table() {
    let rows = [
        [0.0, 0.333, 0.0],
        [0.0, 0.0, -FRAC_PI_2],
        [0.0, 0.316, FRAC_PI_2],
        [0.0825, 0.0, FRAC_PI_2],
        [-0.0825, 0.384, -FRAC_PI_2],
        [0.0, 0.0, FRAC_PI_2],
        [0.088, 0.0, FRAC_PI_2],
    ];
    let robot = Robot::read("../models/franka_panda.urdf").unwrap();
    for q in configurations(&robot) {
        let wrist = rows
            .iter()
            .zip(&q)
            .fold(Pose::identity(), |pose, (row, q)| pose * craig(*row, *q));
        let flange = wrist * shift(0.0, 0.0, 0.107);
        let hand = flange * turn_z(-FRAC_PI_4);
        assert_frame(&robot, "flange", &q, &flange);
        assert_frame(&robot, "tool", &q, &(hand * shift(0.0, 0.0, 0.1034)));
        assert_frame(
            &robot,
            "finger_left",
            &q,
            &(hand * shift(0.0, q[7], 0.0584)),
        );
        assert_frame(
            &robot,
            "finger_right",
            &q,
            &(hand * shift(0.0, -q[7], 0.0584)),
        );
    }
    assert_limits(
        &robot,
        &[
            (-2.8973, 2.8973),
            (-1.7628, 1.7628),
            (-2.8973, 2.8973),
            (-3.0718, -0.0698),
            (-2.8973, 2.8973),
            (-0.0175, 3.7525),
            (-2.8973, 2.8973),
            (0.0, 0.04),
            (0.0, 0.04),
        ],
    );
}

#[test]
fn baxter_matches_its_published_table() {
    // Craig's convention as Williams prints it; the file has the standard one.
    let rows = [
        [0.0, 0.0, 0.0],
        [0.069, 0.0, -FRAC_PI_2],
        [0.0, 0.36435, FRAC_PI_2],
        [0.069, 0.0, -FRAC_PI_2],
        [0.0, 0.37429, FRAC_PI_2],
        [0.01, 0.0, -FRAC_PI_2],
        [0.0, 0.0, FRAC_PI_2],
    ];
    let offsets = [0.0, FRAC_PI_2, 0.0, 0.0, 0.0, 0.0, 0.0];
    let robot = Robot::read("../models/rethink_baxter.urdf").unwrap();
    for q in configurations(&robot) {
        for (side, frame, q_arm) in [(1.0, "left_tool", &q[..7]), (-1.0, "right_tool", &q[7..])] {
            let mount = shift(0.064, side * 0.259, 0.1296) * turn_z(side * FRAC_PI_4);
            let wrist = (rows.iter().zip(q_arm).zip(offsets)).fold(
                mount * shift(0.0, 0.0, 0.27035),
                |pose, ((row, q), offset)| pose * craig(*row, q + offset),
            );
            assert_frame(&robot, frame, &q, &(wrist * shift(0.0, 0.0, 0.3683)));
        }
    }
    let arm = [
        (-1.7016, 1.7016),
        (-2.147, 1.047),
        (-3.0541, 3.0541),
        (-0.05, 2.618),
        (-3.059, 3.059),
        (-1.5707, 2.094),
        (-3.059, 3.059),
    ];
    assert_limits(&robot, &[arm, arm].concat());
}

#[test]
fn cobra_matches_its_published_table() {
    let robot = Robot::read("../models/adept_cobra_s600.urdf").unwrap();
    for q in configurations(&robot) {
        let expected = standard([0.325, 0.387, 0.0], q[0])
            * standard([0.275, 0.0, PI], q[1])
            * standard([0.0, q[2], 0.0], 0.0)
            * standard([0.0; 3], q[3]);
        assert_frame(&robot, "flange", &q, &expected);
    }
    let turn = |degrees: f64| (-degrees.to_radians(), degrees.to_radians());
    assert_limits(
        &robot,
        &[turn(105.0), turn(150.0), (0.0, 0.21), turn(360.0)],
    );
}

/// Documentation of V4, "Masses": the whole robot, and each solid in the axes of its joint.
#[test]
fn nao_masses_match_its_documentation() {
    let nao = || support::arms::robot("aldebaran_nao");
    let free = nao()
        .with_base_joint(kinopt::robot::BaseJoint::FREE)
        .unwrap();
    assert!((free.masses().unwrap().total() - 5.195350051).abs() < 1e-5);
    let robot = nao();
    let model = robot.model();
    let inertial = |link: &str| {
        let frame = model.frame(link).unwrap();
        robot
            .link(frame)
            .and_then(|link| link.inertial)
            .expect(link)
    };
    for (link, mass, at) in [
        ("torso", 1.0496, [-0.00413, 0.0, 0.04342]),
        ("left_shoulder", 0.07504, [-0.00165, -0.02663, 0.00014]),
    ] {
        let expected_inertia = inertial(link);
        assert!((expected_inertia.mass - mass).abs() < 1e-4);
        assert_eq!(
            expected_inertia.link_from_inertia.translation.to_array(),
            at
        );
    }
    // Inertia of the torso, published about its origin.
    let (torso, [x, y, z]) = (inertial("torso"), [-0.00413, 0.0, 0.04342]);
    let about_origin = [
        [y * y + z * z, -x * y, -x * z],
        [-x * y, x * x + z * z, -y * z],
        [-x * z, -y * z, x * x + y * y],
    ];
    let published = [
        [0.0050623407587, 1.4311580344e-05, 0.00015519082081],
        [1.4311580344e-05, 0.0048801358789, -2.7079340725e-05],
        [0.00015519082081, -2.7079340725e-05, 0.001610300038],
    ];
    for (i, j) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)] {
        let moved = torso.moments[i][j] + torso.mass * about_origin[i][j];
        assert!((moved - published[i][j]).abs() < 2e-7, "{i} {j}: {moved}");
    }
    // Left and right are symmetric; the published inertias are nearly so.
    let sides = model
        .frames()
        .iter()
        .filter_map(|frame| frame.name.strip_prefix("left_"));
    let sides = sides.filter(|part| !["hand", "sole"].contains(part));
    for part in sides {
        let [left, right] = ["left", "right"].map(|side| inertial(&format!("{side}_{part}")));
        let [l, r] = [left, right].map(|one| one.link_from_inertia.translation.to_array());
        assert_eq!((left.mass, l), (right.mass, [r[0], -r[1], r[2]]), "{part}");
    }
}
