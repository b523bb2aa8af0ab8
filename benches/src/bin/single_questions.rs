//! Times of single arm queries, for comparison with other languages on equal queries.
//!
//! `single_questions FILE.urdf BASE TIP SEARCH ROUNDS < NUMBERS`: for each query sixteen numbers of a target,
//! row-major, and a start, as little-endian f64. The output is JSON: the fastest nanoseconds of each query and the rate
//! of a batch of all.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::io::Read;
use std::time::Instant;

use kinopt::arm::{Arm, PoseOutcome, Search};
use kinopt::robot::Robot;
use kinopt::spatial::{Matrix3, Placement, Vector3};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, base, tip, search, rounds] = &arguments[..] else {
        return Err("single_questions FILE.urdf BASE TIP start|first ROUNDS < NUMBERS".into());
    };
    let search = match search.as_str() {
        "first" => Search::First,
        _ => Search::Start,
    };
    let robot = Robot::read(file)?;
    let arm = Arm::builder(&robot, base, tip)
        .with_search(search)
        .build()?;
    let n = arm.joint_count();
    let (targets, starts) = read_queries(n)?;

    let rounds: usize = rounds.parse()?;
    let mut nanoseconds = vec![u128::MAX; targets.len()];
    for _ in 0..rounds {
        for ((target, start), best) in targets.iter().zip(starts.chunks(n)).zip(&mut nanoseconds) {
            let started = Instant::now();
            std::hint::black_box(arm.solve(target, start)?);
            *best = (*best).min(started.elapsed().as_nanos());
        }
    }
    let mut q = vec![0.0; starts.len()];
    let mut outcomes = vec![PoseOutcome::default(); targets.len()];
    let mut batch = f64::INFINITY;
    for _ in 0..rounds {
        let started = Instant::now();
        arm.solve_batch_into(&targets, &starts, &mut q, &mut outcomes)?;
        batch = batch.min(started.elapsed().as_nanos() as f64 / targets.len() as f64);
    }
    let reached = outcomes.iter().filter(|outcome| outcome.reached).count();
    println!(r#"{{"reached": {reached}, "batch": {batch}, "single": {nanoseconds:?}}}"#);
    Ok(())
}

/// Targets, with a start for each.
type Queries = (Vec<Placement<f64>>, Vec<f64>);

fn read_queries(joints: usize) -> Result<Queries, Box<dyn Error>> {
    let mut bytes = Vec::new();
    std::io::stdin().read_to_end(&mut bytes)?;
    let numbers = bytes
        .chunks_exact(8)
        .map(|eight| Ok(f64::from_le_bytes(eight.try_into()?)));
    let numbers: Vec<f64> = numbers.collect::<Result<_, Box<dyn Error>>>()?;
    let (mut targets, mut starts) = (Vec::new(), Vec::new());
    for query in numbers.chunks_exact(16 + joints) {
        let (m, start) = query.split_at(16);
        let column = |j: usize| Vector3::new(m[j], m[4 + j], m[8 + j]);
        let rotation = Matrix3::from_columns(column(0), column(1), column(2));
        targets.push(Placement::new(rotation, column(3)));
        starts.extend_from_slice(start);
    }
    Ok((targets, starts))
}
