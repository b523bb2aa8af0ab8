//! Success rate and time of whole-body queries: hands on a free base at reachable targets, with fixed feet and the
//! centre of mass over them. `cargo run --release -p kinopt-benches --bin whole_body -- CASE.json ROBOT.urdf [problems]
//! [--attempts N] [--write FILE]`, with cases in `benches/whole_body/`.
//!
//! Targets are hands of random configurations that balance on the feet. Starts are the standing pose, and within 0.3
//! rad of such a configuration. A skeleton of 22 bones with five tips is measured in the same run. Each time is the
//! best of three rounds. `--write` stores the problems and the results for other solvers
//! (`benches/rivals/python/whole_body.py`).
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::path::Path;

use kinopt::ik::Restarts;
use kinopt::model::Model;
use kinopt::problem::Targets;
use kinopt::spatial::Placement;
use kinopt::task::Point;
use kinopt::{Problem, Solver, Workspace};
use kinopt_benches::{BodyCase, Sequence, ThreadTime, figure, random_targets};
use serde_json::{Value, json};

const MAX_PERTURBATION: f64 = 0.3;
const ROUNDS: usize = 3;

/// Perturbs every number of a velocity by at most `MAX_PERTURBATION` in either direction.
fn perturbed(
    model: &Model,
    q: &[f64],
    sequence: &mut Sequence,
) -> Result<Vec<f64>, Box<dyn Error>> {
    let v: Vec<f64> = (0..model.degrees_of_freedom())
        .map(|_| MAX_PERTURBATION * (2.0 * sequence.unit() - 1.0))
        .collect();
    let mut result = q.to_vec();
    model.integrate(q, &v, &mut result)?;
    Ok(result)
}

/// Result of one query.
struct Answer {
    q: Vec<f64>,
    reached: bool,
    attempts: usize,
    micros: f64,
}

/// Solves every query from its start, in rounds; the fastest round counts.
fn solve_all(
    solver: &Solver,
    problem: &Problem,
    targets: &[Targets],
    starts: &[&Vec<f64>],
) -> Result<Vec<Answer>, Box<dyn Error>> {
    let mut answers: Vec<Answer> = Vec::new();
    let mut workspace = Workspace::new();
    for round in 0..ROUNDS {
        for (k, (targets, start)) in targets.iter().zip(starts).enumerate() {
            let instance = problem.with_targets(targets)?;
            let started = ThreadTime::now();
            let solution = solver.solve(instance, start, &mut workspace)?;
            let micros = started.micros();
            if round == 0 {
                answers.push(Answer {
                    q: solution.q.clone(),
                    reached: solution.reached,
                    attempts: solution.attempts,
                    micros,
                });
            }
            answers[k].micros = answers[k].micros.min(micros);
        }
    }
    Ok(answers)
}

/// Prints a line and returns the median in µs.
fn report(name: &str, answers: &[Answer]) -> f64 {
    let count = answers.len();
    let reached = answers.iter().filter(|answer| answer.reached).count();
    let mut micros: Vec<f64> = answers.iter().map(|answer| answer.micros).collect();
    micros.sort_by(f64::total_cmp);
    let quantile = |share: f64| micros[((count - 1) as f64 * share) as usize];
    let attempts: usize = answers.iter().map(|answer| answer.attempts).sum();
    println!(
        "  {name:<32} {reached:>5} of {count} ({:.1} %), median {:.1} us, mean {:.1}, p99 {:.1}; {:.2} attempts",
        100.0 * reached as f64 / count as f64,
        quantile(0.5),
        micros.iter().sum::<f64>() / count as f64,
        quantile(0.99),
        attempts as f64 / count as f64,
    );
    quantile(0.5)
}

/// Medians of the skeleton from near and from rest.
fn bones(count: usize) -> Result<[f64; 2], Box<dyn Error>> {
    let (skeleton, tips) = figure(2, 4);
    let model = skeleton.model();
    let mut builder = Problem::builder(model);
    let tasks: Vec<_> = tips
        .iter()
        .map(|&tip| builder.add(Point::new(skeleton.tip(tip), [0.0; 3])))
        .collect();
    let problem = builder.build()?;
    let mut queries = Vec::new();
    for positions in random_targets(&skeleton, &tips, count, &mut Sequence::new(0.5)) {
        let mut targets = problem.targets();
        for (&task, position) in tasks.iter().zip(positions) {
            targets.get_mut(task)?.set_target(position);
        }
        queries.push(targets);
    }
    let rest = model.neutral();
    let solver = Solver::default();
    let from_rest = solve_all(&solver, &problem, &queries, &vec![&rest; count])?;
    let mut sequence = Sequence::new(0.25);
    let near_starts = from_rest
        .iter()
        .map(|solution| perturbed(model, &solution.q, &mut sequence));
    let near_starts = near_starts.collect::<Result<Vec<_>, _>>()?;
    let near_starts: Vec<_> = near_starts.iter().collect();
    let from_near = solve_all(&solver, &problem, &queries, &near_starts)?;
    println!("22 bones, five tips:");
    Ok([
        report("from near", &from_near),
        report("from rest", &from_rest),
    ])
}

