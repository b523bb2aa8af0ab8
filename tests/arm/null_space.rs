//! Promise: null-space motion approaches the initial or requested posture as closely as the target allows. This holds
//! with locked joints, near limits, and with weighted prismatic joints.

use kinopt::Solution;
use kinopt::arm::{Arm, PoseBounds};
use kinopt::model::{Limits, Model};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3};
use nalgebra::{SMatrix, Vector4};
use support::arms::robot;

const LINKS: [f64; 3] = [0.5, 0.4, 0.3];
/// Metres of the prismatic joint that weigh as much as a radian.
const METRES_PER_RADIAN: f64 = 0.2;

/// A prismatic joint along x, then three revolute joints in the plane, with position goals.
fn crane(limit_avoidance: f64) -> Arm {
    let mut builder = Model::builder("crane");
    let along = |length: f64| Placement::translation(Vector3::new(length, 0.0, 0.0));
    let (x, z) = (Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 0.0, 1.0));
    let mut last = builder.prismatic("slide", None, along(0.0), x, Limits::new(-1.0, 1.0));
    builder.frame("base", None, along(0.0));
    let mut from = along(0.0);
    for (k, &link) in LINKS.iter().enumerate() {
        let limits = Limits::new(-2.0, 2.0);
        last = builder.revolute(format!("turn {k}"), Some(last), from, z, limits);
        from = along(link);
    }
    builder.frame("tip", Some(last), from);
    let robot = Robot::new(builder.build().unwrap(), Vec::new()).unwrap();
    let arm = Arm::builder(&robot, "base", "tip").with_atlas(false);
    let arm = arm
        .with_goal(PoseBounds::position())
        .with_metres_per_radian(METRES_PER_RADIAN);
    arm.with_limit_avoidance(limit_avoidance).build().unwrap()
}

/// Follows a target to `to` and then in tiny steps, so that the null-space motion converges.
fn followed(arm: &Arm, start: &[f64; 4], to: Placement<f64>) -> Vec<f64> {
    let from = arm.base_from_tool(start).unwrap().translation;
    let mut follower = arm.follower(start).unwrap();
    let mut solution = Solution::default();
    for k in 0..300 {
        let share = (f64::from(k) / 100.0).min(1.0);
        let mut target = to;
        target.translation = from + (to.translation - from) * share;
        target.translation.x += 1e-6 * f64::from(k % 2);
        assert_eq!(follower.advance(target, &mut solution).unwrap(), None);
        assert!(solution.reached, "{}", solution.explain());
    }
    follower.q().to_vec()
}

/// The joint displacement from the start has no component in the null space, with weighted prismatic joints.
#[test]
fn null_space_uses_prismatic_weights() {
    let arm = crane(0.0);
    let start = [0.1, 0.3, 0.7, 0.6];
    let mut to = arm.base_from_tool(&start).unwrap();
    to.translation += Vector3::new(-0.15, 0.2, 0.0);
    let q = followed(&arm, &start, to);
    // Columns by hand, in radians: the prismatic joint's, then z × (tip − joint).
    let sums = [q[1], q[1] + q[2], q[1] + q[2] + q[3]];
    let mut jacobian = SMatrix::<f64, 2, 4>::zeros();
    jacobian[(0, 0)] = METRES_PER_RADIAN;
    for joint in 0..3 {
        for link in joint..3 {
            jacobian[(0, 1 + joint)] -= LINKS[link] * sums[link].sin();
            jacobian[(1, 1 + joint)] += LINKS[link] * sums[link].cos();
        }
    }
    let scale = Vector4::new(1.0 / METRES_PER_RADIAN, 1.0, 1.0, 1.0);
    let displacement =
        (Vector4::from_column_slice(&q) - Vector4::from(start)).component_mul(&scale);
    let inverse = (jacobian * jacobian.transpose()).try_inverse().unwrap();
    let left = displacement - jacobian.transpose() * inverse * jacobian * displacement;
    assert!(
        displacement.norm() > 0.3 && left.norm() < 1e-3,
        "{displacement} {left}"
    );
}

/// Also near limits, whose potential is taken relative to its gradient at the start.
#[test]
fn start_posture_is_kept_near_limits() {
    let arm = crane(2.0);
    // In the last tenths of the ranges.
    let start = [0.9, 1.85, -1.8, 1.1];
    let to = arm.base_from_tool(&start).unwrap();
    let q = followed(&arm, &start, to);
    let moves = q.iter().zip(start).map(|(a, b)| (a - b).abs());
    assert!(moves.fold(0.0, f64::max) < 1e-3, "{q:?}");
}

