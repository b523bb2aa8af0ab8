//! Promise: a time limit ends a search at the next check of the clock, which is near. The best result so far is
//! returned, within limits, with its errors. A limit that is not met changes nothing.

use std::time::Duration;

use kinopt::Solution;
use kinopt::arm::{Arm, ArmBuilder, PoseBounds, Search};
use kinopt::solver::Termination;
use kinopt::spatial::Placement;
use support::arms::{panda, robot, within_limits};
use support::random::{Random, case_count, cases};
use support::urdf_matrices::{apart, from_placement};

/// Lanes of the widest SIMD group: iterations of one lockstep.
const LOCK_STEP: usize = 8;
/// Largest number of iterations between two checks of the clock in a comparing search.
const MAX_ITERATIONS_BETWEEN_CHECKS: usize = 16 * 100;

fn assert_true(arm: &Arm, goal: &Placement<f64>, solution: &Solution) {
    assert!(within_limits(arm, &solution.q));
    let found = arm.base_from_tool(&solution.q).unwrap();
    let (metres, radians) = apart(&from_placement(&found), &from_placement(goal));
    let task = solution.tasks().next().unwrap();
    assert!((task.position_error().unwrap() - metres).abs() < 1e-12);
    if let Some(error) = task.orientation_error().filter(|_| radians < 3.0) {
        assert!((error - radians).abs() < 1e-7, "{error} {radians}");
    }
    // An interrupted comparison ends by the time limit, reached or not.
    match solution.termination {
        Termination::TimeLimit => {}
        ended => assert_eq!(solution.reached, ended == Termination::Reached),
    }
}

/// Solves with a time limit of zero.
fn ends_at_once(what: &str, builder: ArmBuilder<'_>, most_iterations: usize) {
    let arm = builder.with_time_limit(Duration::ZERO).with_atlas(false);
    let arm = arm.build().unwrap();
    let n = arm.joint_count();
    let mut random = Random::split_mix(61);
    let (mut goals, mut starts) = (Vec::new(), Vec::new());
    for k in 0..12 {
        let mut goal = arm.base_from_tool(&random.configuration(&arm)).unwrap();
        if k % 3 == 0 {
            goal.translation.x += 4.0;
        }
        let start = random.configuration(&arm);
        let solution = arm.solve(goal, &start).unwrap();
        assert_true(&arm, &goal, &solution);
        let ended = solution.termination;
        assert!(
            solution.reached || ended == Termination::TimeLimit,
            "{what}: {ended:?}"
        );
        assert!(k % 3 > 0 || !solution.reached);
        let iterations = solution.iterations;
        assert!(
            iterations <= most_iterations,
            "{what}: {iterations} iterations"
        );
        goals.push(goal);
        starts.extend(start);
    }
    let together = arm.solve_batch(&goals, &starts).unwrap();
    let path = arm.track(&goals, &starts[..n]).unwrap();
    for (solution, goal) in together
        .iter()
        .chain(&path.report)
        .zip(goals.iter().chain(&goals))
    {
        assert_true(&arm, goal, solution);
        let ended = solution.termination;
        assert!(
            solution.reached || ended == Termination::TimeLimit,
            "{what}: {ended:?}"
        );
    }
}

#[test]
fn zero_time_ends_every_search() {
    let (robot, base, tip) = panda();
    let builder = || Arm::builder(&robot, base, tip);
    ends_at_once("start", builder(), LOCK_STEP);
    ends_at_once("first", builder().with_search(Search::First), LOCK_STEP);
    ends_at_once(
        "bounded moves",
        builder().with_max_move(&[0.5; 7]),
        LOCK_STEP,
    );
    ends_at_once("posture", builder().with_posture(&[0.3; 7]), LOCK_STEP);
    let nearest = builder().with_search(Search::Nearest);
    ends_at_once(
        "nearest",
        nearest,
        MAX_ITERATIONS_BETWEEN_CHECKS + LOCK_STEP,
    );
    let mut free = builder()
        .with_goal(PoseBounds::position())
        .with_atlas(false);
    free = free.with_time_limit(Duration::ZERO);
    let solution = free
        .build()
        .unwrap()
        .solve(Placement::identity(), &[0.3; 7]);
    assert!(solution.unwrap().iterations <= LOCK_STEP);
}

