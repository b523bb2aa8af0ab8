//! Promise: equal input gives bitwise equal results: in repeated runs, with another equal arm, alone and in batches,
//! and with 1, 2 and 8 threads.

use kinopt::arm::{Arm, ArmBuilder, PoseBounds, PoseOutcome, Search};
use kinopt::problem::{Preferences, Problem};
use kinopt::spatial::Placement;
use kinopt::task::{Point, Posture};
use kinopt::{Solution, Solver};
use rayon::prelude::*;
use support::arms::{panda, robot};
use support::random::{Random, case_count, part};

type Queries = (Vec<Placement<f64>>, Vec<f64>);

/// Contents of a solution except times.
fn bits(solutions: &[Solution]) -> Vec<u64> {
    let numbers = solutions.iter().flat_map(|s| {
        let counts = [s.iterations as u64, s.attempts as u64, s.cost.to_bits()];
        s.q.iter().map(|v| v.to_bits()).chain(counts)
    });
    numbers.collect()
}

fn questions(arm: &Arm, count: usize) -> Queries {
    let mut random = Random::split_mix(8);
    let mut goals: Vec<_> = (0..count)
        .map(|_| arm.base_from_tool(&random.configuration(arm)).unwrap())
        .collect();
    // One target is unreachable in all cases.
    goals[1].translation.x += 5.0;
    let starts = (0..count).flat_map(|_| random.configuration(arm));
    (goals, starts.collect())
}

fn single_solves(arm: &Arm, (goals, starts): &Queries) -> Vec<Solution> {
    let starts = starts.chunks(arm.joint_count());
    let questions = goals.iter().zip(starts);
    questions
        .map(|(goal, start)| arm.solve(goal, start).unwrap())
        .collect()
}

/// `count` problems: more than a chunk of a batch if the SIMD solver handles them.
fn assert_bitwise_equal(builder: &ArmBuilder<'_>, count: usize) {
    let arm = builder.clone().build().unwrap();
    let n = arm.joint_count();
    let queries = questions(&arm, count);
    let (goals, starts) = &queries;
    let singles = single_solves(&arm, &queries);
    let together = arm.solve_batch(goals, starts).unwrap();
    assert!(!together[1].reached && !singles[1].reached);
    // Repeated, and with a separate arm.
    let again = builder.clone().build().unwrap();
    assert_eq!(bits(&single_solves(&again, &queries)), bits(&singles));
    assert_eq!(
        bits(&again.solve_batch(goals, starts).unwrap()),
        bits(&together)
    );
    let flat: Vec<u64> = together
        .iter()
        .flat_map(|s| &s.q)
        .map(|v| v.to_bits())
        .collect();
    for threads in part([8, 1, 2], 2) {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let parallel = arm.solve_batch_parallel(goals, starts).unwrap();
            assert_eq!(bits(&parallel), bits(&together), "{threads} threads");
            let mut q = vec![0.0; starts.len()];
            let mut outcomes = vec![PoseOutcome::default(); count];
            arm.solve_batch_into_parallel(goals, starts, &mut q, &mut outcomes)
                .unwrap();
            assert!(q.iter().map(|v| v.to_bits()).eq(flat.iter().copied()));
            assert!(
                outcomes
                    .iter()
                    .zip(&together)
                    .all(|(a, b)| a.reached == b.reached)
            );
            // Single solves of one arm from all threads at once.
            let questions = goals.par_iter().zip(starts.par_chunks(n));
            let results = questions.map(|(goal, start)| arm.solve(goal, start).unwrap());
            let results: Vec<Solution> = results.collect();
            assert_eq!(bits(&results), bits(&singles), "{threads} threads");
        });
    }
}

#[test]
fn common_searches_are_reproducible() {
    let (robot, base, tip) = panda();
    for search in [Search::Start, Search::First] {
        let builder = Arm::builder(&robot, base, tip);
        let fewer = case_count(140, 12);
        // More than a chunk of a batch, for one search at least.
        let first = search == Search::First;
        let count = if first { 140 } else { fewer };
        assert_bitwise_equal(&builder.with_search(search).with_atlas(first), count);
    }
    let six = self::robot("universal_ur5e");
    let builder = Arm::builder(&six, "base", "flange");
    assert_bitwise_equal(&builder, case_count(140, 12));
}

#[test]
fn comparing_searches_are_reproducible() {
    let (robot, base, tip) = panda();
    let builder = Arm::builder(&robot, base, tip);
    let builder = builder.with_search(Search::Nearest).with_attempts(30);
    assert_bitwise_equal(&builder.with_atlas(false), case_count(5, 2));
}

