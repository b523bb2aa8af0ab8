//! Promise: no pair of links that can touch is left out because a thousand samples did not find where it does.

use kinopt::collision::{Checker, CollisionModel};
use support::arms::robot;
use support::lines::ROBOTS;
use support::sample::cases;

/// Pairs that touch in such a share of all configurations are made to.
const NEARLY_ALWAYS: f64 = 0.9;

#[test]
fn a_pair_that_is_left_out_touches_nowhere_or_nearly_everywhere() {
    let count = cases(10_000, 1_000);
    for (name, ..) in ROBOTS {
        let robot = robot(name);
        let all = CollisionModel::of(&robot).unwrap();
        let kept = all.clone().with_pairs_sampled(1000, 0).unwrap();
        let mut left_out = all;
        for [a, b] in kept.pairs() {
            left_out = left_out.with_ignored(*a, *b).unwrap();
        }
        // What exactly meets touches too.
        let checker = Checker::new(left_out).with_margin(2e-9).unwrap();
        let mut workspace = checker.workspace();
        let (model, map) = (robot.model(), robot.map());
        let mut x = vec![0.0; map.variables()];
        let mut found = std::collections::BTreeMap::new();
        for seed in 0..count as u64 {
            let mut q = model.random_configuration(1_000_000 + seed);
            map.reduce(&q, &mut x).unwrap();
            map.expand_within_limits(&x, &mut q).unwrap();
            for pair in checker.collisions_with(&mut workspace, &q).unwrap() {
                let depths: &mut Vec<f64> = found.entry((pair.first, pair.second)).or_default();
                depths.push(pair.distance);
            }
        }
        for (pair, depths) in found {
            let share = depths.len() as f64 / count as f64;
            let deepest = depths.iter().copied().fold(0.0, f64::min);
            assert!(
                share > NEARLY_ALWAYS,
                "{name}: {pair:?} touch in {share} of all configurations, by up to {deepest} m"
            );
        }
    }
}
