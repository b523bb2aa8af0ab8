//! Promise: straight, arc and spline segments continue a path through their keys, with points at most a step apart.

use kinopt::Arm;
use kinopt::motion::path::{CartesianPath, Curve, PathError, PathSolver, TimingLimits};
use kinopt::robot::Robot;
use kinopt::spatial::{Matrix3, Placement, Vector3};

const STEP: f64 = 0.01;

fn at(x: f64, y: f64, z: f64) -> Placement<f64> {
    Placement::translation(Vector3::new(x, y, z))
}

fn start() -> CartesianPath {
    CartesianPath::new([at(0.4, 0.0, 0.5)]).unwrap()
}

fn positions(path: &CartesianPath) -> Vec<Vector3<f64>> {
    path.points()
        .iter()
        .map(|point| point.translation)
        .collect()
}

fn largest_step(path: &CartesianPath) -> f64 {
    let positions = positions(path);
    let steps = positions.windows(2).map(|pair| (pair[1] - pair[0]).norm());
    steps.fold(0.0, f64::max)
}

#[test]
fn straight_segments_pass_their_keys() {
    let turned = Placement::new(
        Matrix3::from_roll_pitch_yaw([0.0, 0.0, 1.0]),
        Vector3::new(0.4, 0.2, 0.3),
    );
    let keys = [at(0.4, 0.0, 0.3), turned];
    let path = start().through(&keys, STEP).unwrap();
    // 0.2 m in steps of 10 mm, each way.
    assert_eq!(path.points().len(), 41);
    assert_eq!([path.points()[20], path.points()[40]], keys);
    assert!(largest_step(&path) < STEP + 1e-12);
    let middle = path.points()[30];
    let half = Matrix3::from_roll_pitch_yaw([0.0, 0.0, 0.5]);
    assert!((middle.rotation.x - half.x).norm() < 1e-12);
    assert!((middle.translation - Vector3::new(0.4, 0.1, 0.3)).norm() < 1e-12);
    // A rotation on the spot has points at most 0.05 rad apart.
    let spot = Placement::new(turned.rotation, Vector3::new(0.4, 0.0, 0.5));
    let path = start().through(&[spot], STEP).unwrap();
    assert_eq!(path.points().len(), 21);
}

#[test]
fn arc_stays_on_its_circle() {
    // A quarter beyond the half circle of radius 0.1 about (0.5, 0, 0.5), in the horizontal plane.
    let end = at(0.5, -0.1, 0.5);
    let path = start().arc_through([0.5, 0.1, 0.5], end, STEP).unwrap();
    let length = 0.1 * 1.5 * std::f64::consts::PI;
    assert_eq!(path.points().len(), 1 + (length / STEP).ceil() as usize);
    assert_eq!(path.points().last(), Some(&end));
    for position in positions(&path) {
        assert!(((position - Vector3::new(0.5, 0.0, 0.5)).norm() - 0.1).abs() < 1e-12);
        assert!((position.z - 0.5).abs() < 1e-12);
    }
    assert!(
        positions(&path).iter().any(|p| p.x > 0.59),
        "the arc passes the far side"
    );
    assert!(largest_step(&path) <= STEP);
}

#[test]
fn spline_passes_keys_without_corners() {
    let keys = [at(0.5, 0.1, 0.5), at(0.4, 0.2, 0.5), at(0.3, 0.1, 0.4)];
    let path = start().spline_through(&keys, STEP).unwrap();
    for key in keys {
        assert!(path.points().contains(&key));
    }
    assert!(largest_step(&path) <= STEP + 1e-12);
    let positions = positions(&path);
    for triple in positions.windows(3) {
        let [before, after] = [triple[1] - triple[0], triple[2] - triple[1]];
        let cosine = before.dot(after) / (before.norm() * after.norm());
        assert!(cosine > 0.9, "{cosine}");
    }
}

#[test]
fn keys_of_a_table_are_joined_by_a_curve() {
    let keys = [at(0.4, 0.0, 0.5), at(0.5, 0.1, 0.5), at(0.6, 0.0, 0.5)];
    let table = CartesianPath::new(keys).unwrap();
    let straight = table.along(Curve::Straight, STEP).unwrap();
    assert_eq!(straight, start().through(&keys[1..], STEP).unwrap());
    let arc = table.along(Curve::Arc, STEP).unwrap();
    let expected = start().arc_through(keys[1].translation, keys[2], STEP);
    assert_eq!(arc, expected.unwrap());
    let spline = table.along(Curve::Spline, STEP).unwrap();
    assert_eq!(spline, start().spline_through(&keys[1..], STEP).unwrap());
    let two = CartesianPath::new([keys[0], keys[1]]).unwrap();
    assert_eq!(two.along(Curve::Arc, STEP), Err(PathError::ArcKeys(2)));
}

