//! Promise: no q returned by the SIMD solver exceeds its bounds by a single bit, whether the target is reached or not.

use kinopt::simd_ik::{Chain, LaneOptions, PoseOutcome, PoseSolver, Prefer};
use support::random::Random;
use support::simd_chains::{far_away, panda, planar, random_chain, target, ur5, within_bounds};

fn check(chain: &Chain, seed: u64, queries: usize) {
    let options = LaneOptions::default().with_atlas(false).with_attempts(6);
    let solver = PoseSolver::new(chain, options).unwrap();
    let n = solver.joints();
    let mut random = Random::split_mix(seed);
    let mut q = vec![0.0; n];
    for k in 0..queries {
        // Goals on the bounds and out of reach; starts within, on and far outside the bounds.
        let mut truth = random.chain_configuration(chain);
        for (value, joint) in truth.iter_mut().zip(chain.joints()) {
            if random.unit() < 0.4 && joint.upper.is_finite() {
                *value = if random.unit() < 0.5 {
                    joint.lower
                } else {
                    joint.upper
                };
            }
        }
        let goal = if k % 5 == 4 {
            far_away()
        } else {
            target(chain, &truth)
        };
        let start: Vec<f64> = (0..n).map(|_| random.within(-8.0, 8.0)).collect();
        for search in [Prefer::Start, Prefer::First] {
            solver.solve(&goal, &start, search, None, &mut q).unwrap();
            assert!(within_bounds(chain, &q), "{q:?}");
        }
        let mut many = vec![0.0; 3 * n];
        let mut outcomes = [PoseOutcome::default(); 3];
        let (goals, starts) = ([goal, far_away(), goal], start.repeat(3));
        solver
            .solve_batch(&goals, &starts, Prefer::Start, &mut many, &mut outcomes)
            .unwrap();
        solver
            .track(&goals, &start, &mut q.repeat(3), &mut outcomes)
            .unwrap();
        assert!(many.chunks(n).all(|q| within_bounds(chain, q)));
    }
}

#[test]
fn known_arms_stay_within_bounds() {
    check(&panda(), 11, 20);
    check(&ur5(), 12, 20);
    check(&planar(), 13, 20);
}

#[test]
fn random_chains_stay_within_bounds() {
    for seed in 0..12 {
        let joints = 1 + seed as usize % 9;
        check(
            &random_chain(seed, joints, seed as usize % 3, seed % 2 == 0),
            seed,
            4,
        );
    }
}

/// Joints with a range of more than one turn return the equivalent value within the bounds that is nearest to the
/// start. This also holds where the nearest of all values exceeds a bound.
#[test]
fn multi_turn_joints_stay_near_start_within_bounds() {
    let mut joints = panda().joints().to_vec();
    for joint in &mut joints {
        (joint.lower, joint.upper) = (-5.0, 5.0);
    }
    let chain = Chain::new(joints, *panda().joint_from_tip()).unwrap();
    let solver = PoseSolver::new(&chain, LaneOptions::default()).unwrap();
    let (mut random, mut held) = (Random::split_mix(14), 0);
    let mut q = vec![0.0; 7];
    for _ in 0..60 {
        let goal = target(&chain, &random.chain_configuration(&chain));
        let start: Vec<f64> = (0..7).map(|_| random.within(-9.0, 9.0)).collect();
        let outcome = solver
            .solve(&goal, &start, Prefer::First, None, &mut q)
            .unwrap();
        assert!(outcome.reached && within_bounds(&chain, &q));
        for (q, start) in q.iter().zip(&start) {
            for turned in [q - std::f64::consts::TAU, q + std::f64::consts::TAU] {
                let nearer = (turned - start).abs() < (q - start).abs() - 1e-9;
                assert!(!nearer || turned.abs() > 5.0, "{q} from {start}");
                held += usize::from(nearer);
            }
        }
    }
    assert!(held > 40, "{held} were held by a bound");
}

/// Also with starts outside: a solve that ends at its first point returns values within the bounds.
#[test]
fn first_point_is_within_bounds() {
    for seed in 0..4 {
        let chain = random_chain(40 + seed, 7, 0, false);
        let options = LaneOptions::default().with_iterations(1);
        let solver = PoseSolver::new(&chain, options).unwrap();
        let mut random = Random::split_mix(seed);
        for _ in 0..20 {
            let goal = target(&chain, &random.chain_configuration(&chain));
            let start = random.chain_configuration(&chain);
            let (mut q, mut each) = (vec![0.0; 7 * 6], vec![PoseOutcome::default(); 6]);
            solver
                .run_attempts(&goal, &start, Prefer::First, 0, &mut q, &mut each)
                .unwrap();
            assert!(q.chunks(7).all(|q| within_bounds(&chain, q)));
        }
    }
}