/// Solutions of interrupted comparisons say so; with enough time none does.
#[test]
fn interrupted_comparison_is_reported() {
    let (robot, base, tip) = panda();
    let builder = || {
        let builder = Arm::builder(&robot, base, tip).with_search(Search::Nearest);
        builder.with_atlas(false)
    };
    let hurried = builder().with_time_limit(Duration::ZERO).build().unwrap();
    let patient = builder().build().unwrap();
    let mut random = Random::split_mix(63);
    let (mut reported, cases) = (0, case_count(8, 4));
    for case in 0..cases {
        let at_goal = random.configuration(&patient);
        let goal = patient.base_from_tool(&at_goal).unwrap();
        // Without time only a search that starts at the goal reaches it.
        let start = match case % 2 {
            0 => at_goal,
            _ => random.configuration(&patient),
        };
        let solution = hurried.solve(goal, &start).unwrap();
        assert_eq!(solution.termination, Termination::TimeLimit);
        let words = solution.explain();
        assert_eq!(
            solution.reached,
            words.contains("search for other solutions"),
            "{words}"
        );
        reported += usize::from(solution.reached);
        let solution = patient.solve(goal, &start).unwrap();
        assert!(solution.reached && solution.termination == Termination::Reached);
    }
    assert!(2 * reported >= cases, "{reported}");
}

/// A batch gives each problem no more time than a single solve.
#[test]
fn zero_time_applies_to_each_batch_problem() {
    let (robot, base, tip) = panda();
    let arm = Arm::builder(&robot, base, tip).with_time_limit(Duration::ZERO);
    let arm = arm.with_atlas(false).build().unwrap();
    let mut random = Random::split_mix(64);
    let (mut goals, mut starts) = (Vec::new(), Vec::new());
    for _ in 0..8 {
        let goal = random.configuration(&arm);
        goals.push(arm.base_from_tool(&goal).unwrap());
        starts.extend(random.configuration(&arm));
    }
    let together = arm.solve_batch(&goals, &starts).unwrap();
    let alone = goals.iter().zip(starts.chunks(arm.joint_count()));
    let alone = alone.map(|(goal, start)| arm.solve(*goal, start).unwrap());
    let mut cut = 0;
    for (one, of_batch) in alone.zip(&together) {
        assert_eq!((&one.q, one.reached), (&of_batch.q, of_batch.reached));
        cut += usize::from(!one.reached);
    }
    assert!(cut > 0);
}

#[test]
fn zero_time_ends_a_mimic_chain_search() {
    let robot = robot("aldebaran_nao");
    let builder = || Arm::builder(&robot, "torso", "right_sole");
    ends_at_once("follower", builder(), LOCK_STEP);
    ends_at_once(
        "follower nearest",
        builder().with_search(Search::Nearest),
        MAX_ITERATIONS_BETWEEN_CHECKS,
    );
}

#[test]
fn unmet_time_limit_changes_nothing() {
    let (robot, base, tip) = panda();
    for search in [Search::Start, Search::First, Search::Nearest] {
        let builder = || Arm::builder(&robot, base, tip).with_search(search);
        let plain = builder().with_atlas(false).build().unwrap();
        for limit in [Duration::from_secs(86400), Duration::MAX] {
            let limited = builder().with_atlas(false).with_time_limit(limit);
            let limited = limited.build().unwrap();
            let mut random = Random::split_mix(62);
            for _ in cases(6, 2) {
                let goal = plain.base_from_tool(&random.configuration(&plain)).unwrap();
                let start = random.configuration(&plain);
                let (a, b) = (plain.solve(goal, &start), limited.solve(goal, &start));
                assert_eq!(a.unwrap().q, b.unwrap().q);
            }
        }
    }
}
