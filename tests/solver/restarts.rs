//! Promise: restarts are numbered and seeded: the first attempt is the caller's start, every other
//! lies within the bounds and depends on the seed and its number alone, the lowest success wins.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::PI;
use std::ops::ControlFlow;

use kinopt::ik::Restarts;
use kinopt::model::Model;
use kinopt::problem::{Preferences, Problem};
use kinopt::solver::{Iteration, Stopping};
use kinopt::task::{Point, Posture, Task};
use kinopt::{Solver, Workspace};
use support::random::Random;
use support::trees::RandomTree;

/// Where every attempt starts, for a target that none of them reaches.
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
fn starts_lie_within_bounds_and_unbounded_joints_near_the_start() {
    for seed in 0..5 {
        let tree = RandomTree::new(seed, 12);
        let start = tree.configuration(&mut Random::new(seed));
        let all = attempts(&tree.model, seed, 32, &start);
        assert_eq!(all[0], start);
        for x in &all {
            for ((value, from), limits) in x.iter().zip(&start).zip(tree.model.limits()) {
                assert!(limits.contains(*value));
                // A continuous joint is drawn over two turns, not over infinity.
                let finite = limits.lower.is_finite();
                assert!(finite || (value - from).abs() <= 2.0 * PI + 1e-12);
            }
        }
        // Whole ranges are drawn from, not their middles.
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
fn starts_depend_on_seed_and_number_alone() {
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
    // Even attempts are drawn over the whole box, wherever the caller's start is.
    let elsewhere = tree.configuration(&mut Random::new(99));
    let moved = attempts(&tree.model, 7, 5, &elsewhere);
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
fn the_lowest_success_wins() {
    // Two elbow poses reach the target; which one depends on where an attempt starts.
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
        // Nothing after the first success, and nothing before it succeeds.
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
fn the_best_miss_is_returned() {
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
fn attempts_that_agree_on_a_miss_end_the_search() {
    let model = support::planar_arm(&[1.0, 1.0], Some((-1.0, 1.0)));
    let tip = model.frame("tip").unwrap();
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(tip, [5.0, 0.0, 0.0]));
    let problem = builder.build().unwrap();
    let mut last = 1;
    for agreeing in [1, 2, 5] {
        let solver = Solver::default().with_restarts(Restarts::default().with_agreeing(agreeing));
        let solution = solver.solve_once(&problem, &[0.3, 0.2]).unwrap();
        // Quick attempts that stall say nothing; those that end do, and more are asked for.
        assert!(solution.attempts >= last && solution.attempts < 32);
        assert!((solution.q[0].hypot(solution.q[1])) < 1e-6, "stretched out");
        last = solution.attempts;
    }
    let none = Solver::default().with_restarts(Restarts::none());
    assert_eq!(none.solve_once(&problem, &[0.3, 0.2]).unwrap().attempts, 1);
}

#[test]
fn what_no_task_feels_stays() {
    // Two arms on one base; only the right one has a target, and one out of reach.
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
fn as_many_attempts_are_made_as_asked_for() {
    // Out of reach: nothing but the option ends the search.
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
fn a_miss_costs_no_more_than_a_few_attempts() {
    // 32 attempts, but only the best and the start's own go to their ends.
    for seed in [3, 6, 8] {
        let rig = support::bones::RandomRig::new(seed);
        let model = rig.skeleton.model();
        let mut builder = Problem::builder(model);
        let at_ease = rig.skeleton.pose(&model.neutral()).unwrap();
        for (k, &tip) in rig.tips.iter().enumerate() {
            let place = at_ease.tip(&rig.skeleton, tip).unwrap();
            let far = if k == 1 { 3.0 } else { 0.0 };
            let aside = kinopt::spatial::Vector3::new(far, 0.5 * far, 0.2 * far);
            builder.add(Point::new(rig.skeleton.tip(tip), place + aside));
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

#[test]
fn a_restart_that_is_hardly_better_does_not_win() {
    // Two arms from one trunk that reach in vain to the left and to the right: mirror images.
    use kinopt::spatial::{Placement, Vector3};
    let mut builder = Model::builder("two arms");
    let [x, y, z] = Vector3::UNITS;
    let limits = kinopt::model::Limits::new(-1.5, 1.5);
    let here = Placement::identity();
    let trunk = builder.revolute("trunk", None, here, z, limits);
    let chest = builder.revolute("chest", Some(trunk), Placement::translation(y), z, limits);
    let mut tips = Vec::new();
    for (side, out) in [("left", -x), ("right", x)] {
        let at = Placement::translation(out * 0.2);
        let upper = builder.revolute(format!("{side} shoulder"), Some(chest), at, z, limits);
        let at = Placement::translation(out);
        let fore = builder.revolute(format!("{side} elbow"), Some(upper), at, z, limits);
        tips.push(builder.frame(side, Some(fore), at));
    }
    let model = builder.build().unwrap();
    for height in [0.5, 1.0, 2.0, 4.0] {
        let mut tasks = Problem::builder(&model);
        for (&tip, side) in tips.iter().zip([-1.0, 1.0]) {
            tasks.add(Point::new(tip, [3.0 * side, height, 0.0]));
        }
        let problem = tasks.build().unwrap();
        for seed in 0..4 {
            let restarts = Restarts::default().with_seed(seed);
            let solver = Solver::default().with_restarts(restarts);
            let q = solver.solve_once(&problem, &[0.0; 6]).unwrap().q;
            for (what, sum) in [
                ("trunk", q[0]),
                ("chest", q[1]),
                ("shoulders", q[2] + q[4]),
                ("elbows", q[3] + q[5]),
            ] {
                assert!(sum.abs() < 1e-3, "{height}, {seed}: {what} {sum}, {q:?}");
            }
        }
    }
}

/// Both elbows come equally near to a target off the plane: the one on the start's side stays.
#[test]
fn of_attempts_that_miss_alike_the_earliest_stays() {
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

/// One joint that cannot turn round to a target behind it: stops at −1 and a little beyond 1, the second
/// nearer to the target by that little.
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

/// What was not asked for does not happen for a hair's breadth: where another attempt misses by less than a
/// thousandth of the cost less, the start's own end is the answer, also where it took long to get there.
#[test]
fn the_start_s_own_miss_stays_unless_another_is_better() {
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
fn attempts_that_miss_by_nearly_the_same_agree() {
    for (upper, all) in [(1.0005, true), (1.01, false)] {
        let problem = behind(upper);
        let solution = Solver::default().solve_once(&problem, &[0.5]).unwrap();
        let most = 3 * solution.attempts / 4;
        assert_eq!(solution.attempts, 32);
        assert_eq!(solution.agreeing > most, all, "{}", solution.agreeing);
    }
}

/// The tolerance that ends a search is that of the number that a solution reports.
#[test]
fn agreeing_ends_at_the_reported_number() {
    let problem = behind(1.0005);
    let restarts = Restarts::default().with_attempts(256).with_agreeing(9);
    let solver = Solver::default().with_restarts(restarts);
    let solution = solver.solve_once(&problem, &[0.5]).unwrap();
    assert!(solution.agreeing >= 9 && solution.q == [1.0005]);
    // Every second attempt counts.
    assert!(solution.attempts <= 18, "{} attempts", solution.attempts);
}

/// After so many steps only one further attempt is made, from where the best one stands.
#[test]
fn steps_of_all_attempts_may_be_bounded() {
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

/// Nudged starts fall into the hole that the start is in, and that they agree says nothing.
#[test]
fn only_starts_from_elsewhere_agree() {
    for seed in 0..12 {
        let problem = behind(1.2);
        let restarts = Restarts::default().with_agreeing(2).with_seed(seed);
        let solver = Solver::default().with_restarts(restarts);
        let solution = solver.solve_once(&problem, &[-0.9]).unwrap();
        assert!(solution.attempts > 2, "{seed}: {}", solution.attempts);
    }
}

/// Joints without limits start within half a turn of where they stand, however far round that is.
#[test]
fn endless_joints_are_drawn_about_the_start() {
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

/// What all attempts took is told: no step without a residual.
#[test]
fn evaluations_of_all_attempts_are_counted() {
    let problem = behind(1.2);
    for attempts in [1, 4, 16] {
        let restarts = Restarts::default().with_attempts(attempts);
        let solver = Solver::default().with_restarts(restarts);
        let solution = solver.solve_once(&problem, &[0.3]).unwrap();
        assert_eq!(solution.attempts, attempts);
        let least = solution.iterations + attempts;
        assert!(solution.counts.residuals >= least, "{solution:?}");
        assert!(solution.counts.jacobians >= attempts, "{solution:?}");
    }
}

/// The best attempt agrees with itself, so that fewer are refused: the search goes on until one has come
/// to an end.
#[test]
fn at_least_one_attempt_comes_to_an_end() {
    let model = support::planar_arm(&[1.0, 0.7, 0.4], Some((-1.0, 1.0)));
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(model.frame("tip").unwrap(), [1.5, 3.0, 0.0]));
    let problem = builder.build().unwrap();
    let mut later = 0;
    for most in 1..12 {
        let [none, one] = [0, 1].map(|agreeing| {
            let solver = Solver::default()
                .with_stopping(Stopping::default().with_max_iterations(most))
                .with_restarts(Restarts::default().with_agreeing(agreeing));
            solver.solve_once(&problem, &[-0.9, 0.8, -0.9])
        });
        assert!(none.unwrap_err().to_string().contains("agreeing"));
        later += usize::from(one.unwrap().attempts > 1);
    }
    assert!(later > 2, "{later}");
}
