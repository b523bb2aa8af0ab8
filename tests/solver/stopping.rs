//! Promise: a search ends for the reason it reports: time, cancellation, iterations or success.

use std::ops::ControlFlow;
use std::time::Duration;

use kinopt::geometric::{Ccd, Geometric};
use kinopt::ik::{Drag, Restarts};
use kinopt::problem::{Preferences, Problem};
use kinopt::solver::{FirstStep, Iteration, ProjectedGradient, Stopping, Termination};
use kinopt::task::{Point, Posture};
use kinopt::{Solver, Workspace};
use support::methods::solvers;
use support::planar_arm;

const START: [f64; 3] = [0.3, 0.2, 0.1];

fn problem(target: [f64; 3]) -> Problem {
    let model = planar_arm(&[0.5, 0.4, 0.3], Some((-2.0, 2.0)));
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(model.frame("tip").unwrap(), target));
    builder.build().unwrap()
}

#[test]
fn zero_time_limit_ends_at_once() {
    for solver in solvers() {
        let solver = solver.with_stopping(Stopping::default().with_time_limit(Duration::ZERO));
        let solution = solver
            .solve_once(&problem([0.2, 0.7, 0.0]), &START)
            .unwrap();
        assert_eq!(solution.termination, Termination::TimeLimit);
        assert_eq!((solution.iterations, solution.attempts), (0, 1));
        assert_eq!(solution.q, START);
        assert!(!solution.reached);
        assert!(solution.explain().contains("time limit"));
    }
}

/// A drag's frame also ends, and keeps its configuration.
#[test]
fn drag_frame_reports_its_time_limit() {
    let stopping = Stopping::default().with_time_limit(Duration::ZERO);
    let start = [0.1, 0.2, 0.3];
    let drag = Drag::new(problem([0.2, 0.5, 0.0]), &start).unwrap();
    let mut drag = drag.with_solver(Solver::default(), stopping).unwrap();
    drag.advance();
    assert_eq!(drag.solution().termination, Termination::TimeLimit);
    assert!(!drag.solution().reached);
}

#[test]
fn huge_time_limit_is_no_limit() {
    for limit in [Duration::from_secs(3600), Duration::MAX] {
        let solver = Solver::default().with_stopping(Stopping::default().with_time_limit(limit));
        let solution = solver
            .solve_once(&problem([0.2, 0.7, 0.0]), &START)
            .unwrap();
        assert_eq!(solution.termination, Termination::Reached);
    }
}

#[test]
fn observer_cancels_the_search() {
    for solver in solvers() {
        for after in [0, 2] {
            let mut seen = Vec::new();
            let mut watch = |iteration: &Iteration<'_>| {
                seen.push((iteration.index, iteration.cost));
                if iteration.index == after {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            };
            let mut workspace = Workspace::new();
            let far_problem = problem([0.2, 0.7, 0.0]);
            let solution = solver
                .solve_observed(&far_problem, &START, &mut workspace, &mut watch)
                .unwrap();
            assert_eq!(
                solution.termination,
                Termination::Cancelled,
                "{}",
                solver.method()
            );
            assert_eq!((solution.iterations, solution.attempts), (after, 1));
            assert!(solution.explain().contains("observer"));
            let indices: Vec<usize> = seen.iter().map(|s| s.0).collect();
            assert_eq!(indices, (0..=after).collect::<Vec<_>>());
            let lowest = seen.iter().fold(f64::INFINITY, |m, s| m.min(s.1));
            assert_eq!(solution.cost, lowest, "the best seen is returned");
        }
    }
}

/// Observer that interrupts the second attempt, after the first converged: by cancellation or by exceeding the time
/// limit.
fn interrupt(cancels: bool) -> impl FnMut(&Iteration<'_>) -> ControlFlow<()> {
    let mut attempts = 0;
    move |iteration| {
        attempts += usize::from(iteration.index == 0);
        match (attempts, cancels) {
            (0 | 1, _) => ControlFlow::Continue(()),
            (_, true) => ControlFlow::Break(()),
            (_, false) => {
                std::thread::sleep(TIME_LIMIT);
                ControlFlow::Continue(())
            }
        }
    }
}

