//! Promise: a miss returns the attempt from the start, also if time ends or costs overflow. Options that bound a search
//! have their documented effect.

use std::time::Duration;

use kinopt::Solution;
use kinopt::arm::{Arm, PoseOutcome, Search};
use kinopt::simd_ik::{LaneOptions, PoseSolver};
use kinopt::spatial::{Placement, Vector3};
use support::arms::{panda, robot, within_limits};
use support::path_steps::largest_difference;
use support::random::{Random, case_count};

/// A target 2 cm away with no time: the result is near the start, not at a seed.
#[test]
fn interrupted_search_stays_near_the_start() {
    let (robot, base, tip) = panda();
    let arm = Arm::builder(&robot, base, tip);
    let arm = arm.with_time_limit(Duration::ZERO).build().unwrap();
    let mut random = Random::split_mix(81);
    for _ in 0..20 {
        let start = random.configuration(&arm);
        let mut target = arm.base_from_tool(&start).unwrap();
        target.translation += Vector3::new(0.0, 0.012, 0.016);
        let solution = arm.solve(target, &start).unwrap();
        let moved = largest_difference(&solution.q, &start);
        assert!(
            solution.reached || moved < 0.5,
            "{moved} {}",
            solution.explain()
        );
    }
}

fn translated(start: &Placement<f64>, metres: f64) -> Placement<f64> {
    Placement::new(start.rotation, Vector3::new(metres, -metres, 0.5 * metres))
}

/// If the cost overflows, the result is the start within its limits, not previous contents.
#[test]
fn overflowing_targets_return_the_clamped_start() {
    for (name, search) in [
        ("franka_panda", Search::Start),
        ("franka_panda", Search::First),
        ("franka_panda", Search::Nearest),
        ("adept_cobra_s600", Search::Start),
    ] {
        let robot = robot(name);
        let arm = Arm::builder(&robot, "base", "flange");
        let arm = arm.with_search(search).with_atlas(false).with_attempts(6);
        let arm = arm.build().unwrap();
        let n = arm.joint_count();
        let limits: Vec<_> = arm.limits().collect();
        let near = arm.base_from_tool(&vec![0.1; n]).unwrap();
        for start in [vec![0.1; n], vec![40.0; n]] {
            let clamped: Vec<f64> = limits
                .iter()
                .zip(&start)
                .map(|(l, v)| l.clamp(*v))
                .collect();
            let mut solution = Solution::default();
            for metres in [1e150, 1e155, 1e200, 1e300, 1e307] {
                arm.solve_into(near, &vec![0.3; n], &mut solution).unwrap();
                let target = translated(&near, metres);
                arm.solve_into(target, &start, &mut solution).unwrap();
                assert!(!solution.reached && within_limits(&arm, &solution.q));
                let task = solution.tasks().next().unwrap();
                assert!(task.position_error().unwrap() > 0.1 * metres);
                if metres > 1e154 && search == Search::Start {
                    assert_eq!(solution.q, clamped, "{metres:e}");
                }
                let (mut q, mut outcomes) = (vec![99.0; n], [PoseOutcome::default()]);
                arm.solve_batch_into(&[target], &start, &mut q, &mut outcomes)
                    .unwrap();
                assert!(
                    !outcomes[0].reached && within_limits(&arm, &q),
                    "{metres:e}"
                );
                let track = arm.track(&[near, target, near], &start).unwrap();
                assert!(track.report.iter().all(|s| within_limits(&arm, &s.q)));
            }
        }
    }
}

#[test]
fn simd_overflow_returns_the_clamped_start() {
    let chain = support::simd_chains::panda();
    let options = LaneOptions::default().with_atlas(false).with_attempts(6);
    let solver = PoseSolver::new(&chain, options).unwrap();
    let target = translated(&Placement::identity(), 1e200);
    let start = [9.0; 7];
    let clamped: Vec<f64> = chain
        .joints()
        .iter()
        .map(|j| 9.0_f64.min(j.upper))
        .collect();
    for search in [
        kinopt::simd_ik::Prefer::Start,
        kinopt::simd_ik::Prefer::First,
    ] {
        let (mut q, mut outcomes) = ([99.0; 7], [PoseOutcome::default()]);
        let outcome = solver.solve(&target, &start, search, None, &mut q).unwrap();
        assert!(!outcome.reached && q.iter().zip(&clamped).all(|(q, c)| q <= c));
        if search == kinopt::simd_ik::Prefer::Start {
            assert_eq!(q, *clamped);
        }
        q = [99.0; 7];
        solver
            .solve_batch(&[target], &start, search, &mut q, &mut outcomes)
            .unwrap();
        assert!(!outcomes[0].reached && q.iter().zip(&clamped).all(|(q, c)| q <= c));
    }
}

