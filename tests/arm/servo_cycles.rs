//! Promise: servos and path followers use the null space of their target, at limits, stretched and in any unit. Reports
//! of a cycle are exact.

use kinopt::Solution;
use kinopt::arm::{Arm, PoseBounds, ServoStatus};
use kinopt::model::{Limits, Model};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3};
use support::arms::robot;

const TIME_STEP: f64 = 1e-3;

/// Planar arm with position goals, on a prismatic joint perpendicular to the plane.
fn planar(links: &[f64], limits: f64, unit: f64) -> Arm {
    let mut builder = Model::builder("planar");
    let z = Vector3::new(0.0, 0.0, 1.0);
    let along = |length: f64| Placement::translation(Vector3::new(length * unit, 0.0, 0.0));
    let slide = Limits::new(-0.5 * unit, 0.5 * unit);
    let mut last = builder.prismatic("slide", None, along(0.0), z, slide);
    builder.frame("base", None, along(0.0));
    let mut from = along(0.0);
    for (k, &link) in links.iter().enumerate() {
        let name = format!("joint {k}");
        last = builder.revolute(name, Some(last), from, z, Limits::new(-limits, limits));
        from = along(link);
    }
    builder.frame("tip", Some(last), from);
    let robot = Robot::new(builder.build().unwrap(), Vec::new()).unwrap();
    let arm = Arm::builder(&robot, "base", "tip").with_atlas(false);
    let arm = arm
        .with_goal(PoseBounds::position())
        .with_position_tolerance(1e-6 * unit);
    arm.build().unwrap()
}

fn at(position: [f64; 3]) -> Placement<f64> {
    Placement::translation(position.into())
}

/// Joint values after a path whose null space may move joints inward: −1 is the lower limit, 1 the upper.
fn ends(rate: f64, posture: Option<&[f64]>, start: &[f64], servoing: bool) -> Vec<f64> {
    let panda = robot("franka_panda");
    let arm = Arm::builder(&panda, "base", "flange");
    let mut arm = arm.with_atlas(false).with_limit_avoidance(rate);
    if let Some(posture) = posture {
        arm = arm.with_posture(posture);
    }
    let arm = arm.build().unwrap();
    let from = arm.base_from_tool(start).unwrap();
    let mut servo = arm.servo(start, 50.0 * TIME_STEP).unwrap();
    let mut follower = arm.follower(start).unwrap();
    let mut solution = Solution::default();
    for k in 0..200 {
        // There and back, slowly.
        let offset = 0.15 * (1.0 - (f64::from(k) / 100.0 - 1.0).abs());
        let mut target = from;
        target.translation.z += offset;
        if servoing {
            assert!(servo.step(target).unwrap().position_error < 5e-3);
        } else {
            assert_eq!(follower.advance(target, &mut solution).unwrap(), None);
        }
    }
    let q = if servoing { servo.q() } else { follower.q() };
    q.to_vec()
}

#[test]
fn limit_avoidance_moves_joints_off_both_limits() {
    // Rotations of the forearm and the upper arm near their limits.
    for (joint, value) in [(2, -2.85), (2, 2.85)] {
        let mut start = [0.1, -0.3, 0.2, -2.0, 0.2, 1.7, 0.4];
        start[joint] = value;
        for servoing in [false, true] {
            let left = ends(0.0, None, &start, servoing)[joint].abs();
            let drawn = ends(4.0, None, &start, servoing)[joint].abs();
            assert!(drawn < left - 1e-3, "{value} {servoing}: {drawn} {left}");
        }
    }
}

#[test]
fn servo_approaches_its_posture() {
    let start = [0.1, -0.3, 0.2, -2.0, 0.2, 1.7, 0.4];
    let mut posture = start;
    posture[2] += 0.8;
    posture[0] -= 0.6;
    let squared_distance =
        |q: &[f64]| -> f64 { q.iter().zip(&posture).map(|(a, b)| (a - b) * (a - b)).sum() };
    let plain = ends(0.0, None, &start, true);
    let drawn = ends(4.0, Some(&posture), &start, true);
    assert!(
        squared_distance(&drawn) < squared_distance(&plain) - 1e-3,
        "{drawn:?} {plain:?}"
    );
}