#[test]
fn general_solver_options_are_reproducible() {
    let (robot, base, tip) = panda();
    let builder = || Arm::builder(&robot, base, tip).with_atlas(false);
    assert_bitwise_equal(&builder().with_posture(&[0.3; 7]), case_count(6, 2));
    assert_bitwise_equal(&builder().with_max_move(&[0.5; 7]), case_count(6, 2));
    let goal = PoseBounds::within([0.01, 0.0, 0.0, 0.2, 0.0, 0.3]);
    assert_bitwise_equal(&builder().with_goal(goal).with_seed(5), case_count(6, 2));
}

#[test]
fn mimic_chain_is_reproducible() {
    let robot = robot("aldebaran_nao");
    let builder = Arm::builder(&robot, "left_sole", "right_sole");
    assert_bitwise_equal(&builder.with_atlas(false), case_count(6, 2));
}

#[test]
fn solve_all_and_track_are_reproducible() {
    let (robot, base, tip) = panda();
    let arm = Arm::builder(&robot, base, tip).with_atlas(false);
    let arm = arm.build().unwrap();
    let (goals, starts) = questions(&arm, case_count(6, 3));
    let path: Vec<_> = (0..case_count(40, 20))
        .map(|k| {
            let s = k as f64 * 0.02;
            let q = [0.1 + s, -0.4, 0.2, -1.8 + s, 0.3, 1.7, 0.5 - s];
            arm.base_from_tool(&q).unwrap()
        })
        .collect();
    let run = || {
        let all = goals.iter().zip(starts.chunks(7));
        let all: Vec<u64> = all
            .flat_map(|(goal, start)| arm.solve_all_from(goal, start).unwrap().solutions)
            .flat_map(|solution| solution.q)
            .map(f64::to_bits)
            .collect();
        (all, bits(&arm.track(&path, &starts[..7]).unwrap().report))
    };
    let once = run();
    for threads in part([8, 1, 2], 2) {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let runs: Vec<_> = pool
            .build()
            .unwrap()
            .install(|| (0..2).into_par_iter().map(|_| run()).collect());
        assert!(runs.iter().all(|bits| *bits == once));
    }
}

/// A reused solution keeps nothing of the previous problem, of the same arm or another.
#[test]
fn reused_solution_keeps_nothing() {
    let (robot, base, tip) = panda();
    let plain = Arm::builder(&robot, base, tip)
        .with_atlas(false)
        .with_attempts(8);
    let arms = [
        plain.clone(),
        plain.clone().with_max_move(&[0.05; 7]),
        plain
            .clone()
            .with_search(Search::Nearest)
            .with_goal(PoseBounds::position()),
    ];
    let arms = arms.map(|arm| arm.build().unwrap());
    let mut queries = Vec::new();
    for arm in &arms {
        let (goals, starts) = questions(arm, 3);
        for (goal, start) in goals.into_iter().zip(starts.chunks(7)) {
            let reported = arm.solve(goal, start).unwrap();
            queries.push((arm, goal, start.to_vec(), format!("{reported:?}")));
        }
        // A target at the arm's base, blocked by limits.
        let start = vec![0.1; 7];
        let turned = arm.base_from_tool(&start).unwrap().rotation;
        let low = Placement::new(turned, [-0.1, 0.0, 0.1].into());
        let reported = arm.solve(low, &start).unwrap();
        queries.push((arm, low, start, format!("{reported:?}")));
    }
    // A solver's solution whose soft task displaced its required task.
    let model = robot.model();
    let mut builder = Problem::builder(model);
    builder.add(Point::new(model.frame(tip).unwrap(), [0.4, 0.3, 0.5]));
    builder.add(Posture::new(model, &model.neutral()));
    builder.preferences(Preferences::Traded);
    let pulled = builder.build().unwrap();
    let pulled = Solver::default().solve_once(&pulled, &model.neutral());
    let pulled = pulled.unwrap();
    assert!(pulled.pulling_preferences().next().is_some());
    for (other, goal, start, expected) in &queries {
        let mut solution = pulled.clone();
        other.solve_into(goal, start, &mut solution).unwrap();
        assert_eq!(format!("{solution:?}"), *expected);
    }
    for (arm, goal, start, _) in &queries {
        for (other, goal_of_other, start_of_other, expected) in &queries {
            let mut solution = Solution::default();
            arm.solve_into(goal, start, &mut solution).unwrap();
            other
                .solve_into(goal_of_other, start_of_other, &mut solution)
                .unwrap();
            assert_eq!(format!("{solution:?}"), *expected);
        }
    }
}
