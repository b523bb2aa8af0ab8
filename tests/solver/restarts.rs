//! Promise: restarts are numbered and seeded. The first attempt is the caller's start. All others are within bounds and
//! depend on the seed and their number only. The lowest success is returned.

use std::f64::consts::PI;
use std::ops::ControlFlow;

use kinopt::ik::Restarts;
use kinopt::model::Model;
use kinopt::problem::{Preferences, Problem};
use kinopt::solver::{Iteration, Stopping};
use kinopt::task::{Point, Posture, Task};
use kinopt::{Solver, Workspace};
use support::fault_tables::ExpectedError;
use support::random::Random;
use support::trees::RandomTree;

/// Starts of all attempts for an unreachable target.
fn attempts(model: &Model, seed: u64, attempts: usize, start: &[f64]) -> Vec<Vec<f64>> {
    let mut builder = Problem::builder(model);
    for frame in model.frame_ids() {
        builder.add(Point::new(frame, [1e3, 2e3, 3e3]));
    }
    let problem = builder.build().unwrap();
    let solver = Solver::default()
        .with_stopping(Stopping::default().with_max_iterations(1))
        .with_restarts(Restarts::default().with_attempts(attempts).with_seed(seed));
    let mut seen = Vec::new();
    let mut watch = |iteration: &Iteration<'_>| {
        if iteration.index == 0 {
            seen.push(iteration.x.to_vec());
        }
        ControlFlow::Continue(())
    };
    let mut workspace = Workspace::new();
    let solution = solver
        .solve_observed(&problem, start, &mut workspace, &mut watch)
        .unwrap();
    assert_eq!(solution.attempts, attempts);
    seen
}

#[test]
fn starts_lie_within_bounds() {
    for seed in 0..5 {
        let tree = RandomTree::new(seed, 12);
        let start = tree.configuration(&mut Random::new(seed));
        let all = attempts(&tree.model, seed, 32, &start);
        assert_eq!(all[0], start);
        for x in &all {
            for ((value, from), limits) in x.iter().zip(&start).zip(tree.model.limits()) {
                assert!(limits.contains(*value));
                // Continuous joints are sampled over two turns.
                let finite = limits.lower.is_finite();
                assert!(finite || (value - from).abs() <= 2.0 * PI + 1e-12);
            }
        }
        // The whole range is sampled.
        let joint = tree
            .model
            .limits()
            .position(|l| l.lower.is_finite())
            .unwrap();
        let limits = tree.model.limits().nth(joint).unwrap();
        let range = limits.upper - limits.lower;
        let values = all
            .iter()
            .step_by(2)
            .map(|x| (x[joint] - limits.lower) / range);
        let (low, high) = values.fold((1.0, 0.0), |(l, h): (f64, f64), v| (l.min(v), h.max(v)));
        assert!(low < 0.25 && high > 0.75, "{low} to {high}");
    }
}

#[test]
fn starts_depend_on_seed_and_number_only() {
    let tree = RandomTree::new(3, 10);
    let start = tree.configuration(&mut Random::new(3));
    let few = attempts(&tree.model, 7, 5, &start);
    let many = attempts(&tree.model, 7, 20, &start);
    assert_eq!(few[..], many[..5]);
    let other = attempts(&tree.model, 8, 5, &start);
    assert_eq!(few[0], other[0]);
    for k in 1..5 {
        assert_ne!(few[k], other[k]);
        assert_ne!(many[k], many[k + 1]);
    }
    // Even attempts are sampled from the whole box, independent of the caller's start.
    let other_q = tree.configuration(&mut Random::new(99));
    let moved = attempts(&tree.model, 7, 5, &other_q);
    let bounded: Vec<usize> = (0..start.len())
        .filter(|&c| tree.model.limits().nth(c).unwrap().upper.is_finite())
        .collect();
    for k in [2, 4] {
        for &c in &bounded {
            assert!((few[k][c] - moved[k][c]).abs() < 1e-12);
        }
    }
}