/// A joint with velocity limit 0 only blocks itself.
#[test]
fn null_space_motion_with_a_blocked_joint() {
    let start = [0.1, -0.3, 0.2, -2.0, 0.2, 1.7, 0.4];
    let mut posture = start;
    posture[2] += 0.8;
    posture[4] -= 0.6;
    let panda = robot("franka_panda");
    let arm = Arm::builder(&panda, "base", "flange").with_atlas(false);
    let arm = arm.with_goal(PoseBounds::position()).with_posture(&posture);
    let arm = arm.build().unwrap();
    let mut target = arm.base_from_tool(&start).unwrap();
    let mut servo = arm.servo(&start, 0.05).unwrap();
    servo = servo
        .with_velocity_limits(&[0.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0])
        .unwrap();
    let squared_distance =
        |q: &[f64]| -> f64 { q.iter().zip(&posture).map(|(a, b)| (a - b) * (a - b)).sum() };
    for k in 0..100 {
        target.translation.z += 1e-5 * f64::from(k % 2 * 2 - 1);
        servo.step(target).unwrap();
    }
    let q = servo.q();
    assert_eq!(q[0], start[0]);
    assert!(
        squared_distance(q) < 0.5 * squared_distance(&start),
        "{q:?}"
    );
}

/// A mirrored crane near a mirrored limit moves as the mirror image.
#[test]
fn mirrored_arm_moves_as_mirror_image() {
    for avoidance in [0.0, 1.0] {
        let arm = crane(avoidance);
        let mirrored = |q: [f64; 4]| [q[0], -q[1], -q[2], -q[3]];
        for start in [
            [0.1, 2.0, -1.2, 0.6],
            [0.1, -2.0, -0.4, 0.9],
            [-0.2, 0.4, 2.0, -0.7],
            [0.3, -0.4, -2.0, -0.7],
            [1.0, 0.3, 0.8, 2.0],
        ] {
            for offset in [[0.1, 0.15], [-0.12, 0.05], [0.05, -0.15]] {
                let both = [(start, offset), (mirrored(start), [offset[0], -offset[1]])];
                let [one, other] = both.map(|(start, offset)| {
                    let mut to = arm.base_from_tool(&start).unwrap();
                    to.translation += Vector3::new(offset[0], offset[1], 0.0);
                    followed(&arm, &start, to)
                });
                let image = mirrored([one[0], one[1], one[2], one[3]]);
                let differences = image.iter().zip(&other).map(|(a, b)| (a - b).abs());
                assert!(
                    differences.fold(0.0, f64::max) < 1e-6,
                    "{start:?} {offset:?}: {one:?} {other:?}"
                );
            }
        }
    }
}

/// Six revolute joints, with a prismatic joint after the first two; all lengths scale with `unit`.
fn on_a_rail(unit: f64) -> Arm {
    let mut builder = Model::builder("on a rail");
    let [x, y, z] = Vector3::UNITS;
    let translation_by = |v: Vector3<f64>, metres: f64| Placement::translation(v * (metres * unit));
    let hinge = Limits::new(-2.5, 2.5);
    let first = builder.revolute("0", None, translation_by(z, 0.3), z, hinge);
    let second = builder.revolute("1", Some(first), translation_by(x, 0.1), y, hinge);
    let rail = Limits::new(-0.5 * unit, 0.5 * unit);
    let mut last = builder.prismatic("rail", Some(second), translation_by(z, 0.2), z, rail);
    let hinges = [
        (x, y, 0.5),
        (z, x, 0.4),
        (x, z, 0.2),
        (y, y, 0.2),
        (z, x, 0.1),
    ];
    for (k, (direction, axis, length)) in hinges.into_iter().enumerate() {
        last = builder.revolute(
            format!("{}", k + 2),
            Some(last),
            translation_by(direction, length),
            axis,
            hinge,
        );
    }
    builder.frame("tip", Some(last), translation_by(x, 0.15));
    let robot = Robot::new(builder.build().unwrap(), Vec::new()).unwrap();
    let arm = Arm::builder(&robot, kinopt::arm::Base::World, "tip").with_atlas(false);
    let arm = arm.with_position_tolerance(1e-6 * unit);
    arm.with_metres_per_radian(0.5 * unit).build().unwrap()
}

/// Prismatic displacements are weighted in the unit of length, so null-space motion is equal in all units.
#[test]
fn null_space_motion_is_unit_invariant() {
    let ends = [1.0, 8.0, 0.125].map(|unit| {
        let arm = on_a_rail(unit);
        let mut start = vec![0.3, 0.6, 0.1, -0.9, 0.4, 0.7, -0.8, 0.2];
        start[2] *= unit;
        let from = arm.base_from_tool(&start).unwrap();
        let mut follower = arm.follower(&start).unwrap();
        let (mut solution, mut steps) = (Solution::default(), 0);
        for k in 0..200 {
            let mut target = from;
            let share = (f64::from(k) / 150.0).min(1.0);
            target.translation += Vector3::new(-0.2, 0.3, 0.1) * (share * unit);
            follower.advance(target, &mut solution).unwrap();
            assert!(solution.reached, "{unit}: {}", solution.explain());
            steps += solution.iterations;
        }
        let mut q = follower.q().to_vec();
        q[2] /= unit;
        (q, steps)
    });
    assert_eq!(ends[0], ends[1]);
    assert_eq!(ends[0], ends[2]);
}
