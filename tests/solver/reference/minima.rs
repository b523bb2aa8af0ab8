//! Promise: the default solver finds minima no higher than the best of CasADi with IPOPT, NLopt and SciPy.
//!
//! The problems are the bounded least-squares problems of `notebooks-ref/2-minima.ipynb`; the solver searches until
//! three attempts agree. Where it ends in another minimum, that minimum is stationary within the bounds and listed
//! here.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout
)]

use std::collections::BTreeSet;

use crate::reference::problems::{Loaded, Statement, problem, reference};
use kinopt::Solver;
use kinopt::ik::{Restarts, Solution};
use kinopt::problem::{Evaluation, Problem};
use kinopt::solver::LeastSquares;
use nalgebra::DMatrix;
use support::random::part;

/// Relative to the reference's cost.
const COST_TOLERANCE: f64 = 1e-9;
/// Remainder of a zero cost at tolerances of 1e-9 m, in m².
const ZERO_COST: f64 = 1e-16;
/// Cosine between the residual and its first-order change by any free variable.
const MAX_GRADIENT_COSINE: f64 = 1e-6;
/// The problems are solved in parallel, because they are many.
const THREADS: usize = 4;
/// Problems whose solution is a stationary minimum other than the best known.
const IN_ANOTHER_MINIMUM: [&str; 22] = [
    "five tips with posture, humanoid 16",
    "five tips with posture, humanoid 3",
    "look, distance, plane, humanoid 18",
    "look, distance, plane, humanoid 20",
    "look, distance, plane, humanoid 4",
    "orientation with centring, iiwa14 7",
    "orientation with centring, ur5e 3",
    "orientation with centring, ur5e 5",
    "orientation with centring, ur5e 7",
    "pose out of reach, iiwa14 6",
    "pose out of reach, panda 3",
    "pose out of reach, panda 6",
    "pose out of reach, ur5e 3",
    "pose with limits active, oblique 8",
    "two arms, baxter 1",
    "two arms, baxter 10",
    "two arms, baxter 12",
    "two arms, baxter 3",
    "two arms, baxter 5",
    "two arms, baxter 9",
    "viewing ray, humanoid 5",
    "viewing ray, robot-arm 22",
];

/// Cost, KKT residual and the cosine by which our solvers stop, evaluated afresh.
struct Measured {
    cost: f64,
    kkt: f64,
    cosine: f64,
}

fn measure(problem: &Problem, x: &[f64]) -> Measured {
    let mut scratch = problem.scratch();
    let mut evaluation = Evaluation::new(problem, &mut scratch);
    let mut r = vec![0.0; problem.rows()];
    let mut jacobian = DMatrix::zeros(problem.rows(), problem.variables());
    evaluation.residual(x, &mut r);
    evaluation.jacobian(x, &mut jacobian);
    let norm = r.iter().map(|v| v * v).sum::<f64>().sqrt();
    let gradient = jacobian.transpose() * nalgebra::DVector::from_column_slice(&r);
    let bounds = problem.lower().iter().zip(problem.upper());
    let moves = x.iter().zip(gradient.iter()).zip(bounds);
    let kkt = moves
        .map(|((x, g), (lower, upper))| ((x - g).clamp(*lower, *upper) - x).abs())
        .fold(0.0, f64::max);
    let longest = jacobian.column_iter().map(|c| c.norm()).fold(0.0, f64::max);
    Measured {
        cost: 0.5 * norm * norm,
        kkt,
        cosine: kkt / (longest * norm).max(f64::MIN_POSITIVE),
    }
}

fn solve(statement: &Statement, problem: &Problem) -> Solution {
    let mut start = vec![0.0; problem.configuration_len()];
    problem
        .parameters()
        .expand(&statement.start, &mut start)
        .unwrap();
    // By default the search would stop before the last per mille of an unreached cost.
    let restarts = Restarts::default().with_agreeing(3);
    let solver = Solver::default().with_restarts(restarts);
    solver.solve_once(problem, &start).unwrap()
}

