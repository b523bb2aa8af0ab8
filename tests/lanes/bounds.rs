//! No q that the lane engine returns lies outside its bounds by one bit, reached or not.
#![allow(clippy::unwrap_used)]

use kinopt::lanes::{Chain, LaneOptions, Outcome, PoseSolver, Search};
use support::lane_chains::{
    Random, far_away, panda, planar, random_chain, target, ur5, within_bounds,
};

fn check(chain: &Chain, seed: u64, queries: usize) {
    let options = LaneOptions {
        atlas: false,
        attempts: 6,
        ..LaneOptions::default()
    };
    let solver = PoseSolver::new(chain, options).unwrap();
    let n = solver.joints();
    let mut random = Random(seed);
    let mut q = vec![0.0; n];
    for k in 0..queries {
        // Goals on the bounds, and out of reach; starts inside, on and far outside the bounds.
        let mut truth = random.configuration(chain);
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
        for search in [Search::Start, Search::First] {
            solver.solve(&goal, &start, search, None, &mut q).unwrap();
            assert!(within_bounds(chain, &q), "{q:?}");
        }
        let mut many = vec![0.0; 3 * n];
        let mut outcomes = [Outcome::default(); 3];
        let (goals, starts) = ([goal, far_away(), goal], start.repeat(3));
        solver
            .solve_batch(&goals, &starts, Search::Start, &mut many, &mut outcomes)
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
