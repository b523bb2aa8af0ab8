//! Promise: all entry points of a pose solver solve the same problem, reject the same input and respect the options.
#![allow(clippy::unwrap_used)]

use kinopt::simd_ik::{
    AxisGoal, Chain, ChainError, LaneError, LaneOptions, PoseOutcome, PoseSolver, Prefer,
};
use kinopt::spatial::{Matrix3, Placement, Vector3};
use support::random::Random;
use support::simd_chains::{far_away, panda, random_chain, target, tip, ur5};

const NO_ATLAS: fn() -> LaneOptions = || LaneOptions::default().with_atlas(false);

fn solver(chain: &Chain, options: LaneOptions) -> PoseSolver {
    PoseSolver::new(chain, options).unwrap()
}

/// Following a path equals solving for one target after another from the previous result.
#[test]
fn path_equals_consecutive_solves() {
    for chain in [panda(), ur5(), random_chain(5, 6, 1, true)] {
        let pose_solver = solver(&chain, NO_ATLAS());
        let n = pose_solver.joints();
        let mut random = Random::split_mix(17);
        let mut at = random.chain_configuration(&chain);
        let start = at.clone();
        let goals: Vec<Placement<f64>> = (0..12)
            .map(|_| {
                for (value, joint) in at.iter_mut().zip(chain.joints()) {
                    let to = *value + random.within(-0.25, 0.25);
                    *value = to.max(joint.lower).min(joint.upper);
                }
                target(&chain, &at)
            })
            .collect();
        let mut q = vec![0.0; n * goals.len()];
        let mut outcomes = vec![PoseOutcome::default(); goals.len()];
        pose_solver
            .track(&goals, &start, &mut q, &mut outcomes)
            .unwrap();
        let (mut from, mut own_way) = (start, 0);
        for ((goal, q), outcome) in goals.iter().zip(q.chunks(n)).zip(&outcomes) {
            let mut alone = vec![0.0; n];
            let reported = pose_solver.solve(goal, &from, Prefer::Start, None, &mut alone);
            if reported.unwrap().winner == Some(0) {
                own_way += 1;
                assert_eq!(outcome.winner, Some(0));
                assert!(q.iter().zip(&alone).all(|(a, b)| (a - b).abs() < 1e-9));
            }
            from.copy_from_slice(q);
        }
        assert!(own_way >= 10, "{own_way}");
    }
}

/// No attempt begins once all attempts together have used this many iterations, for a single query and in a batch.
#[test]
fn total_iterations_are_bounded() {
    let chain = panda();
    let (start, n) = (vec![0.1, 0.1, 0.1, -1.0, 0.1, 1.0, 0.1], 7);
    let mut last = 0;
    for limit in [1, 60, 400] {
        let options = NO_ATLAS().with_total_iterations(limit).with_iterations(40);
        let pose_solver = solver(&chain, options);
        let mut alone = vec![0.0; n];
        let reported = pose_solver.solve(&far_away(), &start, Prefer::Start, None, &mut alone);
        let mut outcomes = vec![PoseOutcome::default(); 3];
        let (goals, starts) = ([far_away(); 3], start.repeat(3));
        pose_solver
            .solve_batch(
                &goals,
                &starts,
                Prefer::Start,
                &mut vec![0.0; 3 * n],
                &mut outcomes,
            )
            .unwrap();
        outcomes.push(reported.unwrap());
        for outcome in &outcomes {
            // Eight attempts may already be running at that point.
            assert!(outcome.iterations < limit + 8 * 40, "{limit}: {outcome:?}");
            assert!(!outcome.reached && outcome.attempts <= limit + 8);
        }
        let spent = outcomes[3].iterations;
        assert!(spent > last, "{limit}: {spent}");
        last = spent;
    }
}