/// All requested attempts are made for an unreachable target.
#[test]
fn attempts_and_iterations_are_as_requested() {
    let (robot, base, tip) = panda();
    let builder = || Arm::builder(&robot, base, tip).with_atlas(false);
    let start = [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8];
    let arm = builder().build().unwrap();
    let mut target = arm.base_from_tool(&start).unwrap();
    target.translation.x += 2.0;
    for search in [Search::Start, Search::First, Search::Nearest] {
        for attempts in [1, 7, 400] {
            let arm = builder().with_search(search).with_attempts(attempts);
            let solution = arm.build().unwrap().solve(target, &start).unwrap();
            assert_eq!(solution.attempts, attempts as usize, "{search:?}");
        }
        let arm = builder().with_search(search).with_iterations(40);
        let solution = arm.build().unwrap().solve(target, &start).unwrap();
        assert!(solution.attempts < 40, "{search:?} {}", solution.attempts);
    }
    // The nearest search makes all attempts for a reached target as well.
    target.translation.x -= 2.0;
    for attempts in [20, 250] {
        let arm = builder()
            .with_search(Search::Nearest)
            .with_attempts(attempts);
        let solution = arm.build().unwrap().solve(target, &start).unwrap();
        assert!(solution.reached);
        assert_eq!(solution.attempts, attempts as usize);
    }
    let nao = self::robot("aldebaran_nao");
    let arm = Arm::builder(&nao, "left_sole", "right_sole");
    let arm = arm.with_attempts(25).build().unwrap();
    let target = Placement::translation(Vector3::new(3.0, 0.0, 0.0));
    let solution = arm.solve(target, &vec![0.0; arm.joint_count()]).unwrap();
    assert_eq!(solution.attempts, 25);
}

/// A miss is that of the start, unless a global search is requested: then it is no worse.
#[test]
fn global_search_on_miss_is_opt_in() {
    let (robot, base, tip) = panda();
    let builder = || Arm::builder(&robot, base, tip).with_atlas(false);
    let default_arm = builder().build().unwrap();
    let everywhere = builder().with_global_search_on_miss(true).build().unwrap();
    let mut random = Random::split_mix(83);
    let mut better = 0;
    for _ in 0..8 {
        let start = random.configuration(&default_arm);
        let mut target = default_arm
            .base_from_tool(&random.configuration(&default_arm))
            .unwrap();
        target.translation = target.translation * 1.6;
        let (a, b) = (
            default_arm.solve(target, &start),
            everywhere.solve(target, &start),
        );
        let (a, b) = (a.unwrap(), b.unwrap());
        assert_eq!(a.reached, b.reached);
        if !a.reached {
            assert!(b.cost <= a.cost * (1.0 + 1e-9));
            better += usize::from(b.cost < a.cost * 0.99);
        }
    }
    assert!(better > 0);
}

/// A global search with the nearest search settles from the best of all attempts.
#[test]
fn global_nearest_search_settles_the_best() {
    let (robot, base, tip) = panda();
    let builder = Arm::builder(&robot, base, tip).with_atlas(false);
    let builder = builder.with_global_search_on_miss(true).with_attempts(24);
    let every = builder.clone().with_search(Search::Nearest);
    let arms = [builder, every].map(|arm| arm.build().unwrap());
    let (mut random, mut costs) = (Random::split_mix(85), [0.0; 2]);
    for _ in 0..8 {
        let start = random.configuration(&arms[0]);
        let mut target = (arms[0].base_from_tool(&random.configuration(&arms[0]))).unwrap();
        target.translation = target.translation * 1.6;
        for (arm, sum) in arms.iter().zip(&mut costs) {
            *sum += arm.solve(target, &start).unwrap().cost;
        }
    }
    assert!(costs[1] <= 1.01 * costs[0], "{costs:?}");
}

/// Single and batch solves agree, and every reached solution names its winning attempt.
#[test]
fn batch_results_equal_single_solves() {
    for (name, base, tip) in [
        ("franka_panda", "base", "flange"),
        ("universal_ur5e", "base", "flange"),
        ("aldebaran_nao", "torso", "right_sole"),
    ] {
        let robot = robot(name);
        let arm = Arm::builder(&robot, base, tip);
        let arm = arm.with_atlas(false).build().unwrap();
        let n = arm.joint_count();
        let count = case_count(300, if name.contains("nao") { 6 } else { 40 });
        let mut random = Random::split_mix(84);
        let goals: Vec<_> = (0..count)
            .map(|_| arm.base_from_tool(&random.configuration(&arm)).unwrap())
            .collect();
        let starts: Vec<f64> = (0..count)
            .flat_map(|_| random.configuration(&arm))
            .collect();
        let together = arm.solve_batch(&goals, &starts).unwrap();
        let mut q = vec![0.0; starts.len()];
        let mut outcomes = vec![PoseOutcome::default(); count];
        arm.solve_batch_into(&goals, &starts, &mut q, &mut outcomes)
            .unwrap();
        for (k, (goal, start)) in goals.iter().zip(starts.chunks(n)).enumerate() {
            let alone = arm.solve(goal, start).unwrap();
            assert_eq!(alone.q, together[k].q, "{name} {k}");
            assert_eq!(alone.q, q[k * n..(k + 1) * n], "{name} {k}");
            assert_eq!(outcomes[k].reached, outcomes[k].winner.is_some());
        }
    }
}