/// Enough for a first attempt on any machine.
const TIME_LIMIT: Duration = Duration::from_millis(400);

#[test]
fn interruption_of_a_later_attempt_is_reported() {
    let stopping = Stopping::default().with_time_limit(TIME_LIMIT);
    let unreachable_problem = problem([5.0, 0.0, 0.0]);
    let start = [0.0; 3];
    for (cancels, ended) in [
        (true, Termination::Cancelled),
        (false, Termination::TimeLimit),
    ] {
        let mut workspace = Workspace::new();
        // With a number of agreeing attempts, the first attempt does not end the search.
        let restarts = Restarts::default().with_agreeing(3);
        let solver = Solver::default().with_stopping(stopping);
        let solver = solver.with_restarts(restarts);
        let solution = solver
            .solve_observed(
                &unreachable_problem,
                &start,
                &mut workspace,
                &mut interrupt(cancels),
            )
            .unwrap();
        assert_eq!((solution.termination, solution.attempts), (ended, 2));
        // Stretched towards the target from the start: the first attempt is returned.
        assert_eq!(solution.q, start);

        let swept = Ccd::default().with_stopping(stopping);
        let swept = swept.with_restarts(restarts);
        let solution = swept
            .solve_observed(&unreachable_problem, &start, &mut interrupt(cancels))
            .unwrap();
        assert_eq!((solution.termination, solution.attempts), (ended, 2));
        assert_eq!(solution.q, start);
    }
}

#[test]
fn iteration_limit_applies_to_each_attempt() {
    for solver in solvers() {
        let solver = solver
            .with_stopping(Stopping::default().with_max_iterations(1))
            .with_restarts(Restarts::default().with_attempts(4));
        let solution = solver
            .solve_once(&problem([-0.3, -0.9, 0.0]), &START)
            .unwrap();
        assert!(!solution.reached);
        assert_eq!(solution.termination, Termination::IterationLimit);
        assert_eq!((solution.iterations, solution.attempts), (4, 4));
    }
}

#[test]
fn success_at_the_start_takes_no_step() {
    let model = planar_arm(&[0.5, 0.4, 0.3], Some((-2.0, 2.0)));
    let at = support::planar_tip(&[0.5, 0.4, 0.3], &START);
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(model.frame("tip").unwrap(), at));
    let problem = builder.build().unwrap();
    for solver in solvers() {
        let solution = solver.solve_once(&problem, &START).unwrap();
        assert_eq!(solution.termination, Termination::Reached);
        assert_eq!((solution.iterations, solution.attempts), (0, 1));
        assert_eq!(solution.q, START);
        assert!(solution.reached);
    }
}

#[test]
fn soft_tasks_end_before_the_iteration_limit() {
    // Required tasks are reached and the soft task is at its minimum, which ends the search.
    let model = planar_arm(&[0.5, 0.4, 0.3], Some((-2.0, 2.0)));
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(model.frame("tip").unwrap(), [0.6, 0.6, 0.0]));
    builder.add(Posture::new(&model, &[0.0; 3]));
    builder.preferences(Preferences::Traded);
    builder.tolerance(kinopt::task::Quantity::Metres, 10.0);
    let problem = builder.build().unwrap();
    for solver in solvers() {
        // Fixed-step descent takes too many iterations.
        if solver.method() == "projected-gradient" {
            continue;
        }
        let solution = solver.solve_once(&problem, &START).unwrap();
        assert!(solution.reached);
        assert_eq!(solution.agreeing, 0, "a success is not compared");
        let settled = [Termination::Stationary, Termination::SmallStep];
        assert!(
            settled.contains(&solution.termination),
            "{}: {solution:?}",
            solver.method()
        );
    }
}

