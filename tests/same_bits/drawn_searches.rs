//! Promise: so it is for problems that are drawn at random, asked one after the other with one memory: by every method within
//! all limits of steps, attempts and moves, with other targets, weights and places of joints, and how the answers change with those.
#![allow(clippy::unwrap_used)]

use kinopt::ik::{DerivativeWorkspace, MoveLimits, Restarts, SolutionDerivative};
use kinopt::problem::{Derivatives, Problem, ProblemInstance};
use kinopt::solver::Stopping;
use kinopt::{Solver, Workspace};
use support::methods::solvers;
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::drawn::one_of;
use crate::every_joint::vector;
use crate::mixed_arms::{INF, rarely};
use crate::mixed_problems::{Body, problem};
use crate::tasks::evaluate;

/// A method, or the usual one, within limits of every kind, `most` steps at most; now and then a limit that is none.
fn solver(random: &mut Random, most: usize) -> Solver {
    let own = match random.below(3) {
        0 => solvers()[random.below(5)].clone(),
        _ => Solver::default(),
    };
    let steps = one_of(random, &[0, 1, 4, 9, 14, 40]).min(most);
    let mut stopping = Stopping::default().with_max_iterations(steps);
    let mut restarts = Restarts::default().with_attempts(one_of(random, &[1, 2, 4, 5]));
    for _ in 0..random.below(4) {
        match random.below(6) {
            0 => {
                stopping =
                    stopping.with_patience(one_of(random, &[None, Some(0), Some(1), Some(3)]))
            }
            1 => stopping = stopping.with_gradient_tolerance(one_of(random, &[0.0, 1e-3, 0.3])),
            2 => stopping = stopping.with_step_tolerance(one_of(random, &[0.0, 1e-3, 0.1])),
            3 => restarts = restarts.with_agreeing(one_of(random, &[1, 2, 9])),
            4 => restarts = restarts.with_steps(one_of(random, &[0, 1, 12, usize::MAX])),
            _ => restarts = restarts.with_seed(one_of(random, &[1, 7, u64::MAX])),
        }
    }
    match random.below(60) {
        0 => restarts = restarts.with_attempts(0),
        1 => stopping = stopping.with_step_tolerance(f64::NAN),
        _ => {}
    }
    // To the end from the start alone.
    if steps > 9 {
        restarts = restarts.with_attempts(1);
    }
    own.with_stopping(stopping).with_restarts(restarts)
}

/// How far joints may move: each number or one angle.
fn moves(
    body: &Body,
    problem: &Problem,
    start: &[f64],
    random: &mut Random,
) -> Result<MoveLimits, String> {
    let by_angle = random.below(2) == 0;
    let moves = match by_angle {
        true => MoveLimits::by_angle(problem, one_of(random, &[0.02, 0.3, INF, 0.0]), start),
        false => {
            let mut most: Vec<f64> = (start.iter())
                .map(|_| one_of(random, &[0.0, 0.05, 0.4, INF]))
                .collect();
            let model = &body.model;
            let balls = model
                .joint_ids()
                .filter(|id| model.joints()[id.index()].kind.is_ball());
            for at in balls.filter_map(|id| model.coordinate(id)) {
                let one = most[at];
                most[at..at + 4].fill(one);
                if rarely(random, 40) {
                    most[at + 1] = 0.7;
                }
            }
            MoveLimits::new(problem, &most, start)
        }
    };
    moves.map_err(|error| error.to_string())
}

/// What a problem says, as a whole and at a place.
fn looked_at(digest: &mut Digest, problem: &Problem, q: &[f64]) {
    digest.noted(&(problem.tasks(), problem.rows(), problem.variables()));
    for task in 0..=problem.tasks() {
        digest.noted(&problem.task_name(task));
    }
    digest.noted(&(
        problem.has_preferences(),
        problem.preferences(),
        problem.derivatives(),
    ));
    let bounds = problem.lower().iter().chain(problem.upper());
    digest.doubles(
        bounds
            .copied()
            .chain(problem.weights())
            .chain([problem.reach()]),
    );
    let mut x = vec![0.0; problem.variables()];
    problem.parameters().reduce(q, &mut x).unwrap();
    for route in [problem.derivatives(), Derivatives::Analytic] {
        evaluate(digest, &problem.clone().with_derivatives(route), &x);
    }
}