#[test]
fn lowest_success_is_returned() {
    // Two branches reach the target; the start of an attempt selects one.
    let links = [1.0, 1.0];
    let model = support::planar_arm(&links, Some((-3.0, 3.0)));
    let tip = model.frame("tip").unwrap();
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(tip, [-0.5, 0.0, 0.0]));
    let problem = builder.build().unwrap();
    let mut answers = Vec::new();
    for seed in 0..12 {
        let with = |attempts| {
            let restarts = Restarts::default()
                .with_seed(seed)
                .with_attempts(attempts)
                .with_agreeing(99);
            let solver = Solver::default().with_restarts(restarts);
            solver.solve_once(&problem, &[0.0, 0.0]).unwrap()
        };
        let full = with(32);
        assert!(full.reached && full.attempts > 1);
        // No attempt follows the first success, and none before it succeeds.
        let exact = with(full.attempts);
        assert_eq!(exact.q, full.q);
        assert_eq!(exact.attempts, full.attempts);
        assert!(!with(full.attempts - 1).reached);
        answers.push(full.q[1] > 0.0);
    }
    let up = answers.iter().filter(|&&a| a).count();
    assert!(
        up > 0 && up < answers.len(),
        "the seed must matter: {answers:?}"
    );
}

#[test]
fn best_miss_is_returned() {
    let tree = RandomTree::new(5, 10);
    let start = tree.configuration(&mut Random::new(5));
    let mut builder = Problem::builder(&tree.model);
    builder.add(Point::new(tree.far_frame(), [9.0, 9.0, 9.0]));
    builder.add(Task::new(Posture::new(&tree.model, &start)).preference());
    builder.preferences(Preferences::Traded);
    let problem = builder.build().unwrap();
    let mut last = f64::INFINITY;
    for attempts in 1..8 {
        let restarts = Restarts::default()
            .with_attempts(attempts)
            .with_agreeing(99);
        let solver = Solver::default()
            .with_stopping(Stopping::default().with_max_iterations(6))
            .with_restarts(restarts);
        let solution = solver.solve_once(&problem, &start).unwrap();
        assert_eq!(solution.attempts, attempts);
        assert!(solution.cost <= last);
        last = solution.cost;
    }
}

#[test]
fn agreeing_misses_end_the_search() {
    let model = support::planar_arm(&[1.0, 1.0], Some((-1.0, 1.0)));
    let tip = model.frame("tip").unwrap();
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(tip, [5.0, 0.0, 0.0]));
    let problem = builder.build().unwrap();
    let mut last = 1;
    for agreeing in [1, 2, 5] {
        let solver = Solver::default().with_restarts(Restarts::default().with_agreeing(agreeing));
        let solution = solver.solve_once(&problem, &[0.3, 0.2]).unwrap();
        // Attempts that stall are not counted; converged ones are, so more attempts are made.
        assert!(solution.attempts >= last && solution.attempts < 32);
        assert!((solution.q[0].hypot(solution.q[1])) < 1e-6, "stretched out");
        last = solution.attempts;
    }
    let none = Solver::default().with_restarts(Restarts::none());
    assert_eq!(none.solve_once(&problem, &[0.3, 0.2]).unwrap().attempts, 1);
}

#[test]
fn joints_without_influence_keep_their_values() {
    // Two arms on one base: only the right one has a target, which is unreachable.
    let rig = support::bones::RandomRig::new(11);
    let model = rig.skeleton.model();
    let tip = rig.tips[2];
    let mut builder = Problem::builder(model);
    builder.add(Point::new(rig.skeleton.tip(tip), [90.0, 80.0, 70.0]));
    let problem = builder.build().unwrap();
    let mut chain = Vec::new();
    let mut bone = Some(tip);
    while let Some(id) = bone {
        chain.push(id);
        bone = rig.skeleton.bones()[id.index()].parent;
    }
    let start = support::trees::configuration_of(model, &mut Random::new(4));
    let solution = Solver::default().solve_once(&problem, &start).unwrap();
    assert!(!solution.reached && solution.attempts > 4);
    for (k, (q, from)) in solution.q.iter().zip(&start).enumerate() {
        let felt = chain.iter().any(|id| id.index() == k / 3);
        assert!(felt || q == from, "angle {k} moved from {from} to {q}");
    }
}