#[test]
fn cycle_reports_velocity_and_rest() {
    let arm = planar(&[0.6, 0.4], 2.5, 1.0);
    let mut servo = arm.servo(&[0.0, 0.4, 0.9], TIME_STEP).unwrap();
    servo = servo.with_velocity_limits(&[0.3, 1.0, 1.0]).unwrap();
    let mut rested = 0;
    for tick in 0..3000 {
        let x = if tick < 1500 { 1.7 } else { -1.4 };
        let before = servo.q().to_vec();
        let step = servo.step(at([x, 0.9, 0.1])).unwrap();
        for ((before, after), velocity) in before.iter().zip(step.q).zip(step.velocity) {
            assert!((velocity * TIME_STEP - (after - before)).abs() <= 1e-12);
        }
        assert!(!step.reached());
        if step.status == ServoStatus::Nearest {
            assert!(step.velocity.iter().all(|velocity| *velocity == 0.0));
            rested += 1;
        }
    }
    assert!(rested > 50, "{rested}");
}

/// Joints of an arm stretched towards its target have a vanishing gradient. The elbow keeps the side of its tiny bend.
#[test]
fn stretched_arm_follows_a_returning_target() {
    let arm = planar(&[0.6, 0.4], 2.5, 1.0);
    for bend in [-1e-4, 1e-4] {
        let start = [0.0, 0.0, bend];
        let mut follower = arm.follower(&start).unwrap();
        let mut solution = Solution::default();
        for k in 0..1200 {
            let target = at([(1.2 - 0.001 * f64::from(k)).max(0.8), 0.0, 0.0]);
            assert_eq!(follower.advance(target, &mut solution).unwrap(), None);
        }
        assert!(solution.reached, "{}", solution.explain());
        assert!(
            follower.q()[2] * bend > 0.0,
            "{:?} from {bend}",
            follower.q()
        );
    }
}

/// A joint leaves its limit if that lowers the error.
#[test]
fn limits_are_left_inwards() {
    for end in [-1.0, 1.0] {
        let arm = planar(&[0.6, 0.4], 1.0, 1.0);
        let target = arm.base_from_tool(&[0.1, 0.2 * end, 0.5 * end]).unwrap();
        let start = [0.5 * end, end, end];
        let mut servo = arm.servo(&start, TIME_STEP).unwrap();
        servo = servo.with_velocity_limits(&[5.0; 3]).unwrap();
        let mut follower = arm.follower(&start).unwrap();
        let mut solution = Solution::default();
        for _ in 0..1500 {
            servo.step(target).unwrap();
            follower.advance(target, &mut solution).unwrap();
        }
        assert!(solution.reached && servo.step(target).unwrap().reached());
    }
}

/// In millimetres all angles are equal, and prismatic values are 1000 times as large.
#[test]
fn servo_is_unit_invariant() {
    let [metres, millimetres] = [1.0, 1000.0].map(|unit| planar(&[0.6, 0.4], 2.5, unit));
    let start = [0.05, 0.4, 0.9];
    let scaled = |q: &[f64]| [1e3 * q[0], q[1], q[2]];
    let mut servo = metres.servo(&start, TIME_STEP).unwrap();
    let mut other = millimetres.servo(&scaled(&start), TIME_STEP).unwrap();
    let none = [f64::INFINITY; 3];
    servo = servo.with_velocity_limits(&none).unwrap();
    other = other.with_velocity_limits(&none).unwrap();
    for k in 0..150 {
        let turn = 0.04 * f64::from(k);
        // Within reach, then beyond it.
        let position = [0.5 + 0.6 * turn.sin(), 0.4 * turn, 0.3 * turn - 0.4];
        servo.step(at(position)).unwrap();
        other.step(at(position.map(|x| 1e3 * x))).unwrap();
        for (a, b) in scaled(servo.q()).iter().zip(other.q()) {
            assert!((a - b).abs() < 1e-6 * a.abs().max(1.0), "{k}: {a} {b}");
        }
    }
}

