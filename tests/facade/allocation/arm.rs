//! Promise: after the first few queries an arm allocates nothing, alone and in batches, with any options, also where
//! the target is out of reach.

use crate::counting_allocator::allocations;
use kinopt::Solution;
use kinopt::arm::{Arm, ArmBuilder, PoseBounds, PoseOutcome, Search};
use kinopt::spatial::Placement;
use support::arms::{panda, robot};
use support::random::Random;

/// Targets, every fifth of them out of reach, and starts, one configuration after another.
fn queries(arm: &Arm, count: usize) -> (Vec<Placement<f64>>, Vec<f64>) {
    let mut random = Random::split_mix(51);
    let mut starts = Vec::new();
    let goals = (0..count).map(|k| {
        let truth = random.configuration(arm);
        let mut goal = arm.base_from_tool(&truth).unwrap();
        if k % 5 == 4 {
            goal.translation.x += 3.0;
        }
        // Every other start is near the result, for bounded moves.
        match k % 2 {
            0 => starts.extend(truth.iter().map(|v| v + 0.1 * random.unit())),
            _ => starts.extend(random.configuration(arm)),
        }
        goal
    });
    (goals.collect(), starts)
}

fn assert_later_rounds_allocate_nothing(what: &str, builder: ArmBuilder<'_>) {
    let arm = builder.with_atlas(false).with_attempts(12).build().unwrap();
    let n = arm.joint_count();
    let (goals, starts) = queries(&arm, 15);
    let mut solution = Solution::default();
    let mut solve_all = || {
        for (goal, start) in goals.iter().zip(starts.chunks(n)) {
            arm.solve_into(*goal, start, &mut solution).unwrap();
        }
    };
    // The same queries twice: the second round needs the memory that the first has allocated.
    solve_all();
    assert_eq!(allocations(&mut solve_all), 0, "{what}: solve_into");
    let mut q = vec![0.0; starts.len()];
    let mut outcomes = vec![PoseOutcome::default(); goals.len()];
    let mut solve_batch = || {
        arm.solve_batch_into(&goals, &starts, &mut q, &mut outcomes)
            .unwrap();
    };
    solve_batch();
    assert_eq!(allocations(&mut solve_batch), 0, "{what}: solve_batch_into");
    assert!(outcomes.iter().any(|o| o.reached) && outcomes.iter().any(|o| !o.reached));
}

#[test]
fn solves_with_any_options_allocate_nothing() {
    let (robot, base, tip) = panda();
    let builder = || Arm::builder(&robot, base, tip);
    assert_later_rounds_allocate_nothing("start", builder());
    assert_later_rounds_allocate_nothing("first", builder().with_search(Search::First));
    assert_later_rounds_allocate_nothing("nearest", builder().with_search(Search::Nearest));
    assert_later_rounds_allocate_nothing("position", builder().with_goal(PoseBounds::position()));
    assert_later_rounds_allocate_nothing("bounded moves", builder().with_max_move(&[0.5; 7]));
    assert_later_rounds_allocate_nothing("posture", builder().with_posture(&[0.3; 7]));
    let limit = std::time::Duration::from_secs(3600);
    assert_later_rounds_allocate_nothing("time limit", builder().with_time_limit(limit));
}

#[test]
fn chain_with_mimic_joint_allocates_nothing() {
    let robot = robot("aldebaran_nao");
    let builder = Arm::builder(&robot, "torso", "right_sole");
    assert_later_rounds_allocate_nothing("follower", builder);
}

/// Targets out of reach and back, one after another.
#[test]
fn followers_and_servos_allocate_nothing() {
    let (robot, base, tip) = panda();
    let arm = Arm::builder(&robot, base, tip);
    let arm = arm.with_atlas(false).build().unwrap();
    let start = [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8];
    let first = arm.base_from_tool(&start).unwrap();
    let targets: Vec<_> = (0..120_i32)
        .map(|k| {
            let mut target = first;
            target.translation.x += 0.01 * f64::from(60 - (k - 60).abs());
            target
        })
        .collect();
    let mut follower = arm.follower(&start).unwrap();
    let mut servo = arm.servo(&start, 1e-2).unwrap();
    let mut solution = Solution::default();
    let mut missed = 0;
    let mut go = || {
        for target in &targets {
            follower.advance(*target, &mut solution).unwrap();
            missed += usize::from(!servo.step(*target).unwrap().reached());
            missed += usize::from(!solution.reached);
        }
    };
    go();
    assert_eq!(allocations(&mut go), 0);
    assert!(missed > 40, "{missed}");
}

/// A servo rests and restarts its prediction where a target jumps and where it is stopped.
#[test]
fn servo_jumps_and_stops_allocate_nothing() {
    let (robot, base, tip) = panda();
    let arm = Arm::builder(&robot, base, tip);
    let arm = arm.with_atlas(false).build().unwrap();
    let start = [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8];
    let ends = [start, [0.6, -0.2, 0.3, -1.6, 0.2, 1.9, 0.4]];
    let targets = ends.map(|q| arm.base_from_tool(&q).unwrap());
    let servo = arm.servo(&start, 1e-2).unwrap();
    let mut servo = servo.with_acceleration_limits(&[10.0; 7]).unwrap();
    let mut go = || {
        for target in [targets[1], targets[0]] {
            for _ in 0..20 {
                servo.step(target).unwrap();
            }
        }
        for _ in 0..20 {
            servo.stop();
        }
    };
    go();
    assert_eq!(allocations(&mut go), 0);
}

/// A path that stays out of reach searches for a detour where its branch ends, and not at every miss again.
#[test]
fn detour_of_an_unreachable_path_is_sought_once() {
    let robot = robot("adept_cobra_s600");
    let arm = Arm::new(&robot, "base", "flange").unwrap();
    // The first joint runs into its limit; with the elbow bent the other way it could go on.
    let limit = arm.limits().next().unwrap().upper;
    let start = [limit - 0.1, -0.9, 0.1, 0.0];
    let first = arm.base_from_tool(&start).unwrap();
    let path: Vec<_> = (0..60)
        .map(|k| {
            let turn = 0.01 * f64::from(k);
            let about = kinopt::spatial::Matrix3::identity().rotated_about_z(turn.sin_cos());
            Placement::new(about * first.rotation, about * first.translation)
        })
        .collect();
    let mut missed = 0;
    let mut count = |steps: usize| {
        let mut track = None;
        let made = allocations(&mut || track = Some(arm.track(&path[..steps], &start).unwrap()));
        let solutions = track.unwrap().report;
        missed = solutions.iter().filter(|s| !s.reached).count();
        made
    };
    count(60);
    let [few, many] = [20, 60].map(&mut count);
    assert!(missed > 40, "{missed}");
    // A step's solution takes a few allocations.
    assert!(many - few <= 40 * 8, "{few} {many}");
}
