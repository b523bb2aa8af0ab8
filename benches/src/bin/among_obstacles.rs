//! Times of single arm queries with and without a world, for comparison with other languages on equal queries.
//!
//! `among_obstacles < QUESTIONS` reads JSON with `robot` and `srdf` (files), `base`, `tip`, `rounds`, `margin` and
//! `questions`. Each question has `world` (a file), `target` (sixteen numbers, row-major), `start` and `rest` (values
//! of joints by name).
//!
//! The output is JSON. Each query has the fastest nanoseconds of a plain arm and of an arm with the world, reached or
//! not, and its configuration. The output also has the time per pose in batches of a hundred queries in one world.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use kinopt::Solution;
use kinopt::arm::{Arm, PoseOutcome, Search};
use kinopt::collision::{Checker, CollisionModel, World};
use kinopt::robot::{Robot, Srdf};
use kinopt::spatial::{Matrix3, Placement, Vector3};
use serde_json::{Value, json};

/// Queries of a batch.
const BATCH: usize = 100;
/// Number of worlds with batches.
const WORLDS: usize = 7;

fn main() -> Result<(), Box<dyn Error>> {
    let input: Value = serde_json::from_reader(std::io::stdin())?;
    let text = |key: &str| input[key].as_str().ok_or(format!("`{key}` is missing"));
    let robot = Robot::read(text("robot")?)?;
    let model = CollisionModel::of(&robot)?.with_srdf(&Srdf::read(text("srdf")?, &robot)?);
    let checker = Checker::covered(model).with_margin(input["margin"].as_f64().unwrap_or(0.0))?;
    let (base, tip) = (text("base")?, text("tip")?);
    let plain = Arm::new(&robot, base, tip)?;
    let rounds = input["rounds"].as_u64().unwrap_or(5);
    let queries = input["questions"]
        .as_array()
        .ok_or("`questions` is missing")?;

    let (mut answers, mut batches) = (Vec::new(), Vec::new());
    for (index, query) in queries.iter().enumerate() {
        let file = query["world"].as_str().ok_or("a question has a world")?;
        let world = World::read(file)?;
        let rest = rest(&robot, &query["rest"])?;
        let checker = checker.clone().with_world(&world)?;
        let avoiding = plain
            .with_search(Search::Start)?
            .with_checker(&checker, &rest)?;
        let (target, start) = (placement(&query["target"])?, numbers(&query["start"])?);
        let (mut without, mut with_world) = (Solution::default(), Solution::default());
        let mut best = [u128::MAX; 2];
        for _ in 0..rounds {
            let arms = [(&plain, &mut without), (&avoiding, &mut with_world)];
            for ((arm, solution), best) in arms.into_iter().zip(&mut best) {
                let started = Instant::now();
                arm.solve_into(target, &start, black_box(solution))?;
                *best = (*best).min(started.elapsed().as_nanos());
            }
        }
        answers.push(json!({
            "plain": best[0] as u64, "clear": best[1] as u64, "plain_reached": without.reached,
            "reached": with_world.reached, "q": with_world.q, "plain_q": without.q, "attempts": with_world.attempts,
        }));
        if index % queries.len().div_ceil(WORLDS).max(1) == 0 {
            batches.push(batch(&plain, &avoiding, &start, rounds)?);
        }
    }
    println!("{}", json!({ "answers": answers, "batches": batches }));
    Ok(())
}

/// A hundred poses of free configurations in one world, nanoseconds for each pose: plain, and with collision avoidance.
fn batch(plain: &Arm, avoiding: &Arm, start: &[f64], rounds: u64) -> Result<Value, Box<dyn Error>> {
    let mut random = kinopt_benches::Sequence::new(0.5);
    let mut targets = Vec::new();
    while targets.len() < BATCH {
        let q = plain.limits().map(|joint| {
            let (lower, upper) = (joint.lower.max(-7.0), joint.upper.min(7.0));
            lower + (upper - lower) * random.unit()
        });
        let q: Vec<f64> = q.collect();
        if avoiding.collisions(&q)?.is_empty() {
            targets.push(avoiding.base_from_tool(&q)?);
        }
    }
    let starts = start.repeat(BATCH);
    let mut q = vec![0.0; starts.len()];
    let mut outcomes = vec![PoseOutcome::default(); BATCH];
    let mut time = |arm: &Arm| -> Result<(f64, usize), Box<dyn Error>> {
        let mut best = f64::INFINITY;
        for _ in 0..rounds {
            let started = Instant::now();
            arm.solve_batch_into(&targets, &starts, &mut q, &mut outcomes)?;
            best = best.min(started.elapsed().as_nanos() as f64 / BATCH as f64);
        }
        Ok((
            best,
            outcomes.iter().filter(|outcome| outcome.reached).count(),
        ))
    };
    let ((plain, _), (avoiding, reached)) = (time(plain)?, time(avoiding)?);
    Ok(json!({ "plain": plain, "clear": avoiding, "reached": reached, "asked": BATCH }))
}

/// A configuration of the whole robot: the given values, otherwise zeros.
fn rest(robot: &Robot, values: &Value) -> Result<Vec<f64>, Box<dyn Error>> {
    let model = robot.model();
    let mut q = model.neutral();
    for (name, value) in values.as_object().into_iter().flatten() {
        // The files include joints that are fixed in this description of the robot.
        if let (Ok(joint), Some(value)) = (model.joint(name), value.as_f64())
            && let Some(coordinate) = model.coordinate(joint)
        {
            q[coordinate] = value;
        }
    }
    Ok(q)
}

fn numbers(value: &Value) -> Result<Vec<f64>, Box<dyn Error>> {
    let list = value.as_array().ok_or("a list of numbers is missing")?;
    let numbers = list
        .iter()
        .map(|value| value.as_f64().ok_or("not a number".into()));
    numbers.collect()
}

fn placement(value: &Value) -> Result<Placement<f64>, Box<dyn Error>> {
    let m = numbers(value)?;
    if m.len() != 16 {
        return Err("a target has sixteen numbers".into());
    }
    let column = |j: usize| Vector3::new(m[j], m[4 + j], m[8 + j]);
    let rotation = Matrix3::from_columns(column(0), column(1), column(2));
    Ok(Placement::new(rotation, column(3)))
}