/// Move limits apply to every step of a path follower.
#[test]
fn path_follower_keeps_move_limits() {
    let panda = robot("franka_panda");
    let arm = Arm::builder(&panda, "base", "flange");
    let max_move = [0.01, 0.02, 0.01, 0.03, 0.01, 0.02, 0.01];
    let arm = arm
        .with_atlas(false)
        .with_max_move(&max_move)
        .build()
        .unwrap();
    let start = [0.1, -0.3, 0.2, -2.0, 0.2, 1.7, 0.4];
    let mut target = arm.base_from_tool(&start).unwrap();
    let mut follower = arm.follower(&start).unwrap();
    let mut solution = Solution::default();
    for _ in 0..20 {
        target.translation.z += 0.01;
        let before = follower.q().to_vec();
        follower.advance(target, &mut solution).unwrap();
        for ((before, after), max_move) in before.iter().zip(follower.q()).zip(max_move) {
            assert!((after - before).abs() <= max_move, "{before} {after}");
        }
    }
}

/// A redundant arm near its limits, with a steep limit potential, comes to rest.
#[test]
fn redundant_arm_near_limits_comes_to_rest() {
    let panda = robot("franka_panda");
    let arm = Arm::builder(&panda, "base", "flange");
    let arm = arm.with_atlas(false).with_max_move(&[0.002; 7]);
    let arm = arm.build().unwrap();
    let start = [2.45, 0.21, 2.88, -1.69, 2.34, 1.98, -1.59];
    let mut target = arm.base_from_tool(&start).unwrap();
    target.translation.x -= 0.02;
    let mut follower = arm.follower(&start).unwrap();
    let mut servo = arm.servo(&start, TIME_STEP).unwrap();
    let mut solution = Solution::default();
    let mut last = [0.0_f64; 2];
    for tick in 0..900 {
        let before = follower.q().to_vec();
        follower.advance(target, &mut solution).unwrap();
        let step = servo.step(target).unwrap();
        if tick >= 880 {
            let moved = before.iter().zip(follower.q()).map(|(a, b)| (a - b).abs());
            last[0] = moved.fold(last[0], f64::max);
            let speeds = step.velocity.iter().map(|v| v.abs() * TIME_STEP);
            last[1] = speeds.fold(last[1], f64::max);
        }
    }
    assert!(
        solution.reached && last.iter().all(|step| *step < 1e-6),
        "{last:?}"
    );
}

/// The projected gradient at a miss excludes active limits.
#[test]
fn miss_at_limits_has_zero_projected_gradient() {
    let arm = planar(&[0.6, 0.4], 1.0, 1.0);
    let solution = arm.solve(at([-1.0, 0.4, 0.9]), &[0.1, 0.2, 0.3]).unwrap();
    assert!(!solution.reached && solution.active_limits().count() >= 2);
    assert!(solution.projected_gradient.unwrap() < 1e-6, "{solution:?}");
}

/// The winner is reported for reached problems only.
#[test]
fn batch_reports_winners_of_reached_targets() {
    let arm = planar(&[0.6, 0.4], 2.0, 1.0);
    let targets: Vec<_> = (0..12)
        .map(|k| at([0.9 - 0.1 * f64::from(k), 0.3, 0.2]))
        .chain([at([2.0, 0.0, 0.0]), at([0.0, 0.0, 3.0])])
        .collect();
    let starts = [0.1, 0.2, 0.3].repeat(targets.len());
    let mut q = vec![0.0; starts.len()];
    let mut outcomes = vec![kinopt::arm::PoseOutcome::default(); targets.len()];
    arm.solve_batch_into(&targets, &starts, &mut q, &mut outcomes)
        .unwrap();
    let reached = outcomes.iter().filter(|outcome| outcome.reached).count();
    assert!((5..=12).contains(&reached), "{reached}");
    for outcome in outcomes {
        assert_eq!(outcome.reached, outcome.winner.is_some(), "{outcome:?}");
    }
}

