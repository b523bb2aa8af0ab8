//! Success rate of shipped rigs for reachable targets from rest, and number of attempts: `cargo run --release -p
//! kinopt-benches --bin rig_reach -- [targets]`.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::path::Path;

use kinopt::ik::Drag;
use kinopt::io::rig::Rig;
use kinopt::model::ParameterMap;
use kinopt::skeleton::BoneId;
use kinopt::task::{Point, Quantity};
use kinopt::{Problem, Skeleton, Solver, Workspace};
use kinopt_benches::{Sequence, ThreadTime, figure, random_targets};

/// Largest number of frames until a body is at rest.
const MAX_FRAMES: usize = 200;

fn reach(
    name: &str,
    skeleton: &Skeleton,
    tips: &[BoneId],
    count: usize,
) -> Result<(), Box<dyn Error>> {
    let mut builder = Problem::builder(skeleton.model());
    builder.parameters(ParameterMap::free(skeleton.model()));
    builder.tolerance(Quantity::Metres, 1e-9 * skeleton.size());
    let tasks: Vec<_> = tips
        .iter()
        .map(|&tip| builder.add(Point::new(skeleton.tip(tip), [0.0; 3])))
        .collect();
    let targets = random_targets(skeleton, tips, count, &mut Sequence::new(0.5));
    let rest = skeleton.model().neutral();
    let mut drag = Drag::new(builder.build()?, &rest)?;
    let mut workspace = Workspace::new();
    let (mut settled, mut missed, mut attempts) = (0, Vec::new(), Vec::new());
    let mut micros = [Vec::new(), Vec::new()];
    for (index, target) in targets.iter().enumerate() {
        for (&task, &position) in tasks.iter().zip(target) {
            drag.target_mut(task)?.set_target(position);
        }
        drag.set_configuration(&rest)?;
        let started = ThreadTime::now();
        settled += usize::from(drag.settle(MAX_FRAMES).reached);
        micros[0].push(started.micros());
        let started = ThreadTime::now();
        let solution = Solver::default().solve(drag.question(), &rest, &mut workspace)?;
        micros[1].push(started.micros());
        match solution.reached {
            true => attempts.push(solution.attempts),
            false => missed.push(index),
        }
    }
    attempts.sort_unstable();
    micros
        .iter_mut()
        .for_each(|list| list.sort_by(f64::total_cmp));
    let quantile = |list: &[f64], share: f64| list[((list.len() - 1) as f64 * share) as usize];
    let max_attempts: Vec<_> = attempts.iter().rev().take(8).collect();
    println!(
        "{name}: {count} targets of {} tips: {} missed {missed:?}; attempts: most {max_attempts:?}; \
         p50 {:.0} µs, p99 {:.0} µs; settled on its own way: {settled}, p50 {:.0} µs, p99 {:.0} µs",
        tips.len(),
        missed.len(),
        quantile(&micros[1], 0.5),
        quantile(&micros[1], 0.99),
        quantile(&micros[0], 0.5),
        quantile(&micros[0], 0.99),
    );
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let count: usize = std::env::args().nth(1).map_or(Ok(6000), |n| n.parse())?;
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let (figure, tips) = figure(2, 4);
    reach("figure of 22 bones", &figure, &tips, count)?;
    for name in ["humanoid", "robot-arm"] {
        let rig = Rig::read(models.join(name).join(format!("{name}.json")))?;
        let skeleton = &rig.skeleton;
        reach(name, skeleton, &rig.constrained, count)?;
        let last = rig.constrained.first().copied();
        reach(name, skeleton, last.as_slice(), count)?;
    }
    Ok(())
}
