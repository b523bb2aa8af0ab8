//! Promise: the errors reported with a q are those of that q, according to nalgebra's kinematics.

use kinopt::simd_ik::LaneError;
use kinopt::simd_ik::{Chain, ChainJoint, JointKind, LaneOptions, PoseSolver, Prefer};
use kinopt::spatial::{Matrix3, Placement, Vector3};
use support::random::Random;
use support::simd_chains::{errors, far_away, panda, planar, random_chain, target, ur5};

fn check(chain: &Chain, seed: u64) {
    let options = LaneOptions::default().with_atlas(false).with_attempts(5);
    let solver = PoseSolver::new(chain, options).unwrap();
    let mut random = Random::split_mix(seed);
    let mut q = vec![0.0; solver.joints()];
    for k in 0..12 {
        let goal = if k % 4 == 3 {
            far_away()
        } else {
            target(chain, &random.chain_configuration(chain))
        };
        let start = random.chain_configuration(chain);
        let outcome = solver
            .solve(&goal, &start, Prefer::Start, None, &mut q)
            .unwrap();
        let (position, orientation) = errors(chain, &q, &goal);
        assert!(
            (outcome.position_error - position).abs() < 1e-12,
            "{outcome:?} {position}"
        );
        assert!(
            (outcome.orientation_error - orientation).abs() < 1e-11,
            "{outcome:?} {orientation}"
        );
        assert_eq!(outcome.reached, position <= 1e-6 && orientation <= 1e-6);
    }
}

#[test]
fn reported_errors_belong_to_the_returned_values() {
    check(&panda(), 1);
    check(&ur5(), 2);
    check(&planar(), 3);
    for seed in 0..8 {
        check(
            &random_chain(seed, 2 + seed as usize, seed as usize % 3, seed % 2 == 1),
            seed,
        );
    }
}

fn one_joint(kind: JointKind, lower: f64, upper: f64) -> PoseSolver {
    let along = |x: f64| Placement::translation(Vector3::new(x, 0.0, 0.0));
    let axis = match kind {
        JointKind::Prismatic => Vector3::new(1.0, 0.0, 0.0),
        _ => Vector3::new(0.0, 0.0, 1.0),
    };
    let joint = ChainJoint {
        parent_from_joint: along(0.0),
        axis,
        kind,
        lower,
        upper,
    };
    let chain = Chain::new(vec![joint], along(0.3)).unwrap();
    PoseSolver::new(&chain, LaneOptions::default()).unwrap()
}

/// A fixed joint belongs in the placement of the next joint. A joint without limits is a revolute one.
#[test]
fn fixed_chain_joints_are_rejected() {
    let joint = |kind| ChainJoint {
        parent_from_joint: Placement::identity(),
        axis: Vector3::new(0.0, 0.0, 1.0),
        kind,
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
    };
    let chain = |kind| Chain::new(vec![joint(kind)], Placement::identity());
    assert_eq!(
        chain(JointKind::Fixed).unwrap_err().to_string(),
        "joint 0 of the chain is fixed"
    );
    let turning = chain(JointKind::Continuous).unwrap();
    assert_eq!(turning, chain(JointKind::Revolute).unwrap());
}

#[test]
fn invalid_chain_joints_are_named() {
    let joint = |kind, axis: [f64; 3], (lower, upper)| ChainJoint {
        parent_from_joint: Placement::identity(),
        axis: axis.into(),
        kind,
        lower,
        upper,
    };
    let last = |tested: ChainJoint| {
        let first = joint(JointKind::Revolute, [1.0, 0.0, 0.0], (-1.0, 1.0));
        Chain::new(vec![first, tested], Placement::identity())
    };
    let (inf, up) = (f64::INFINITY, [0.0, 0.0, 1.0]);
    for axis in [
        [0.0; 3],
        [1e-13, 0.0, 0.0],
        [inf, 0.0, 0.0],
        [0.0, f64::NAN, 1.0],
    ] {
        let refused = last(joint(JointKind::Prismatic, axis, (-1.0, 1.0)));
        assert_eq!(refused, Err(LaneError::Axis(1)), "{axis:?}");
    }
    for (turns, slides, bounds) in [
        (true, true, (-1.0, 1.0)),
        (true, true, (-inf, 2.0)),
        (true, true, (0.5, 0.5)),
        (false, true, (-2e6, 1.0)),
        (false, true, (0.0, 2e6)),
        (false, false, (1.0, -1.0)),
        (false, false, (f64::NAN, 1.0)),
        (false, false, (0.0, f64::NAN)),
        (false, false, (inf, inf)),
        (false, false, (-inf, -inf)),
    ] {
        for (kind, fits) in [(JointKind::Revolute, turns), (JointKind::Prismatic, slides)] {
            let reported = last(joint(kind, up, bounds));
            assert_eq!(reported.is_ok(), fits, "{kind:?} {bounds:?}");
            assert!(fits || matches!(reported, Err(LaneError::Bounds { joint: 1, .. })));
        }
    }
}

