//! Promise: an arm that stretched towards an unreachable target returns with its elbow on the same branch.

use kinopt::Solution;
use kinopt::arm::Arm;
use kinopt::spatial::{Placement, Vector3};
use support::arms::{distance, robot};

/// Distance between consecutive targets, metres.
const STEP: f64 = 3e-4;
const STEPS: usize = 200;

#[test]
fn elbow_returns_on_its_branch() {
    let robot = robot("universal_ur5e");
    let arm = Arm::builder(&robot, "base", "flange");
    let arm = arm.with_atlas(false).build().unwrap();
    for elbow in [0.5, -0.5] {
        for lift in [-1.9, -1.2, -0.6] {
            for wrist in [[-1.7, -1.1, 0.2], [0.4, 1.3, -0.8], [1.9, 0.9, 1.5]] {
                for direction in [[0.0; 3], [0.1, 0.07, -0.05]] {
                    let start = [0.3, lift, elbow, wrist[0], wrist[1], wrist[2]];
                    check(&arm, &start, direction.into(), start[0]);
                }
            }
        }
    }
}

/// The branch is the most recent one, whatever the earlier motion.
#[test]
fn elbow_returns_on_its_branch_after_long_motion() {
    let robot = robot("universal_ur5e");
    let arm = Arm::builder(&robot, "base", "flange");
    let arm = arm.with_atlas(false).build().unwrap();
    for elbow in [0.5, -0.5] {
        for from in [-2.5, 2.5] {
            let start = [0.3, -1.2, elbow, -1.7, -1.1, 0.2];
            check(&arm, &start, Vector3::zero(), from);
        }
    }
}

/// Moves out of reach from the shoulder, or slightly off that line, and back. Before that, the first joint moves from
/// `from`.
fn check(arm: &Arm, start: &[f64; 6], offset: Vector3<f64>, from: f64) {
    let first = arm.base_from_tool(start).unwrap();
    let direction = first.translation + offset;
    let direction = direction * (1.0 / direction.norm());
    let at = |step: usize| {
        Placement::new(
            first.rotation,
            first.translation + direction * (STEP * step as f64),
        )
    };
    let mut q = *start;
    q[0] = from;
    let mut follower = arm.follower(&q).unwrap();
    let mut solution = Solution::default();
    let round = if from == start[0] { 0 } else { 80 };
    for step in 0..round {
        q[0] = from + (start[0] - from) * (f64::from(step) / f64::from(round));
        let target = arm.base_from_tool(&q).unwrap();
        follower.advance(target, &mut solution).unwrap();
        assert!(solution.reached);
    }
    let mut out = Vec::new();
    for step in 0..STEPS {
        follower.advance(at(step), &mut solution).unwrap();
        out.push((solution.q.clone(), solution.reached));
    }
    let missed = !solution.reached;
    for step in (0..STEPS).rev() {
        follower.advance(at(step), &mut solution).unwrap();
        let (target_q, reached) = &out[step];
        let distance_to_target = distance(&solution.q, target_q);
        let both = *reached && solution.reached;
        assert!(
            !both || distance_to_target < 1e-2,
            "{start:?}, step {step}: {distance_to_target}"
        );
    }
    let distance_to_start = distance(&solution.q, start);
    assert!(
        missed && solution.reached && distance_to_start < 1e-3,
        "{start:?}: {distance_to_start} {missed}"
    );
}