#[test]
fn requested_number_of_attempts_is_made() {
    // The target is unreachable, so only the option ends the search.
    let rig = support::bones::RandomRig::new(6);
    let model = rig.skeleton.model();
    let problem = rig.drawn_to(|| [9.0, -8.0, 7.0]);
    for attempts in [1, 2, 7, 32, 150] {
        let restarts = Restarts::default().with_attempts(attempts);
        let solver = Solver::default().with_restarts(restarts);
        let solution = solver.solve_once(&problem, &model.neutral()).unwrap();
        assert_eq!(solution.attempts, attempts);
    }
}

#[test]
fn miss_costs_as_much_as_a_few_attempts() {
    // Of 32 attempts only the best and the first converge fully.
    for seed in [3, 6, 8] {
        let rig = support::bones::RandomRig::new(seed);
        let model = rig.skeleton.model();
        let mut builder = Problem::builder(model);
        let at_ease = rig.skeleton.pose(&model.neutral()).unwrap();
        for (k, &tip) in rig.tips.iter().enumerate() {
            let tip_position = at_ease.tip(&rig.skeleton, tip).unwrap();
            let distance = if k == 1 { 3.0 } else { 0.0 };
            let aside = kinopt::spatial::Vector3::new(distance, 0.5 * distance, 0.2 * distance);
            builder.add(Point::new(rig.skeleton.tip(tip), tip_position + aside));
        }
        let problem = builder.build().unwrap();
        let evaluations = |solver: &Solver| {
            let solution = solver.solve_once(&problem, &model.neutral()).unwrap();
            assert!(!solution.reached);
            let counts = solution.counts;
            (
                counts.residuals + counts.jacobians + counts.gradients,
                solution.cost,
            )
        };
        let (once, alone) = evaluations(&Solver::default().with_restarts(Restarts::none()));
        let (all, best) = evaluations(&Solver::default());
        assert!(best <= alone * (1.0 + 1e-3));
        assert!(all < 20 * once.max(60), "{seed}: {all} after {once}");
    }
}

/// Both elbow branches are equally near an out-of-plane target; the start's branch is kept.
#[test]
fn earliest_of_equal_misses_is_kept() {
    let model = support::planar_arm(&[1.0, 0.8], None);
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(model.frame("tip").unwrap(), [0.9, 0.7, 0.5]));
    let problem = builder.build().unwrap();
    let solver = |attempts: usize| {
        let restarts = Restarts::default().with_attempts(attempts);
        Solver::default().with_restarts(restarts.with_agreeing(attempts))
    };
    for seed in 0..8 {
        let mut random = Random::new(seed);
        let elbow = if seed % 2 == 0 { 1.0 } else { -1.0 };
        let start = [random.within(-0.5, 0.5), elbow * random.within(0.8, 1.5)];
        let alone = solver(1).solve_once(&problem, &start).unwrap();
        let among = solver(12).solve_once(&problem, &start).unwrap();
        assert!(!among.reached && among.attempts > 3);
        for (a, b) in alone.q.iter().zip(&among.q) {
            assert!(
                (a - b).abs() < 1e-4,
                "{start:?}: {:?} {:?}",
                alone.q,
                among.q
            );
        }
    }
}

/// One joint whose target is behind it: limits at −1 and slightly beyond 1, the latter nearer by the difference.
fn behind(upper: f64) -> Problem {
    let mut builder = kinopt::Model::builder("one joint");
    let axis = kinopt::spatial::Vector3::new(0.0, 0.0, 1.0);
    let at = kinopt::spatial::Placement::identity();
    let limits = kinopt::model::Limits::new(-1.0, upper);
    let joint = builder.revolute("joint", None, at, axis, limits);
    let link = kinopt::spatial::Placement::translation([1.0, 0.0, 0.0].into());
    let tip = builder.frame("tip", Some(joint), link);
    let model = builder.build().unwrap();
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(tip, [-1.0, 0.0, 0.0]));
    builder.build().unwrap()
}