/// Rows of the matrix of a placement.
fn matrix(placement: &Placement<f64>) -> Value {
    let Placement {
        rotation,
        translation: t,
    } = placement;
    let turned = rotation.transpose();
    let [x, y, z] = [turned.x, turned.y, turned.z].map(|row| row.to_array());
    json!([
        [x[0], x[1], x[2], t.x],
        [y[0], y[1], y[2], t.y],
        [z[0], z[1], z[2], t.z],
        [0.0, 0.0, 0.0, 1.0],
    ])
}

fn document(
    case: &BodyCase,
    hands: &[Vec<Placement<f64>>],
    runs: [(&[&Vec<f64>], &[Answer]); 2],
) -> Value {
    let model = case.robot.model();
    let name = |frame: &kinopt::model::FrameId| &model.frames()[frame.index()].name;
    let joints = model.moving_joints().iter().skip(7);
    let joints: Vec<_> = joints
        .map(|joint| &model.joints()[joint.index()].name)
        .collect();
    let feet: Vec<_> = case
        .feet
        .iter()
        .map(|(foot, at)| json!([name(foot), matrix(at)]))
        .collect();
    let support: Vec<_> = case.support.iter().map(|at| at.to_array()).collect();
    let run_documents = |(starts, answers): (&[&Vec<f64>], &[Answer])| -> Value {
        let run_documents = starts.iter().zip(answers);
        run_documents.map(|(start, answer)| json!({
            "start": start, "q": answer.q, "reached": answer.reached, "micros": answer.micros,
        }))
        .collect()
    };
    let [near, standing] = runs.map(run_documents);
    json!({
        "joints": joints,
        "feet": feet,
        "hands": case.hands.iter().map(name).collect::<Vec<_>>(),
        "support": support,
        "targets": hands.iter().map(|placements| placements.iter().map(matrix).collect::<Vec<_>>()).collect::<Vec<_>>(),
        "near": near,
        "standing": standing,
    })
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let mut option = |name: &str| {
        let index = arguments.iter().position(|word| word == name)?;
        arguments
            .drain(index..(index + 2).min(arguments.len()))
            .nth(1)
    };
    let (attempts, file) = (option("--attempts"), option("--write"));
    let [case, robot, rest @ ..] = arguments.as_slice() else {
        return Err("CASE.json ROBOT.urdf [problems] [--attempts N] [--write FILE]".into());
    };
    let count: usize = rest.first().map_or(Ok(200), |count| count.parse())?;
    let mut restarts = Restarts::default();
    if let Some(attempts) = attempts {
        restarts = restarts.with_attempts(attempts.parse()?);
    }
    let solver = Solver::default().with_restarts(restarts);
    let case = BodyCase::read(Path::new(case), Path::new(robot))?;
    let model = case.robot.model();
    let balanced = case.balanced(count)?;
    let hands = case.hands_at(&balanced)?;
    let body = case.problem()?;
    let targets = hands.iter().map(|hands| body.targets(hands));
    let targets = targets.collect::<Result<Vec<_>, _>>()?;
    let mut sequence = Sequence::new(0.75);
    let near_starts = balanced.iter().map(|q| perturbed(model, q, &mut sequence));
    let near_starts = near_starts.collect::<Result<Vec<_>, _>>()?;
    let near_starts: Vec<_> = near_starts.iter().collect();
    let standing_starts = vec![&case.standing; count];
    let from_near = solve_all(&solver, &body.problem, &targets, &near_starts)?;
    let from_standing = solve_all(&solver, &body.problem, &targets, &standing_starts)?;
    println!(
        "{}: {} variables, {} rows",
        case.robot.name(),
        body.problem.variables(),
        body.problem.rows()
    );
    let medians = [
        report("from near", &from_near),
        report("from standing", &from_standing),
    ];
    let [near_bones, rest_bones] = bones(count)?;
    println!(
        "to the bones from near: near {:.2}, standing {:.2}; to the bones from rest: near {:.2}, standing {:.2}",
        medians[0] / near_bones,
        medians[1] / near_bones,
        medians[0] / rest_bones,
        medians[1] / rest_bones,
    );
    if let Some(file) = file {
        let runs = [
            (&near_starts[..], &from_near[..]),
            (&standing_starts[..], &from_standing[..]),
        ];
        std::fs::write(file, serde_json::to_string(&document(&case, &hands, runs))?)?;
    }
    Ok(())
}
