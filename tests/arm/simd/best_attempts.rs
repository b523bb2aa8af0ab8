//! Promise: if no attempt reaches the target, the result is the best attempt, or the start's own attempt if the search
//! prefers it.
#![allow(clippy::unwrap_used)]

use kinopt::simd_ik::{LaneOptions, PoseOutcome, PoseSolver, Prefer};
use support::random::Random;
use support::simd_chains::{errors, panda, target};

/// Weight of the orientation in the cost ½ p² + w² (1 − cos θ), which the solver minimises.
const METRES_PER_RADIAN: f64 = 0.5;

#[test]
fn unreached_target_keeps_the_best_attempt() {
    let chain = panda();
    // Few iterations, so that hardly any attempt converges.
    let options = LaneOptions::default()
        .with_atlas(false)
        .with_attempts(7)
        .with_iterations(3)
        .with_metres_per_radian(METRES_PER_RADIAN);
    let solver = PoseSolver::new(&chain, options).unwrap();
    let (mut random, mut not_last) = (Random::split_mix(41), 0);
    for _ in 0..20 {
        let goal = target(&chain, &random.chain_configuration(&chain));
        let start = random.chain_configuration(&chain);
        let cost = |q: &[f64]| {
            let (distance, angle) = errors(&chain, q, &goal);
            let turned = METRES_PER_RADIAN * METRES_PER_RADIAN * 2.0 * (1.0 - angle.cos());
            distance * distance + turned
        };
        for search in [Prefer::Start, Prefer::First] {
            let (mut all, mut each) = (vec![0.0; 49], [PoseOutcome::default(); 7]);
            solver
                .run_attempts(&goal, &start, search, 0, &mut all, &mut each)
                .unwrap();
            let (mut q, mut outcome) = ([0.0; 7], [PoseOutcome::default()]);
            solver
                .solve_batch(&[goal], &start, search, &mut q, &mut outcome)
                .unwrap();
            if outcome[0].reached {
                continue;
            }
            let costs: Vec<f64> = all.chunks(7).map(cost).collect();
            let lowest = costs.iter().copied().fold(f64::INFINITY, f64::min);
            let expected = if search == Prefer::Start {
                costs[0]
            } else {
                lowest
            };
            assert!(
                (cost(&q) - expected).abs() < 1e-9,
                "{search:?} {} {costs:?}",
                cost(&q)
            );
            not_last += usize::from(search == Prefer::First && costs[6] > lowest);
            let mut alone = [0.0; 7];
            let raced = solver
                .solve(&goal, &start, search, None, &mut alone)
                .unwrap();
            assert!(!raced.reached && (cost(&alone) - expected).abs() < 1e-9);
        }
    }
    assert!(not_last > 8, "{not_last}");
}

/// If all attempts miss by the same amount, the first one counts. Here the square of the distance overflows.
#[test]
fn equally_bad_attempts_keep_the_first() {
    let chain = panda();
    let options = LaneOptions::default().with_atlas(false).with_attempts(7);
    let solver = PoseSolver::new(&chain, options).unwrap();
    let mut random = Random::split_mix(43);
    for _ in 0..5 {
        let mut goal = target(&chain, &random.chain_configuration(&chain));
        goal.translation.x = 1e200;
        let start = random.chain_configuration(&chain);
        for search in [Prefer::Start, Prefer::First] {
            let (mut all, mut each) = (vec![0.0; 49], [PoseOutcome::default(); 7]);
            solver
                .run_attempts(&goal, &start, search, 0, &mut all, &mut each)
                .unwrap();
            assert!(all.chunks(7).skip(1).any(|q| q != &all[..7]));
            let (mut q, mut outcome) = ([0.0; 7], [PoseOutcome::default()]);
            solver
                .solve_batch(&[goal], &start, search, &mut q, &mut outcome)
                .unwrap();
            assert!(!outcome[0].reached);
            assert_eq!(q, all[..7], "{search:?}");
            let mut alone = [0.0; 7];
            let raced = solver
                .solve(&goal, &start, search, None, &mut alone)
                .unwrap();
            assert!(!raced.reached);
            assert_eq!(alone, all[..7], "{search:?}");
        }
    }
}