fn variables(problem: &Problem, q: &[f64]) -> Vec<f64> {
    let mut x = vec![0.0; problem.variables()];
    problem.parameters().reduce(q, &mut x).unwrap();
    x
}

#[test]
fn reference_has_enough_problems_of_enough_kinds() {
    let (_, problems) = reference();
    let kinds: BTreeSet<&str> = problems.iter().map(|p| p.kind.as_str()).collect();
    let names: BTreeSet<&str> = problems.iter().map(|p| p.name.as_str()).collect();
    assert!(problems.len() >= 200 && names.len() == problems.len());
    assert!(kinds.len() >= 6, "{kinds:?}");
}

#[test]
fn costs_and_kkt_residuals_equal_the_references() {
    // Our cost and KKT residual equal CasADi's at every program's solution.
    let (models, problems) = reference();
    for statement in &problems {
        let problem = problem(statement, &models[&statement.model]);
        for (tool, result) in &statement.answers {
            let measured = measure(&problem, &result.x);
            let deviation = (measured.cost - result.cost).abs() / result.cost.max(1e-6);
            assert!(
                deviation < 1e-12,
                "{}, {tool}: cost off by {deviation:e}",
                statement.name
            );
            let deviation = (measured.kkt - result.kkt).abs() / result.cost.sqrt().max(1e-3);
            assert!(
                deviation < 1e-10,
                "{}, {tool}: kkt off by {deviation:e}",
                statement.name
            );
        }
    }
}

/// Why a problem's solution is wrong, and its excess where it is another minimum.
struct Verdict<'a> {
    name: &'a str,
    not_stationary: Option<String>,
    above_the_best: Option<String>,
}

fn judge<'a>(statement: &'a Statement, loaded: &Loaded) -> Verdict<'a> {
    let problem = problem(statement, loaded);
    let solution = solve(statement, &problem);
    let measured = measure(&problem, &variables(&problem, &solution.q));
    let best = statement.minima[statement.best].cost;
    let reported = (solution.cost - measured.cost).abs() <= 1e-12 * measured.cost.max(ZERO_COST);
    assert!(reported, "{}: {} told", statement.name, solution.cost);
    let moving = !solution.reached && measured.cosine > MAX_GRADIENT_COSINE;
    let above = measured.cost > best * (1.0 + COST_TOLERANCE) + ZERO_COST;
    Verdict {
        name: &statement.name,
        not_stationary: moving.then(|| {
            format!(
                "{} at a cosine of {:e}",
                solution.termination, measured.cosine
            )
        }),
        above_the_best: above
            .then(|| format!("{:.9e}, the best known is {best:.9e}", measured.cost)),
    }
}

#[test]
fn default_solver_matches_the_best_known_minimum() {
    let (models, problems) = reference();
    let looked_at: Vec<_> = part(&problems, 5).collect();
    let verdicts: Vec<Verdict<'_>> = std::thread::scope(|scope| {
        // Interleaved, so that each thread gets a share of the large problems.
        let workers: Vec<_> = (0..THREADS)
            .map(|first| {
                let share = looked_at.iter().skip(first).step_by(THREADS);
                let models = &models;
                scope.spawn(move || {
                    share
                        .map(|p| judge(p, &models[&p.model]))
                        .collect::<Vec<_>>()
                })
            })
            .collect();
        workers
            .into_iter()
            .flat_map(|w| w.join().unwrap())
            .collect()
    });
    assert_eq!(verdicts.len(), looked_at.len());
    let moving = verdicts.iter().filter_map(|verdict| {
        let reported = verdict.not_stationary.as_ref()?;
        Some(format!("{}: {reported}", verdict.name))
    });
    assert_eq!(moving.collect::<Vec<_>>(), [""; 0]);
    let unexpected = verdicts.iter().filter_map(|verdict| {
        let reported = verdict.above_the_best.as_ref()?;
        let known = IN_ANOTHER_MINIMUM.contains(&verdict.name);
        println!("{}: ends in another minimum: {reported}", verdict.name);
        (!known).then(|| format!("{}: {reported}", verdict.name))
    });
    assert_eq!(unexpected.collect::<Vec<_>>(), [""; 0]);
}