/// The lowest cost of a search with increasing steps is returned, at any number of steps.
#[test]
fn lowest_iterate_is_returned() {
    let rig = support::bones::RandomRig::new(6);
    let far_problem = rig.drawn_to(|| [0.9, -0.8, 0.7]);
    let start = rig.skeleton.model().neutral();
    let mut climbed = 0;
    for most in 1..40 {
        let mut seen = Vec::new();
        let mut watch = |iteration: &Iteration<'_>| {
            seen.push(iteration.cost);
            ControlFlow::Continue(())
        };
        let stopping = Stopping::default().with_max_iterations(most);
        let solver = Solver::new(ProjectedGradient::new(FirstStep::BarzilaiBorwein))
            .with_stopping(stopping)
            .with_restarts(Restarts::none());
        let mut workspace = Workspace::new();
        let solution = solver.solve_observed(&far_problem, &start, &mut workspace, &mut watch);
        let solution = solution.unwrap();
        let lowest = seen.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(
            solution.cost <= lowest,
            "{most}: {} {lowest}",
            solution.cost
        );
        climbed += usize::from(seen.last().is_some_and(|last| *last > lowest));
    }
    assert!(climbed > 0);
}

/// A step is small relative to the tolerance times max(1, |x|). The result is not called stationary.
#[test]
fn small_step_is_reported() {
    let model = planar_arm(&[1.0], Some((-2.0, 2.0)));
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(model.frame("tip").unwrap(), [1.0, 0.0, 0.0]));
    let problem = builder.build().unwrap();
    for (tolerance, ended) in [(0.9, Termination::SmallStep), (1e-15, Termination::Reached)] {
        let solver = Solver::default()
            .with_stopping(Stopping::default().with_step_tolerance(tolerance))
            .with_restarts(Restarts::none());
        let solution = solver.solve_once(&problem, &[-0.3]).unwrap();
        assert_eq!(solution.termination, ended);
        assert_eq!(solution.iterations == 1, tolerance > 0.1);
    }
}

/// A step that reaches its target is reported as reached, whatever the step tolerance.
#[test]
fn small_step_to_the_target_is_reached() {
    let target = [0.2, 0.7, 0.0];
    let solution = Solver::default().solve_once(&problem(target), &START);
    let nearby: Vec<f64> = solution.unwrap().q.iter().map(|q| q + 1e-5).collect();
    let mut reported = 0;
    for solver in solvers() {
        let ended = |tolerance: f64| {
            let stopping = Stopping::default().with_step_tolerance(tolerance);
            let solver = solver.clone().with_stopping(stopping);
            let solver = solver.with_restarts(Restarts::none());
            solver.solve_once(&problem(target), &nearby).unwrap()
        };
        let exact = ended(1e-15);
        if exact.reached && exact.iterations == 1 {
            reported += 1;
            let rough = ended(1.0).termination;
            assert_eq!(rough, Termination::Reached, "{}", solver.method());
        }
    }
    assert!(reported > 2, "{reported}");
}

/// Cosine between the residual and the most effective joint's column, with columns normalised by the longest.
fn cosine(q: &[f64], target: [f64; 3]) -> f64 {
    let links = [0.5, 0.4, 0.3];
    let tip = support::planar_tip(&links, &[q[0], q[1], q[2]]);
    let miss = [tip[0] - target[0], tip[1] - target[1]];
    let (mut origin, mut angle) = ([0.0; 2], 0.0);
    let (mut slope, mut longest) = (0.0_f64, 0.0_f64);
    for (length, q) in links.into_iter().zip(q) {
        let lever = [tip[0] - origin[0], tip[1] - origin[1]];
        slope = slope.max((lever[0] * miss[1] - lever[1] * miss[0]).abs());
        longest = longest.max(lever[0].hypot(lever[1]));
        angle += q;
        origin = [
            origin[0] + length * angle.cos(),
            origin[1] + length * angle.sin(),
        ];
    }
    slope / (longest * miss[0].hypot(miss[1]))
}