/// Every attempt and its steps count, whether it improves or not.
#[test]
fn unsuccessful_attempts_are_counted() {
    let robot = robot("aldebaran_nao");
    let target = Placement::translation(Vector3::new(0.05, -0.1, 0.9));
    let mut last = 0;
    for attempts in 1..9 {
        let arm = Arm::builder(&robot, "left_sole", "right_sole");
        let arm = arm.with_attempts(attempts).build().unwrap();
        let start = vec![0.05; arm.joint_count()];
        let solution = arm.solve(target, &start).unwrap();
        assert!(!solution.reached);
        assert_eq!(solution.attempts, attempts as usize);
        assert!(solution.iterations > last, "{attempts}: {solution:?}");
        last = solution.iterations;
    }
}

/// More attempts never give a worse result: of unsuccessful ones the best is returned.
#[test]
fn more_attempts_never_worsen_a_miss() {
    let robot = robot("aldebaran_nao");
    let mut random = support::random::Random::new(21);
    for _ in 0..4 {
        let target = Placement::translation(Vector3::new(
            random.within(-0.2, 0.2),
            random.within(-0.4, 0.1),
            random.within(0.6, 0.9),
        ));
        let mut last = f64::INFINITY;
        for attempts in [1, 8, 40, 129, 140] {
            let arm = Arm::builder(&robot, "left_sole", "right_sole").with_attempts(attempts);
            let arm = arm.with_global_search_on_miss(true).build().unwrap();
            let start = vec![0.05; arm.joint_count()];
            let solution = arm.solve(target, &start).unwrap();
            assert!(!solution.reached);
            assert!(solution.cost <= last * (1.0 + 1e-6), "{attempts}: {last}");
            last = solution.cost;
        }
    }
}

/// Goals with inequalities measure rotation by its chord, and all entry points report the cost of a miss accordingly.
#[test]
fn miss_of_an_inequality_goal_costs_its_chord() {
    use kinopt::arm::{Axis, PoseBounds};
    use kinopt::model::{Limits, Model};
    let mut builder = Model::builder("wrist");
    let (at, z) = (Placement::identity(), Vector3::new(0.0, 0.0, 1.0));
    let wrist = builder.revolute("wrist", None, at, z, Limits::new(-1.0, 1.0));
    builder.frame("base", None, at);
    builder.frame("tip", Some(wrist), at);
    let robot = kinopt::robot::Robot::new(builder.build().unwrap(), Vec::new()).unwrap();
    let arm = Arm::builder(&robot, "base", "tip").with_metres_per_radian(0.25);
    let arm = arm
        .with_goal(PoseBounds::free_about(Axis::X))
        .build()
        .unwrap();
    // 1.2 rad beyond the limit.
    let turned = kinopt::spatial::Matrix3::identity().rotated_about_z(2.2_f64.sin_cos());
    let target = Placement::new(turned, at.translation);
    let batch = arm.solve_batch(&[target], &[0.3]).unwrap();
    for solution in [&arm.solve(target, &[0.3]).unwrap(), &batch[0]] {
        assert!(!solution.reached && solution.q == [1.0]);
        let cost = 0.5 * (0.25 * 2.0 * 0.6_f64.sin()).powi(2);
        assert!((solution.orientation_error().unwrap() - 1.2).abs() < 1e-9);
        assert!(
            (solution.cost - cost).abs() < 1e-9,
            "{} {cost}",
            solution.cost
        );
    }
}

/// A target out of reach whose bounds contain reachable poses is reached from any start.
#[test]
fn reachable_goal_bounds_are_found() {
    use kinopt::arm::PoseBounds;
    let (robot, base, tip) = panda();
    let goal = PoseBounds::within([0.4, 0.4, 0.4, 0.0, 0.0, 0.0]);
    let arm = Arm::builder(&robot, base, tip).with_goal(goal);
    let arm = arm.build().unwrap();
    let (mut random, mut count) = (Random::split_mix(52), 0);
    while count < 40 {
        let mut target = arm.base_from_tool(&random.configuration(&arm)).unwrap();
        let length = target.translation.norm();
        let reached = target.translation;
        target.translation = target.translation * (1.4 / length);
        // The stretched arm is 1.37 m long; bounds are in the target's axes.
        let back = target.rotation.transpose() * (reached - target.translation);
        if back
            .to_array()
            .iter()
            .any(|component| component.abs() > 0.35)
        {
            continue;
        }
        count += 1;
        let start = random.configuration(&arm);
        let solution = arm.solve(target, &start).unwrap();
        assert!(solution.reached, "{count}: {}", solution.explain());
    }
}