/// Another attempt replaces the start's own end only if it lowers the cost by a thousandth, also if the start converged
/// slowly.
#[test]
fn start_miss_is_kept_unless_another_is_better() {
    for start in [-0.5, -1e-4] {
        let solve = |upper: f64| {
            let problem = behind(upper);
            Solver::default().solve_once(&problem, &[start]).unwrap()
        };
        let nearly = solve(1.0005);
        assert!(!nearly.reached && nearly.q == [-1.0], "{start}: {nearly:?}");
        let better = solve(1.01);
        assert!(!better.reached && better.q == [1.01], "{start}: {better:?}");
    }
}

/// Misses within a thousandth of the cost agree.
#[test]
fn nearly_equal_misses_agree() {
    for (upper, all) in [(1.0005, true), (1.01, false)] {
        let problem = behind(upper);
        let solution = Solver::default().solve_once(&problem, &[0.5]).unwrap();
        let most = 3 * solution.attempts / 4;
        assert_eq!(solution.attempts, 32);
        assert_eq!(solution.agreeing > most, all, "{}", solution.agreeing);
    }
}

/// The tolerance of agreement that ends a search is that of the reported number.
#[test]
fn agreement_ends_at_the_reported_number() {
    let problem = behind(1.0005);
    let restarts = Restarts::default().with_attempts(256).with_agreeing(9);
    let solver = Solver::default().with_restarts(restarts);
    let solution = solver.solve_once(&problem, &[0.5]).unwrap();
    assert!(solution.agreeing >= 9 && solution.q == [1.0005]);
    // Every second attempt counts.
    assert!(solution.attempts <= 18, "{} attempts", solution.attempts);
}

/// After the given number of steps one more attempt is made, from the best one's end.
#[test]
fn total_steps_of_attempts_are_bounded() {
    let rig = support::bones::RandomRig::new(6);
    let problem = rig.drawn_to(|| [9.0, -8.0, 7.0]);
    let start = rig.skeleton.model().neutral();
    for (steps, attempts) in [(1, 1..=2), (30, 2..=12), (usize::MAX, 32..=33)] {
        let restarts = Restarts::default().with_steps(steps);
        let solver = Solver::default().with_restarts(restarts);
        let made = solver.solve_once(&problem, &start).unwrap().attempts;
        assert!(attempts.contains(&made), "{steps} steps: {made} attempts");
    }
}

/// Perturbed starts fall into the minimum of the start, so their agreement is not counted.
#[test]
fn only_independent_starts_agree() {
    for seed in 0..12 {
        let problem = behind(1.2);
        let restarts = Restarts::default().with_agreeing(2).with_seed(seed);
        let solver = Solver::default().with_restarts(restarts);
        let solution = solver.solve_once(&problem, &[-0.9]).unwrap();
        assert!(solution.attempts > 2, "{seed}: {}", solution.attempts);
    }
}

/// Continuous joints start within half a turn of the caller's start, at any number of turns.
#[test]
fn continuous_joints_start_near_the_given_start() {
    let model = support::planar_arm(&[1.0, 0.5], None);
    let start = [100.0, -50.0];
    let all = attempts(&model, 3, 9, &start);
    for x in &all[1..] {
        for (value, from) in x.iter().zip(&start) {
            assert!((value - from).abs() <= PI, "{value} from {from}");
        }
    }
    let furthest = all.iter().map(|x| (x[0] - start[0]).abs());
    assert!(furthest.fold(0.0, f64::max) > 0.5);
}

/// The best attempt agrees with itself, so `agreeing` below 1 is rejected. The search continues until one attempt has
/// converged.
#[test]
fn at_least_one_attempt_converges() {
    let model = support::planar_arm(&[1.0, 0.7, 0.4], Some((-1.0, 1.0)));
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(model.frame("tip").unwrap(), [1.5, 3.0, 0.0]));
    let problem = builder.build().unwrap();
    let mut later = 0;
    for limit in 1..12 {
        let [none, one] = [0, 1].map(|agreeing| {
            let solver = Solver::default()
                .with_stopping(Stopping::default().with_max_iterations(limit))
                .with_restarts(Restarts::default().with_agreeing(agreeing));
            solver.solve_once(&problem, &[-0.9, 0.8, -0.9])
        });
        none.says("agreeing");
        later += usize::from(one.unwrap().attempts > 1);
    }
    assert!(later > 2, "{later}");
}