/// How an answer changes.
fn changes(
    digest: &mut Digest,
    (body, question): (&Body, ProblemInstance<'_>),
    q: &[f64],
    memory: &mut DerivativeWorkspace,
    random: &mut Random,
) {
    let own = match SolutionDerivative::new(question, q, memory) {
        Ok(own) => own,
        Err(error) => return digest.text(error.to_string()),
    };
    let own = match random.below(2) {
        0 => Ok(own),
        _ => own.with_joint_origins(&body.model),
    };
    let mut own = match own {
        Ok(own) => own,
        Err(error) => return digest.text(error.to_string()),
    };
    digest.bytes(format!(
        "{} {:?}",
        own.differentiability(),
        own.differentiability()
    ));
    let mut rates = own.parameters();
    let mut draw = |values: &mut [f64]| {
        values
            .iter_mut()
            .for_each(|value| *value = random.within(-1.0, 1.0));
    };
    draw(rates.targets_mut());
    draw(rates.weights_mut());
    let mut v = vec![0.0; own.degrees_of_freedom()];
    let mut slope = v.clone();
    draw(&mut slope);
    for origin in rates.joint_origins_mut() {
        *origin = vector(random, 1.0);
    }
    digest.refusal(own.velocity(&rates, &mut v));
    digest.doubles(v.iter().copied());
    let mut gradient = own.parameters();
    digest.refusal(own.gradient(&slope, &mut gradient));
    digest.doubles(gradient.targets().iter().chain(gradient.weights()).copied());
    let origins = gradient.joint_origins().iter();
    origins.for_each(|origin| digest.doubles(origin.to_array()));
    match own.by_target(random.below(4)) {
        Ok(matrix) => digest.doubles(matrix.iter().copied()),
        Err(error) => digest.text(error.to_string()),
    }
}

fn mixes(seed: u64, cases: usize) -> [Value; 3] {
    let mut digests = [(); 3].map(|()| Digest::new());
    let (mut random, mut workspace) = (Random::new(seed), Workspace::new());
    let mut memory = DerivativeWorkspace::default();
    for _ in 0..cases {
        let body = Body::new(&mut random);
        let mut refused = Vec::new();
        let (problem, led) = problem(&body, &mut random, &mut refused);
        let [told, looked, changed] = &mut digests;
        told.noted(&refused);
        let problem = match problem {
            Ok(problem) => problem,
            Err(error) => {
                told.text(error.to_string());
                continue;
            }
        };
        looked_at(looked, &problem, &body.q);
        let mut start = body.start(&mut random);
        if rarely(&mut random, 30) {
            start[0] = f64::NAN;
        }
        for turn in 0..3 {
            let mut targets = problem.targets();
            let to = vector(&mut random, 0.6);
            targets.get_mut(led).unwrap().set_target(to);
            let moves = moves(&body, &problem, &start, &mut random);
            let other = match random.below(6) {
                0 => {
                    let weights: Vec<f64> = (problem.weights().iter())
                        .map(|own| own * one_of(&mut random, &[0.0, 1.0, 2.0]))
                        .collect();
                    problem.clone().with_weights(&weights)
                }
                1 => {
                    let ids = body.model.joint_ids().step_by(3);
                    let at = ids.map(|id| (id, [0.1, -0.2, 0.05]));
                    let elsewhere = body
                        .model
                        .clone()
                        .with_joint_origins(at.collect::<Vec<_>>());
                    problem.clone().with_joint_origins(&elsewhere.unwrap())
                }
                2 | 3 => {
                    let route = one_of(&mut random, &Derivatives::ALL);
                    Ok(problem.clone().with_derivatives(route))
                }
                _ => Ok(problem.clone()),
            };
            told.refusal(other.as_ref());
            let other = other.unwrap_or_else(|_| problem.clone());
            let question = match (random.below(4), &moves) {
                (0, _) => other.with_targets(&targets).unwrap(),
                (1, Ok(moves)) => match ProblemInstance::from(&other).with_moves(moves) {
                    Ok(question) => question,
                    Err(error) => {
                        told.text(error.to_string());
                        continue;
                    }
                },
                (1, Err(error)) => {
                    told.text(error);
                    continue;
                }
                _ => ProblemInstance::from(&other),
            };
            // Slow routes and loops go on for a few steps only.
            let slow = other.derivatives() != Derivatives::Analytic;
            let most = if slow { 2 } else { 40 };
            let most = if body.model.loops().is_empty() {
                most
            } else {
                most.min(5)
            };
            let solver = solver(&mut random, most);
            let solution = match turn {
                0 => solver.solve_once(question, &start),
                _ => solver.solve(question, &start, &mut workspace).cloned(),
            };
            told.answered(solution.clone());
            if let Ok(solution) = solution
                && solution.q.iter().all(|value| value.is_finite())
            {
                if slow {
                    continue;
                }
                changes(
                    changed,
                    (&body, question),
                    &solution.q,
                    &mut memory,
                    &mut random,
                );
                if random.below(2) == 0 {
                    start = solution.q;
                }
            }
        }
        let resumed = SolutionDerivative::resume(&problem, &mut memory);
        changed.noted(&resumed.map(|own| own.differentiability().clone()));
    }
    digests.map(|digest| digest.value())
}

#[test]
fn of_searches() {
    let [told, looked, changed] = mixes(1221, 56);
    check(&[
        ("drawn searches", told),
        ("drawn problems", looked),
        ("drawn derivatives of solutions", changed),
    ]);
}
