//! Promise: the attempt that is named as the winner is the one that the answer came from.
#![allow(clippy::unwrap_used)]

use kinopt::arm::{Arm, Outcome};
use support::arms::{Random, panda};

/// With no attempt after the winner the answer is the same.
#[test]
fn later_attempts_than_the_winner_change_nothing() {
    let (robot, base, tip) = panda();
    // So few steps that the start's own end and the best of all are what is settled from.
    let builder = || Arm::builder(&robot, base, tip).unwrap().with_atlas(false);
    let (mut random, mut later) = (Random(31), 0);
    for iterations in [40, 120, 2000] {
        let builder = || builder().with_iterations(iterations);
        let arm = builder().build().unwrap();
        for _ in 0..40 {
            let corner = random.configuration(&arm);
            let target = arm.base_from_tool(&corner).unwrap();
            let start = random.configuration(&arm);
            let (mut q, mut outcome) = ([0.0; 7], [Outcome::default()]);
            arm.solve_batch_into(&[target], &start, &mut q, &mut outcome)
                .unwrap();
            let Some(winner) = outcome[0].winner else {
                assert!(!outcome[0].reached);
                continue;
            };
            assert!(winner < outcome[0].attempts);
            if winner == 0 {
                continue;
            }
            later += 1;
            let fewer = builder().with_attempts(winner + 1).build().unwrap();
            assert_eq!(
                fewer.solve(target, &start).unwrap().q,
                q,
                "{:?}",
                outcome[0]
            );
        }
    }
    assert!(later > 20, "{later}");
}

/// A miss makes the attempts that its steps pay for, whatever settling costs on top: as many from a start whose
/// own end is settled at once as from others.
#[test]
fn settling_is_not_charged_to_the_attempts() {
    let (robot, base, tip) = panda();
    let builder = Arm::builder(&robot, base, tip).unwrap().with_atlas(false);
    let builder = builder.with_attempts(5000);
    let mut random = Random(32);
    for iterations in [900, 3200] {
        let arm = builder.clone().with_iterations(iterations).build().unwrap();
        let start = random.configuration(&arm);
        let mut target = arm.base_from_tool(&start).unwrap();
        target.translation.x += 3.0;
        let solution = arm.solve(target, &start).unwrap();
        assert!(!solution.reached);
        // An attempt out of reach takes 6 steps at least and 18 on average at most.
        let most = iterations as usize / 6;
        assert!(solution.attempts <= most && solution.attempts > iterations as usize / 18);
        assert!(
            solution.iterations >= iterations as usize,
            "{}",
            solution.iterations
        );
    }
}
