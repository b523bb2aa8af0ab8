//! Promise: an arm that solved other problems gives bitwise the results of a new arm, for every search and option.

use std::time::Duration;

use kinopt::Solution;
use kinopt::arm::{Arm, ArmBuilder, PoseBounds, PoseOutcome, Search};
use kinopt::collision::{Checker, World};
use kinopt::spatial::{Placement, Vector3};
use support::arms::panda;
use support::random::{Random, cases};

/// Solves random targets, one in three far outside, with a reused arm and with copies that have memory of their own.
fn assert_reuse_equals_new(name: &str, builder: ArmBuilder<'_>) {
    let arm = builder.with_atlas(false).build().unwrap();
    let new = arm.clone();
    let mut random = Random::split_mix(61);
    let mut reported = [0; 2];
    for turn in cases(60, 12) {
        let mut target = arm.base_from_tool(&random.configuration(&arm)).unwrap();
        let start = random.configuration(&arm);
        if turn % 3 == 0 {
            target.translation = target.translation * 1.6;
        }
        let [reused, fresh] = [&arm, &new.clone()].map(|arm| arm.solve(target, &start).unwrap());
        assert_eq!(format!("{reused:?}"), format!("{fresh:?}"), "{name} {turn}");
        reported[usize::from(reused.reached)] += 1;
        let [reused, fresh] =
            [&arm, &new.clone()].map(|arm| arm.solve_all_from(target, &start).unwrap());
        assert_eq!(format!("{reused:?}"), format!("{fresh:?}"), "{name} {turn}");
        let [reused, fresh] = [&arm, &new.clone()].map(|arm| {
            let (mut follower, mut solution) = (arm.follower(&start).unwrap(), Solution::default());
            let ends = (0..4).map(|k| {
                let mut near = arm.base_from_tool(&start).unwrap();
                near.translation = near.translation * (1.0 + 0.02 * f64::from(k));
                let jump = follower.advance(near, &mut solution).unwrap();
                format!("{jump:?} {solution:?}")
            });
            ends.collect::<Vec<_>>()
        });
        assert_eq!(reused, fresh, "{name} {turn}");
    }
    assert!(reported[0] > 0, "{name}: {reported:?}");
}

/// Another tool or goal does not change the motors.
#[test]
fn derived_arms_keep_velocity_limits() {
    let (robot, base, tip) = panda();
    let arm = Arm::builder(&robot, base, tip).with_atlas(false);
    let arm = arm.build().unwrap();
    // From the maker's data sheet, rad/s.
    let speeds = [2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61];
    let held = Placement::translation(Vector3::new(0.0, 0.0, 0.1));
    let others = [
        arm.with_tool(held).unwrap(),
        arm.with_goal(PoseBounds::position()).unwrap(),
    ];
    for arm in std::iter::once(&arm).chain(&others) {
        assert_eq!(arm.velocity_limits(), speeds);
    }
}

#[test]
fn reused_arm_with_any_search() {
    let (robot, base, tip) = panda();
    let builder = || Arm::builder(&robot, base, tip);
    for search in [Search::Start, Search::First, Search::Nearest] {
        assert_reuse_equals_new("search", builder().with_search(search).with_attempts(24));
    }
    assert_reuse_equals_new("everywhere", builder().with_global_search_on_miss(true));
}

#[test]
fn reused_arm_with_any_option() {
    let (robot, base, tip) = panda();
    let builder = || Arm::builder(&robot, base, tip);
    assert_reuse_equals_new("moves", builder().with_max_move(&[2.5; 7]));
    assert_reuse_equals_new(
        "posture",
        builder().with_posture(&[0.0, 0.3, 0.0, -1.8, 0.1, 1.5, 0.4]),
    );
    let bounds = PoseBounds::within([0.05, 0.05, 0.05, 0.3, 0.3, 0.3]);
    assert_reuse_equals_new("room", builder().with_goal(bounds));
    assert_reuse_equals_new("position", builder().with_goal(PoseBounds::position()));
}

/// Reused batch outcomes are overwritten, also by arms that solve one by one.
#[test]
fn reused_batch_outcomes_are_overwritten() {
    let (robot, base, tip) = panda();
    let patient = Duration::from_secs(3600);
    for limit in [None, Some(patient)] {
        let builder = Arm::builder(&robot, base, tip).with_atlas(false);
        let builder = match limit {
            Some(limit) => builder.with_time_limit(limit),
            None => builder,
        };
        let arm = builder.build().unwrap();
        let mut random = Random::split_mix(5);
        let near: Vec<_> = (0..6)
            .map(|_| arm.base_from_tool(&random.configuration(&arm)).unwrap())
            .collect();
        let mut other = near.clone();
        other.reverse();
        other[0].translation.x += 5.0;
        let starts = vec![0.1; 6 * arm.joint_count()];
        let (mut q, mut outcomes) = (vec![0.0; starts.len()], vec![PoseOutcome::default(); 6]);
        arm.solve_batch_into(&near, &starts, &mut q, &mut outcomes)
            .unwrap();
        assert!(outcomes.iter().all(|outcome| outcome.reached));
        arm.solve_batch_into(&other, &starts, &mut q, &mut outcomes)
            .unwrap();
        for ((target, q), outcome) in other.iter().zip(q.chunks(7)).zip(&outcomes) {
            let offset = arm.base_from_tool(q).unwrap().translation - target.translation;
            assert!((offset.norm() - outcome.position_error).abs() < 1e-9);
            assert_eq!(outcome.reached, offset.norm() < 1e-6);
        }
    }
}

/// Another checker has its own world, and its own joints outside the arm.
#[test]
fn reused_arm_with_another_checker() {
    let (robot, base, tip) = panda();
    let mut random = Random::split_mix(17);
    let mut coordinate = || (random.unit() - 0.5) * 1.2;
    let mut world = World::new();
    for ball in 0..8 {
        let at = Vector3::new(coordinate(), coordinate(), 0.5 + coordinate().abs());
        world.add_sphere(&format!("ball {ball}"), 0.1, at).unwrap();
    }
    let checker = Checker::of(&robot).unwrap();
    let among = checker.clone().with_world(&world).unwrap();
    let shut = robot.model().neutral();
    let mut open = shut.clone();
    let n = open.len();
    open[n - 2..].fill(0.04);
    let plain = Arm::builder(&robot, base, tip).with_atlas(false);
    let plain = plain.build().unwrap();
    let checked_arm = plain.clone().with_checker(&checker, &shut).unwrap();
    let mut random = Random::split_mix(18);
    let queries = (0..6).map(|_| {
        let target = plain.base_from_tool(&random.configuration(&plain)).unwrap();
        (target, random.configuration(&plain))
    });
    let queries: Vec<_> = queries.collect();
    let results = |arm: &Arm| -> Vec<String> {
        let solve = |(target, start): &(Placement<f64>, Vec<f64>)| {
            let solution = arm.solve(*target, start).unwrap();
            format!("{solution:?} {:?}", solution.collisions())
        };
        queries.iter().map(solve).collect()
    };
    let alone = results(&checked_arm);
    let reopened = results(&checked_arm.with_checker(&among, &open).unwrap());
    let fresh = results(&plain.with_checker(&among, &open).unwrap());
    assert_eq!(reopened, fresh);
    assert_ne!(alone, fresh);
}
