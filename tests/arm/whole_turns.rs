//! Promise: for joints with a range above one turn, the turn nearest to the start is returned, as far as limits allow.
//! This includes move limits.

use std::f64::consts::TAU;

use kinopt::arm::Arm;
use support::arms::{robot, within_limits};
use support::random::Random;

#[test]
fn returned_turn_is_nearest_to_the_start() {
    let robot = robot("universal_ur5e");
    let mut random = Random::split_mix(48);
    for max_move in [3.5, 4.5, 6.0] {
        let builder = Arm::builder(&robot, "base", "flange").with_atlas(false);
        let arm = builder.with_max_move(&[max_move; 6]).build().unwrap();
        let mut reached = 0;
        for _ in 0..30 {
            let start: Vec<f64> = (0..6).map(|_| 2.0 * random.unit() - 1.0).collect();
            let moved = start
                .iter()
                .map(|value| value + max_move * (2.0 * random.unit() - 1.0));
            let goal = arm.base_from_tool(&moved.collect::<Vec<f64>>()).unwrap();
            let solution = arm.solve(goal, &start).unwrap();
            assert!(within_limits(&arm, &solution.q));
            reached += u32::from(solution.reached);
            if !solution.reached {
                continue;
            }
            for (value, from) in solution.q.iter().zip(&start) {
                let distance = (value - from).abs();
                assert!(distance <= max_move, "{distance}");
                assert!(
                    distance <= TAU / 2.0 + 1e-9,
                    "{value} from {from}, at most {max_move}"
                );
            }
        }
        assert!(reached > 20, "{max_move}: {reached}");
    }
}