/// Beyond its limits, on either side, a servo stays exactly on them.
#[test]
fn servo_never_exceeds_its_limits() {
    let arm = planar(&[0.6, 0.4], 1.0, 1.0);
    let further = planar(&[0.6, 0.4], 2.5, 1.0);
    for side in [-1.0, 1.0] {
        let mut target = further
            .base_from_tool(&[0.0, 1.5 * side, 1.4 * side])
            .unwrap();
        target.translation.z = 0.9 * side;
        let mut servo = arm
            .servo(&[0.0, 0.1 * side, 0.2 * side], TIME_STEP)
            .unwrap();
        servo = servo.with_velocity_limits(&[2.0; 3]).unwrap();
        for _ in 0..1500 {
            let step = servo.step(target).unwrap();
            for (q, limits) in step.q.iter().zip(arm.limits()) {
                assert!(limits.contains(*q), "{:?}", step.q);
            }
        }
        assert_eq!(servo.q()[0], 0.5 * side);
        assert_eq!(servo.q()[1], side);
    }
}

/// The damping that decreased at a constant target is restored when the target moves: one cycle later the servo equals
/// a new one.
#[test]
fn damping_is_restored_after_a_rest() {
    let arm = planar(&[0.6, 0.4], 2.5, 1.0);
    let servo = |start: &[f64]| {
        let servo = arm
            .servo(start, TIME_STEP)
            .unwrap()
            .with_damping(0.2)
            .unwrap();
        servo.with_velocity_limits(&[100.0; 3]).unwrap()
    };
    let mut rested = servo(&[0.0, 0.4, 0.9]);
    for _ in 0..200 {
        rested.step(at([0.7, 0.6, 0.0])).unwrap();
    }
    rested.step(at([0.70002, 0.6, 0.0])).unwrap();
    let mut fresh = servo(rested.q());
    let target = at([0.70004, 0.6, 0.0]);
    let goal = fresh.step(target).unwrap().q.to_vec();
    let step = rested.step(target).unwrap();
    let apart = goal.iter().zip(step.q).map(|(a, b)| (a - b).abs());
    assert!(apart.fold(0.0, f64::max) < 1e-9, "{:?} {goal:?}", step.q);
}

/// A joint with velocity limit 0 does not keep the others from their initial posture.
#[test]
fn null_space_motion_with_a_zero_velocity_joint() {
    let arm = planar(&[0.6, 0.4, 0.3], 2.5, 1.0);
    let start = [0.1, 0.3, 0.9, -0.7];
    let mut servo = arm.servo(&start, TIME_STEP).unwrap();
    servo = servo.with_velocity_limits(&[0.0, 3.0, 3.0, 3.0]).unwrap();
    let from = arm.base_from_tool(&start).unwrap();
    let mut farthest = 0.0_f64;
    for tick in 0..4000 {
        // One revolution of a circle, then rest at its start.
        let angle = std::f64::consts::TAU * (f64::from(tick) / 2000.0).min(1.0);
        let mut target = from;
        target.translation.x -= 0.15 * (1.0 - angle.cos());
        target.translation.y += 0.15 * angle.sin();
        let q = servo.step(target).unwrap().q;
        assert_eq!(q[0], start[0]);
        farthest = farthest.max((q[1] - start[1]).abs());
    }
    let distance = servo.q().iter().zip(&start).map(|(a, b)| (a - b).abs());
    let distance = distance.fold(0.0, f64::max);
    assert!(farthest > 0.1 && distance < 1e-4, "{farthest} {distance}");
}
