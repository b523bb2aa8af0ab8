//! The errors beside a q are the errors of that q, judged by nalgebra's kinematics.
#![allow(clippy::unwrap_used)]

use kinopt::lanes::{Chain, LaneOptions, PoseSolver, Search};
use support::lane_chains::{Random, errors, far_away, panda, planar, random_chain, target, ur5};

fn check(chain: &Chain, seed: u64) {
    let options = LaneOptions {
        atlas: false,
        attempts: 5,
        ..LaneOptions::default()
    };
    let solver = PoseSolver::new(chain, options).unwrap();
    let mut random = Random(seed);
    let mut q = vec![0.0; solver.joints()];
    for k in 0..12 {
        let goal = if k % 4 == 3 {
            far_away()
        } else {
            target(chain, &random.configuration(chain))
        };
        let start = random.configuration(chain);
        let outcome = solver
            .solve(&goal, &start, Search::Start, None, &mut q)
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
fn reported_errors_are_those_of_the_returned_values() {
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
