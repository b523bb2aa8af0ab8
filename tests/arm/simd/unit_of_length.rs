//! Promise: results do not depend on the unit of length. A chain with targets and tolerances in another unit has the
//! same angles, bitwise where the units differ by a power of two.

use kinopt::simd_ik::{
    AxisGoal, Chain, ChainJoint, JointKind, LaneOptions, PoseOutcome, PoseSolver, Prefer,
};
use kinopt::spatial::Placement;
use support::random::{Random, cases, part};
use support::simd_chains::{panda, random_chain, target, ur5};

fn scaled(placement: &Placement<f64>, factor: f64) -> Placement<f64> {
    Placement::new(placement.rotation, placement.translation * factor)
}

/// The same chain in a unit `factor` times as small.
fn chain_in(chain: &Chain, factor: f64) -> Chain {
    let joints = chain.joints().iter().map(|joint| {
        let unit = if joint.kind == JointKind::Prismatic {
            factor
        } else {
            1.0
        };
        ChainJoint {
            parent_from_joint: scaled(&joint.parent_from_joint, factor),
            lower: joint.lower * unit,
            upper: joint.upper * unit,
            ..*joint
        }
    });
    Chain::new(joints.collect(), scaled(chain.joint_from_tip(), factor)).unwrap()
}

fn options_in(factor: f64) -> LaneOptions {
    LaneOptions::default()
        .with_position_tolerance(1e-6 * factor)
        .with_metres_per_radian(0.3 * factor)
}

/// q and outcomes in the original unit: single queries, both searches, and batches; reached and not.
fn results(chain: &Chain, factor: f64) -> (Vec<f64>, Vec<PoseOutcome>) {
    let scaled_chain = chain_in(chain, factor);
    let solver = PoseSolver::new(&scaled_chain, options_in(factor)).unwrap();
    let n = solver.joints();
    let units: Vec<f64> = chain
        .joints()
        .iter()
        .map(|joint| {
            if joint.kind == JointKind::Prismatic {
                factor
            } else {
                1.0
            }
        })
        .collect();
    let mut random = Random::split_mix(3);
    let (mut goals, mut starts) = (Vec::new(), Vec::new());
    for k in cases(24, 8) {
        let mut goal = target(chain, &random.chain_configuration(chain));
        if k % 8 == 7 {
            goal.translation = goal.translation * 4.0;
        }
        goals.push(scaled(&goal, factor));
        let start = random.chain_configuration(chain);
        starts.extend(start.iter().zip(&units).map(|(q, unit)| q * unit));
    }
    let (mut all, mut outcomes) = (Vec::new(), Vec::new());
    let mut q = vec![0.0; n];
    for (goal, start) in goals.iter().zip(starts.chunks(n)) {
        for search in [Prefer::Start, Prefer::First] {
            outcomes.push(solver.solve(goal, start, search, None, &mut q).unwrap());
            all.extend_from_slice(&q);
        }
    }
    let (mut q, mut batch) = (
        vec![0.0; starts.len()],
        vec![PoseOutcome::default(); goals.len()],
    );
    let search = Prefer::Start;
    solver
        .solve_batch(&goals, &starts, search, &mut q, &mut batch)
        .unwrap();
    all.extend_from_slice(&q);
    outcomes.extend(batch);
    for q in all.chunks_mut(n) {
        for (value, unit) in q.iter_mut().zip(&units) {
            *value /= unit;
        }
    }
    for outcome in &mut outcomes {
        outcome.position_error /= factor;
    }
    (all, outcomes)
}

fn chains() -> Vec<Chain> {
    vec![
        panda(),
        ur5(),
        random_chain(5, 7, 2, false),
        random_chain(9, 4, 1, false),
    ]
}

#[test]
fn powers_of_two_give_bitwise_equal_results() {
    for chain in chains() {
        let (q, outcomes) = results(&chain, 1.0);
        assert!(outcomes.iter().any(|outcome| outcome.reached));
        // Far and near: rounding of lengths does not affect that of angles.
        for factor in part([2_f64.powi(40), 1.0 / 4096.0, 1024.0], 2) {
            let (other, others) = results(&chain, factor);
            let bits = |q: &[f64]| -> Vec<u64> { q.iter().map(|v| v.to_bits()).collect() };
            assert_eq!(bits(&q), bits(&other));
            assert_eq!(outcomes, others);
        }
    }
}

