//! Promise: the reported winner is the attempt that gave the result.

use kinopt::arm::{Arm, PoseOutcome, Search};
use support::arms::panda;
use support::random::Random;

/// Without attempts after the winner the result is equal.
#[test]
fn attempts_after_the_winner_change_nothing() {
    let (robot, base, tip) = panda();
    let builder = Arm::builder(&robot, base, tip).with_atlas(false);
    let (mut random, mut later) = (Random::split_mix(31), [0; 5]);
    let ways = [
        // So few iterations that only the first and the best attempt settle.
        builder.clone().with_iterations(40),
        builder.clone().with_iterations(120),
        builder.clone().with_iterations(2000),
        // First the attempt from the start, then others.
        builder.clone().with_max_move(&[0.8; 7]),
        builder.with_search(Search::First).with_iterations(60),
    ];
    for (k, (variant, later)) in ways.iter().zip(&mut later).enumerate() {
        let arm = variant.clone().build().unwrap();
        let apart = if k == 3 { 0.7 } else { 9.0 };
        for _ in 0..40 {
            let start = random.configuration(&arm);
            let target_q = random.configuration(&arm);
            let near = start
                .iter()
                .zip(&target_q)
                .map(|(a, b)| a + (b - a).clamp(-apart, apart));
            let near: Vec<f64> = near.collect();
            let target = arm.base_from_tool(&near).unwrap();
            let (mut q, mut outcome) = ([0.0; 7], [PoseOutcome::default()]);
            arm.solve_batch_into(&[target], &start, &mut q, &mut outcome)
                .unwrap();
            let Some(winner) = outcome[0].winner else {
                assert!(!outcome[0].reached);
                continue;
            };
            assert!(winner < outcome[0].attempts);
            *later += usize::from(winner > 0);
            let fewer = variant.clone().with_attempts(winner + 1).build().unwrap();
            assert_eq!(
                fewer.solve(target, &start).unwrap().q,
                q,
                "{:?}",
                outcome[0]
            );
        }
    }
    assert!(later.iter().all(|later| *later > 1), "{later:?}");
}

/// A batch makes no more attempts than requested and equals single solves.
#[test]
fn batch_keeps_the_attempt_limit() {
    let (robot, base, tip) = panda();
    let builder = Arm::builder(&robot, base, tip).with_atlas(false);
    let arm = builder.with_attempts(2).build().unwrap();
    let (mut random, mut missed) = (Random::split_mix(33), 0);
    for _ in 0..12 {
        let target = arm.base_from_tool(&random.configuration(&arm)).unwrap();
        let start = random.configuration(&arm);
        let alone = arm.solve(target, &start).unwrap();
        let together = arm.solve_batch(&[target], &start).unwrap();
        assert!(together[0].attempts <= 2, "{}", together[0].attempts);
        assert_eq!(
            (together[0].reached, &together[0].q),
            (alone.reached, &alone.q)
        );
        missed += usize::from(!alone.reached);
    }
    assert!(missed > 0);
}

/// Settling does not reduce the number of attempts that the iterations of a miss allow, whatever the start.
#[test]
fn settling_does_not_reduce_attempts() {
    let (robot, base, tip) = panda();
    let builder = Arm::builder(&robot, base, tip).with_atlas(false);
    let builder = builder.with_attempts(5000);
    let mut random = Random::split_mix(32);
    for iterations in [900, 3200] {
        let arm = builder.clone().with_iterations(iterations).build().unwrap();
        let start = random.configuration(&arm);
        let mut target = arm.base_from_tool(&start).unwrap();
        target.translation.x += 3.0;
        let solution = arm.solve(target, &start).unwrap();
        assert!(!solution.reached);
        // An attempt out of reach takes at least 6 steps and on average at most 18.
        let max_attempts = iterations as usize / 6;
        assert!(solution.attempts <= max_attempts && solution.attempts > iterations as usize / 18);
        assert!(
            solution.iterations >= iterations as usize,
            "{}",
            solution.iterations
        );
    }
    // Only iterations count: forty more allow another attempt, although settling takes more than that.
    let start = random.configuration(&builder.clone().build().unwrap());
    let attempts = |iterations: u32| {
        let arm = builder.clone().with_iterations(iterations).build().unwrap();
        let mut target = arm.base_from_tool(&start).unwrap();
        target.translation.x += 3.0;
        arm.solve(target, &start).unwrap().attempts
    };
    assert!(attempts(640) > attempts(600));
}
