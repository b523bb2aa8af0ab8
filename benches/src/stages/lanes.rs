//! SIMD solver on the shipped Panda: one query, and a batch.

use std::error::Error;
use std::hint::black_box;

use kinopt::robot::Robot;
use kinopt::simd_ik::{LaneOptions, PoseOutcome, PoseSolver, Prefer};

use super::{Run, Stage};
use crate::{ArmPoses, Sequence, chain, random_poses};

/// Number of poses of a run.
const POSES: usize = 2000;

pub(super) fn stages() -> Vec<Stage> {
    let stage = |name, build| Stage {
        name,
        elements: POSES as u64,
        unit: "pose",
        build,
    };
    vec![
        stage("SIMD solver, first solution of one query", queries),
        stage("SIMD solver, first solutions of a batch", batch),
    ]
}

fn panda() -> Result<(PoseSolver, ArmPoses), Box<dyn Error>> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/franka_panda.urdf");
    let chain = chain(&Robot::read(file)?, "base", "hand")?;
    let poses = random_poses(&chain, POSES, &mut Sequence::new(0.5));
    Ok((PoseSolver::new(&chain, LaneOptions::default())?, poses))
}

fn queries() -> Result<Run, Box<dyn Error>> {
    let (solver, poses) = panda()?;
    let mut q = vec![0.0; solver.joints()];
    let mut run = move || -> Result<(), Box<dyn Error>> {
        let starts = poses.starts.chunks_exact(solver.joints());
        for (target, start) in poses.targets.iter().zip(starts) {
            black_box(solver.solve(target, start, Prefer::First, None, &mut q)?);
        }
        Ok(())
    };
    run()?;
    Ok(Box::new(move || {
        let _checked_once = run();
    }))
}

fn batch() -> Result<Run, Box<dyn Error>> {
    let (solver, poses) = panda()?;
    let mut q = vec![0.0; poses.starts.len()];
    let mut outcomes = vec![PoseOutcome::default(); POSES];
    let mut run = move || {
        let (targets, starts) = (&poses.targets, &poses.starts);
        let solved = solver.solve_batch(targets, starts, Prefer::First, &mut q, &mut outcomes);
        black_box(&q);
        solved
    };
    run()?;
    Ok(Box::new(move || {
        let _checked_once = run();
    }))
}
