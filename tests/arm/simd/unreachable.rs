//! Promise: a target out of reach returns the best point found and its errors; invalid input is an error. Among all
//! attempts this is the search for the first.
#![allow(clippy::unwrap_used)]

use std::time::Instant;

use kinopt::simd_ik::{AxisGoal, LaneError, LaneOptions, PoseSolver, Prefer};
use kinopt::spatial::{Matrix3, Placement, Vector3};
use support::simd_chains::{far_away, panda, planar, target};

/// The planar arm is nearest to (3, 4) when it is stretched towards it.
#[test]
fn planar_arm_stretches_to_the_nearest_point() {
    let chain = planar();
    let options = LaneOptions::default().with_axes(AxisGoal::position_only());
    let solver = PoseSolver::new(&chain, options).unwrap();
    let goal = Placement::new(Matrix3::identity(), Vector3::new(3.0, 4.0, 0.0));
    let mut q = [0.0; 2];
    let outcome = solver
        .solve(&goal, &[0.3, 0.4], Prefer::First, None, &mut q)
        .unwrap();
    assert!(!outcome.reached && outcome.winner.is_none());
    assert!((outcome.position_error - 3.0).abs() < 1e-3, "{outcome:?}");
    assert!(
        (q[0] - 4.0f64.atan2(3.0)).abs() < 0.05 && q[1].abs() < 0.1,
        "{q:?}"
    );
}

/// An arm of seven joints stretches towards a distant point.
#[test]
fn seven_joint_arm_approaches_a_distant_point() {
    let chain = panda();
    let options = LaneOptions::default().with_atlas(false).with_attempts(40);
    let solver = PoseSolver::new(&chain, options).unwrap();
    let mut q = [0.0; 7];
    let start = [0.0, 0.0, 0.0, -1.5, 0.0, 1.5, 0.0];
    let goal = far_away();
    let before = (target(&chain, &start).translation - goal.translation).norm();
    let outcome = solver
        .solve(&goal, &start, Prefer::First, None, &mut q)
        .unwrap();
    assert!(!outcome.reached && outcome.attempts == 40);
    assert!(
        outcome.position_error < before - 0.3,
        "{outcome:?} {before}"
    );
}

#[test]
fn passed_deadline_ends_the_search() {
    let chain = panda();
    let options = LaneOptions::default()
        .with_atlas(false)
        .with_attempts(u32::MAX);
    let solver = PoseSolver::new(&chain, options).unwrap();
    let mut q = [0.0; 7];
    let now = Some(Instant::now());
    let outcome = solver
        .solve(&far_away(), &[0.0; 7], Prefer::First, now, &mut q)
        .unwrap();
    assert!(!outcome.reached && outcome.attempts <= 4);
    assert!(outcome.position_error.is_finite());
}

#[test]
fn invalid_input_is_named() {
    let chain = panda();
    let options = LaneOptions::default().with_atlas(false);
    let solver = PoseSolver::new(&chain, options.clone()).unwrap();
    let (goal, mut q) = (far_away(), [0.0; 7]);
    let solve = |goal: &Placement<f64>, start: &[f64], q: &mut [f64]| {
        solver.solve(goal, start, Prefer::First, None, q)
    };
    let short = LaneError::Length {
        what: "start",
        found: 6,
        expected: 7,
    };
    assert_eq!(solve(&goal, &[0.0; 6], &mut q), Err(short));
    assert!(matches!(
        solve(&goal, &[0.0; 7], &mut q[..3]),
        Err(LaneError::Length { what: "q", .. })
    ));
    assert_eq!(
        solve(&goal, &[f64::NAN; 7], &mut q),
        Err(LaneError::Start(0))
    );
    let bent = Placement::new(Matrix3::identity(), Vector3::new(f64::NAN, 0.0, 0.0));
    assert_eq!(solve(&bent, &[0.0; 7], &mut q), Err(LaneError::Target(0)));
    let zero = options.with_position_tolerance(0.0);
    let problem = PoseSolver::new(&chain, zero).err().unwrap().to_string();
    assert!(problem.contains("position_tolerance is 0"), "{problem}");
}