#[test]
fn option_out_of_range_is_named() {
    type Set = fn(LaneOptions, f64) -> LaneOptions;
    let options: [(&str, Set); 4] = [
        ("position_tolerance", LaneOptions::with_position_tolerance),
        (
            "orientation_tolerance",
            LaneOptions::with_orientation_tolerance,
        ),
        ("metres_per_radian", LaneOptions::with_metres_per_radian),
        ("damping", LaneOptions::with_damping),
    ];
    for (name, set) in options {
        for invalid in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let refused = PoseSolver::new(&ur5(), set(NO_ATLAS(), invalid));
            let message = refused.unwrap_err().to_string();
            assert!(message.contains(name), "{name} = {invalid}: {message}");
        }
    }
}

/// An invalid query is reported with its index.
#[test]
fn invalid_query_is_reported_by_index() {
    let chain = ur5();
    let pose_solver = solver(&chain, NO_ATLAS());
    let n = pose_solver.joints();
    let start = vec![0.3; n];
    let good = target(&chain, &start);
    let r = good.rotation;
    let mirrored = Matrix3::from_columns(-r.x, r.y, r.z);
    let stretched = Matrix3::from_columns(r.x, r.y, r.z * 1.01);
    let sheared = Matrix3::from_columns(r.x, (r.y + r.x) * 0.5_f64.sqrt(), r.z);
    let invalid = [
        Placement::new(mirrored, good.translation),
        Placement::new(stretched, good.translation),
        Placement::new(sheared, good.translation),
        Placement::new(r, Vector3::new(0.0, f64::NAN, 0.0)),
    ];
    for invalid in invalid {
        for at in 0..3 {
            let mut goals = [good; 3];
            goals[at] = invalid;
            let (mut q, mut outcomes) = (vec![0.0; 3 * n], vec![PoseOutcome::default(); 3]);
            let refused = pose_solver.solve_batch(
                &goals,
                &start.repeat(3),
                Prefer::First,
                &mut q,
                &mut outcomes,
            );
            assert_eq!(refused, Err(LaneError::Target(at)));
            let refused = pose_solver.track(&goals, &start, &mut q, &mut outcomes);
            assert_eq!(refused, Err(LaneError::Target(at)));
        }
        let mut q = vec![0.0; n];
        let refused = pose_solver.solve(&invalid, &start, Prefer::Start, None, &mut q);
        assert_eq!(refused, Err(LaneError::Target(0)));
        let mut outcomes = [PoseOutcome::default()];
        let refused =
            pose_solver.run_attempts(&invalid, &start, Prefer::Start, 0, &mut q, &mut outcomes);
        assert_eq!(refused, Err(LaneError::Target(0)));
        // Such a placement is also rejected within a chain.
        let refused = Chain::new(chain.joints().to_vec(), invalid);
        assert_eq!(refused, Err(ChainError::Placement(n)));
        let mut joints = chain.joints().to_vec();
        joints[2].parent_from_joint = invalid;
        let refused = Chain::new(joints, *chain.joint_from_tip());
        assert_eq!(refused, Err(ChainError::Placement(2)));
    }
    for at in 0..3 {
        let mut starts = start.repeat(3);
        starts[at * n + 4] = f64::INFINITY;
        let (mut q, mut outcomes) = (vec![0.0; 3 * n], vec![PoseOutcome::default(); 3]);
        let refused =
            pose_solver.solve_batch(&[good; 3], &starts, Prefer::Start, &mut q, &mut outcomes);
        assert_eq!(refused, Err(LaneError::Start(at)));
    }
}