/// A search ends at the first iterate whose cosine is below the gradient tolerance.
#[test]
fn gradient_tolerance_ends_the_search() {
    let target = [2.0, 0.7, 0.0];
    let mut steps = Vec::new();
    for tolerance in [0.3, 1e-2, 1e-4, 1e-9] {
        for solver in solvers() {
            let mut cosines = Vec::new();
            let mut watch = |iteration: &Iteration<'_>| {
                cosines.push(cosine(iteration.x, target));
                ControlFlow::Continue(())
            };
            let stopping = Stopping::default().with_gradient_tolerance(tolerance);
            let solver = solver
                .with_stopping(stopping.with_max_iterations(2000))
                .with_restarts(Restarts::none());
            let mut workspace = Workspace::new();
            let solution = solver
                .solve_observed(&problem(target), &START, &mut workspace, &mut watch)
                .unwrap();
            let label = format!("{} {tolerance}: {cosines:?}", solver.method());
            // Rounding adds to the tolerance.
            let at_end = tolerance.max(2e-7);
            assert_eq!(solution.termination, Termination::Stationary, "{label}");
            assert!(cosine(&solution.q, target) <= at_end, "{label}");
            let [before @ .., _] = cosines.as_slice() else {
                panic!("{label}");
            };
            assert!(
                before.iter().all(|cosine| *cosine > 0.999 * tolerance),
                "{label}"
            );
            steps.push(solution.iterations);
        }
    }
    let (loose, strict) = (steps[0], steps[steps.len() - solvers().len()]);
    assert!(loose < strict, "{loose} {strict}");
}

/// A patience below the attempts' own limit ends them earlier.
#[test]
fn patience_limits_attempts() {
    let rig = support::bones::RandomRig::new(6);
    let problem = rig.drawn_to(|| [9.0, -8.0, 7.0]);
    let start = rig.skeleton.model().neutral();
    let steps = |patience: Option<usize>| {
        let stopping = Stopping::default().with_patience(patience);
        let solver = Solver::default().with_stopping(stopping);
        let restarts = Restarts::default().with_attempts(8);
        let solution = solver.with_restarts(restarts).solve_once(&problem, &start);
        solution.unwrap().iterations
    };
    let [hasty, calm] = [Some(1), None].map(steps);
    assert!(3 * hasty < calm, "{hasty} {calm}");
}

/// Limits of a search that was cut short are reported as "so far", with a hint that more iterations may help.
#[test]
fn interrupted_search_reports_limits_so_far() {
    let all = Stopping::default();
    for (stopping, ended) in [
        (all.with_max_iterations(1), Termination::IterationLimit),
        (all.with_time_limit(Duration::ZERO), Termination::TimeLimit),
        (all.with_patience(Some(1)), Termination::Stalled),
        (all, Termination::Stationary),
    ] {
        let cut = ended != Termination::Stationary;
        let solver = Solver::default().with_restarts(Restarts::none());
        let solver = solver.with_stopping(stopping);
        // Between its limits, and with a joint on a limit; both targets unreachable.
        for (target, start, words) in [
            ([3.0, 0.1, 0.0], START, "No joint limit is active so far"),
            (
                [-2.57, 1.55, 0.0],
                [2.0, 0.2, 0.1],
                "So far it is held back by the upper limit 2.000 rad",
            ),
        ] {
            let solution = solver.solve_once(&problem(target), &start).unwrap();
            let explanation = solution.explain();
            assert_eq!(solution.termination, ended, "{explanation}");
            assert_eq!(explanation.contains(words), cut, "{explanation}");
            let more = explanation.contains("More time or iterations may help");
            assert_eq!(more, cut, "{explanation}");
        }
    }
}

#[test]
fn unsolved_solution_says_so() {
    let text = kinopt::Solution::default().explain();
    assert_eq!(text, "No query was solved yet.");
}