#[test]
fn invalid_segments_are_errors() {
    let key = at(0.4, 0.1, 0.5);
    for step in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-9] {
        let error = start().through(&[key], step).unwrap_err();
        assert!(error.to_string().contains("step"), "{error}");
    }
    assert_eq!(start().through(&[], STEP), Err(PathError::Empty));
    let line = start().arc_through([0.4, 0.05, 0.5], key, STEP);
    assert_eq!(line, Err(PathError::StraightArc));
    let same = start().arc_through([0.4, 0.0, 0.5], key, STEP);
    assert_eq!(same, Err(PathError::StraightArc));
    let nan = start().through(&[at(f64::NAN, 0.0, 0.0)], STEP);
    assert!(matches!(nan, Err(PathError::Point { .. })));
    let timed = start().with_times([0.0]).unwrap().through(&[key], STEP);
    assert_eq!(timed, Err(PathError::Extended));
}

fn panda() -> Arm {
    let robot = Robot::read("../models/franka_panda.urdf").unwrap();
    Arm::new(&robot, "base", "tool").unwrap()
}

#[test]
fn pick_and_place_is_timed() {
    let arm = panda();
    let home = arm.base_from_tool(arm.default_start()).unwrap();
    let moved = |x: f64, y: f64, z: f64| {
        Placement::new(home.rotation, home.translation + Vector3::new(x, y, z))
    };
    let path = CartesianPath::new([home]).unwrap();
    let path = path.through(
        &[
            moved(0.0, 0.1, 0.0),
            moved(0.0, 0.1, -0.1),
            moved(0.0, 0.1, 0.0),
        ],
        STEP,
    );
    let over = moved(-0.05, 0.0, 0.05).translation;
    let path = path
        .unwrap()
        .arc_through(over, moved(0.0, -0.1, 0.0), STEP)
        .unwrap();
    let path = path.through(&[moved(0.0, -0.1, -0.1)], STEP).unwrap();
    let solution = PathSolver::new(&arm)
        .with_start(arm.default_start())
        .solve(&path)
        .unwrap();
    assert!(solution.reached() && solution.unreached.is_empty());
    // Arcs are part of the deviation.
    assert!(solution.report.largest_deviation.metres < 1e-3);
    let limits = TimingLimits::of(&arm).with_acceleration_limits(&[5.0; 7]);
    assert!(solution.trajectory(&limits).unwrap().duration() > 0.0);
}

#[test]
fn unreached_rows_are_timed_only_if_allowed() {
    let arm = panda();
    let home = arm.base_from_tool(arm.default_start()).unwrap();
    let mut far = home;
    far.translation.x += 3.0;
    let path = CartesianPath::new([home, far, home]).unwrap();
    let solution = PathSolver::new(&arm).solve(&path).unwrap();
    assert_eq!(solution.unreached, [1]);
    let limits = TimingLimits::of(&arm).with_acceleration_limits(&[5.0; 7]);
    let expected = PathError::Unreached {
        count: 1,
        rows: 3,
        first: 1,
    };
    assert_eq!(solution.trajectory(&limits), Err(expected));
    let limits = limits.with_unreached_allowed(true);
    assert!(solution.trajectory(&limits).is_ok());
    let track = arm.track(&[home, far], arm.default_start()).unwrap();
    assert_eq!(track.unreached, [1]);
}

#[test]
fn positions_need_a_goal_without_orientation() {
    let arm = panda();
    let home = arm.base_from_tool(arm.default_start()).unwrap();
    let path = CartesianPath::of_positions([home.translation]).unwrap();
    let path = path.through(&[at(0.5, 0.1, 0.5)], STEP).unwrap();
    let error = PathSolver::new(&arm).solve(&path).unwrap_err();
    assert_eq!(error, PathError::NoOrientations);
    let arm = arm.with_goal(kinopt::arm::PoseBounds::position()).unwrap();
    assert!(PathSolver::new(&arm).solve(&path).unwrap().reached());
}