/// Only revolute joints: prismatic joints are weighted by powers of two.
#[test]
fn millimetres_give_the_same_angles() {
    for chain in [panda(), ur5()] {
        let (q, outcomes) = results(&chain, 1.0);
        let (other, others) = results(&chain, 1000.0);
        let n = chain.joints().len();
        let (mut compared, mut same) = (0, 0);
        for (k, (a, b)) in outcomes.iter().zip(&others).enumerate() {
            assert_eq!(a.reached, b.reached);
            // Out of reach, rounding may lead to another end.
            if !a.reached {
                continue;
            }
            compared += 1;
            let (q, other) = (&q[k * n..(k + 1) * n], &other[k * n..(k + 1) * n]);
            let apart = q.iter().zip(other).map(|(a, b)| (a - b).abs());
            let apart = apart.fold(0.0, f64::max);
            same += usize::from(apart < 1e-6);
        }
        assert!(6 * compared >= 5 * outcomes.len(), "{compared}");
        assert_eq!(same, compared);
    }
}

/// A start many turns away is valid.
#[test]
fn starts_many_turns_away_are_solved() {
    use std::f64::consts::TAU;
    let chain = ur5();
    let mut joints = chain.joints().to_vec();
    for joint in &mut joints {
        (joint.lower, joint.upper) = (f64::NEG_INFINITY, f64::INFINITY);
    }
    let chain = Chain::new(joints, *chain.joint_from_tip()).unwrap();
    let solver = PoseSolver::new(&chain, LaneOptions::default()).unwrap();
    let mut random = Random::split_mix(8);
    let mut q = [0.0; 6];
    for turns in [1e3, 1e5, 1e7, 1e12] {
        for search in [Prefer::Start, Prefer::First] {
            let target_q = random.chain_configuration(&chain);
            let goal = target(&chain, &target_q);
            let start: Vec<f64> = (0..6)
                .map(|_| random.within(-1.0, 1.0) + turns * TAU)
                .collect();
            let outcome = solver.solve(&goal, &start, search, None, &mut q).unwrap();
            assert!(outcome.reached, "{turns} {outcome:?}");
            for (q, start) in q.iter().zip(&start) {
                let near = if start.abs() < 0.99e6 { *start } else { 0.0 };
                let half = if near == 0.0 { TAU } else { 0.5 * TAU };
                assert!((q - near).abs() <= half + 1e-9, "{q} from {start}");
            }
            let at = target(&chain, &q).translation - goal.translation;
            assert!(at.norm() < 1.01e-6);
        }
    }
}

/// The half width of a position is in the chain's unit.
#[test]
fn half_widths_are_in_the_unit_of_the_chain() {
    for factor in [1.0, 1024.0] {
        let chain = chain_in(&ur5(), factor);
        let half_width = 0.05 * factor;
        let axes = AxisGoal {
            position_half_widths: [half_width; 3],
            ..AxisGoal::full_pose()
        };
        let options = options_in(factor).with_axes(axes).with_atlas(false);
        let solver = PoseSolver::new(&chain, options).unwrap();
        let mut random = Random::split_mix(9);
        let (mut q, mut used) = ([0.0; 6], 0.0_f64);
        for _ in 0..10 {
            let goal = target(&chain, &random.chain_configuration(&chain));
            let start = random.chain_configuration(&chain);
            let outcome = solver.solve(&goal, &start, Prefer::Start, None, &mut q);
            assert!(outcome.unwrap().reached);
            let offset = goal.inverse() * target(&chain, &q);
            for component in offset.translation.to_array() {
                assert!(
                    component.abs() < half_width + 1.01e-6 * factor,
                    "{component} in units of {factor}"
                );
                used = used.max(component.abs());
            }
        }
        assert!(used > 0.5 * half_width, "{used} in units of {factor}");
    }
}