/// A rotation by π is reported as such, although its sine equals that of no rotation.
#[test]
fn half_a_turn_is_reported_as_pi() {
    let solver = one_joint(JointKind::Revolute, -1e-5, 1e-5);
    let turned = Placement::new(
        Matrix3::identity().rotated_about_z((0.0, -1.0)),
        Vector3::new(0.3, 0.0, 0.0),
    );
    let outcome = solver
        .solve(&turned, &[0.0], Prefer::Start, None, &mut [0.0])
        .unwrap();
    assert!(!outcome.reached);
    assert!((outcome.orientation_error - std::f64::consts::PI).abs() < 1e-4);
}

/// At this distance floating point does not resolve a micrometre.
#[test]
fn unresolvable_prismatic_joint_is_not_reached() {
    let solver = one_joint(JointKind::Prismatic, 0.0, 1e12);
    let target = |x: f64| Placement::translation(Vector3::new(x + 0.3, 0.0, 0.0));
    for (x, reached) in [(1.0, true), (9e11, false)] {
        let outcome = solver
            .solve(&target(x), &[0.5 * x], Prefer::Start, None, &mut [0.0])
            .unwrap();
        assert_eq!(outcome.reached, reached, "{x}: {outcome:?}");
    }
}

/// After a thousand turns a direction is not resolved to 1e-12 rad, however wide the position tolerance is.
#[test]
fn unresolvable_angle_after_turns_is_not_reached() {
    let joint = ChainJoint {
        parent_from_joint: Placement::identity(),
        axis: Vector3::UNITS[2],
        kind: JointKind::Revolute,
        lower: -1e4,
        upper: 1e4,
    };
    let tip = Placement::translation(Vector3::new(0.3, 0.0, 0.0));
    let chain = Chain::new(vec![joint], tip).unwrap();
    let options = LaneOptions::default().with_atlas(false);
    let options = options.with_position_tolerance(1.0);
    let options = options.with_orientation_tolerance(1e-12);
    let solver = PoseSolver::new(&chain, options).unwrap();
    for (turned, reached) in [(1.0, true), (9e3, false)] {
        let (target, mut q) = (chain.base_from_tip(&[turned]).unwrap(), [0.0]);
        let outcome = solver.solve(&target, &[turned], Prefer::Start, None, &mut q);
        assert_eq!(outcome.unwrap().reached, reached, "{turned}");
    }
}

/// Rounding of all links adds up: each link resolves the tolerance on its own, all together do not.
#[test]
fn unresolvable_long_links_are_not_reached() {
    let link = Placement::translation(Vector3::new(1e8, 0.0, 0.0));
    let axes = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
    let joint = |k: usize| ChainJoint {
        parent_from_joint: link,
        axis: Vector3::from(axes[k % 3]),
        kind: JointKind::Revolute,
        lower: -1.0,
        upper: 1.0,
    };
    let reached = |joints: usize| {
        let chain = Chain::new((0..joints).map(joint).collect(), link).unwrap();
        let options = LaneOptions::default().with_atlas(false);
        let solver = PoseSolver::new(&chain, options).unwrap();
        let q = vec![0.1; joints];
        let goal = chain.base_from_tip(&q).unwrap();
        let outcome = solver.solve(&goal, &q, Prefer::Start, None, &mut vec![0.0; joints]);
        outcome.unwrap().reached
    };
    assert!(reached(1) && !reached(8));
}

/// Each of the twelve weights and half widths is validated.
#[test]
fn every_number_of_an_axis_goal_is_validated() {
    use kinopt::simd_ik::AxisGoal;
    type Part = fn(&mut AxisGoal) -> &mut [f64; 3];
    let parts: [Part; 4] = [
        |goal| &mut goal.position_weights,
        |goal| &mut goal.orientation_weights,
        |goal| &mut goal.position_half_widths,
        |goal| &mut goal.orientation_half_widths,
    ];
    for part in parts {
        for (axis, invalid) in [(0, -1e-3), (1, f64::NAN), (2, f64::NEG_INFINITY)] {
            let mut axes = AxisGoal::full_pose();
            part(&mut axes)[axis] = invalid;
            let options = LaneOptions::default().with_axes(axes);
            let refused = PoseSolver::new(&planar(), options.with_atlas(false));
            assert!(refused.is_err(), "{axes:?}");
        }
    }
}