/// A component with weight zero is free, and does not count in the reported error.
#[test]
fn weightless_components_do_not_count_as_errors() {
    let mut random = Random::split_mix(23);
    let mut missed = 0;
    for case in 0..24 {
        let chain = random_chain(case, 4, case as usize % 2, false);
        let weigh = |k: usize| f64::from(u8::from(case >> k & 1 == 0));
        let axes = AxisGoal {
            position_weights: [weigh(0), 1.0, weigh(1)],
            orientation_weights: [1.0, weigh(2), weigh(3)],
            ..AxisGoal::full_pose()
        };
        let pose_solver = solver(&chain, NO_ATLAS().with_axes(axes).with_attempts(4));
        let mut goal = target(&chain, &random.chain_configuration(&chain));
        goal.translation += Vector3::new(0.05, -0.2, 0.3) * f64::from(case as u32 % 3);
        let (start, mut q) = (
            random.chain_configuration(&chain),
            vec![0.0; pose_solver.joints()],
        );
        let reported = pose_solver.solve(&goal, &start, Prefer::Start, None, &mut q);
        let reported = reported.unwrap();
        let goal = nalgebra::Isometry3::from(&goal);
        let offset = goal.inverse() * tip(&chain, &q);
        let counted = |part: [f64; 3], weights: [f64; 3]| {
            let squares = part.iter().zip(weights).map(|(v, w)| v * v * w);
            squares.sum::<f64>().sqrt()
        };
        let position = counted(offset.translation.vector.into(), axes.position_weights);
        let half = offset.rotation.quaternion().imag();
        let chord = counted([half.x, half.y, half.z], axes.orientation_weights);
        let angle = 2.0 * chord.min(1.0).asin();
        assert!(
            (reported.position_error - position).abs() < 1e-12,
            "{case}: {reported:?} {position}"
        );
        assert!(
            (reported.orientation_error - angle).abs() < 1e-7,
            "{case}: {reported:?} {angle}"
        );
        missed += u32::from(!reported.reached);
    }
    assert!((4..24).contains(&missed), "{missed}");
}

/// A half width that no attempt reaches adds no row to the equations: every step equals that of a free component.
#[test]
fn very_wide_tolerance_equals_a_free_component() {
    let mut random = Random::split_mix(29);
    for case in 0..40_u64 {
        let chain = random_chain(case, 6, case as usize % 3, false);
        let k = case as usize % 3;
        let (mut roomy, mut free) = (AxisGoal::full_pose(), AxisGoal::full_pose());
        // Wider than the whole chain, and than any chord.
        if case % 2 == 0 {
            (roomy.position_half_widths[k], free.position_weights[k]) = (100.0, 0.0);
        } else {
            (
                roomy.orientation_half_widths[k],
                free.orientation_weights[k],
            ) = (2.5, 0.0);
        }
        let goal = target(&chain, &random.chain_configuration(&chain));
        let start = random.chain_configuration(&chain);
        let results = [roomy, free].map(|axes| {
            let pose_solver = solver(&chain, NO_ATLAS().with_axes(axes));
            let mut q = vec![0.0; pose_solver.joints()];
            let reported = pose_solver.solve(&goal, &start, Prefer::Start, None, &mut q);
            let reported = reported.unwrap();
            (q, reported.iterations, reported.winner)
        });
        assert_eq!(results[0], results[1], "{case}");
    }
}

/// An error beyond the range of floating point is infinite, and the solve still succeeds.
#[test]
fn overflowing_error_is_infinite() {
    let chain = random_chain(3, 6, 0, false);
    let pose_solver = solver(&chain, NO_ATLAS().with_attempts(2));
    let turned = target(&chain, &[0.4; 6]).rotation;
    for position in [
        [1.7e308, 1.7e308, -1.7e308],
        [1e300, 0.0, 0.0],
        [-1.7e308, 1.7e308, 1.7e308],
    ] {
        let goal = Placement::new(turned, position.into());
        let mut q = vec![0.0; 6];
        let reported = pose_solver.solve(&goal, &[0.2; 6], Prefer::Start, None, &mut q);
        let reported = reported.unwrap();
        assert!(!reported.reached);
        assert_eq!(reported.position_error, f64::INFINITY, "{position:?}");
    }
}

#[test]
fn default_options_are_as_documented() {
    let reported = LaneOptions::default()
        .with_position_tolerance(1e-6)
        .with_orientation_tolerance(1e-6)
        .with_metres_per_radian(0.3)
        .with_axes(AxisGoal::full_pose())
        .with_damping(0.07)
        .with_stall_limit(6)
        .with_iterations(100)
        .with_attempts(200)
        .with_total_iterations(3000)
        .with_seed(0)
        .with_atlas(true)
        .with_portable(false);
    assert_eq!(LaneOptions::default(), reported);
}
