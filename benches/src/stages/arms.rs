//! A redundant arm on a path, and one with unreachable targets.

use std::error::Error;
use std::f64::consts::TAU;
use std::hint::black_box;

use kinopt::Solution;
use kinopt::arm::Arm;
use kinopt::robot::Robot;
use kinopt::spatial::Placement;

use super::{Run, Stage};

/// Number of steps of a path, and of queries of a run.
const STEPS: usize = 1000;
const QUERIES: usize = 20;

pub(super) fn stages() -> Vec<Stage> {
    vec![
        Stage {
            name: "arm of seven joints, track",
            elements: STEPS as u64,
            unit: "step",
            build: track,
        },
        Stage {
            name: "arm of seven joints, target out of reach",
            elements: QUERIES as u64,
            unit: "pose",
            build: out_of_reach,
        },
    ]
}

fn panda() -> Result<Arm, Box<dyn Error>> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/franka_panda.urdf");
    Ok(Arm::builder(&Robot::read(file)?, "base", "flange").build()?)
}

/// Joint values of a closed wave within the limits.
fn wave(arm: &Arm, step: usize) -> Vec<f64> {
    let phase = TAU * step as f64 / STEPS as f64;
    let joints = arm.limits().zip(1..);
    let joints = joints.map(|(limits, times)| {
        let (middle, width) = (
            0.5 * (limits.lower + limits.upper),
            limits.upper - limits.lower,
        );
        middle + 0.3 * width * (phase * f64::from(1 + times % 2)).sin()
    });
    joints.collect()
}

fn track() -> Result<Run, Box<dyn Error>> {
    let arm = panda()?;
    let start = wave(&arm, 0);
    let path = (1..=STEPS).map(|step| arm.base_from_tool(&wave(&arm, step)));
    let path: Vec<Placement<f64>> = path.collect::<Result<_, _>>()?;
    if !arm.track(&path, &start)?.jumps.is_empty() {
        return Err("the path is followed without a jump".into());
    }
    Ok(Box::new(move || {
        let _checked_once = black_box(arm.track(&path, &start));
    }))
}

fn out_of_reach() -> Result<Run, Box<dyn Error>> {
    let arm = panda()?;
    let start = wave(&arm, 0);
    let placements = (1..=QUERIES).map(|k| arm.base_from_tool(&wave(&arm, k * STEPS / QUERIES)));
    let path = placements.map(|placement| {
        placement.map(|placement| Placement::new(placement.rotation, placement.translation * 5.0))
    });
    let path: Vec<Placement<f64>> = path.collect::<Result<_, _>>()?;
    let mut solution = Solution::default();
    arm.solve_into(path[0], &start, &mut solution)?;
    Ok(Box::new(move || {
        for target in &path {
            let _checked_once = black_box(arm.solve_into(*target, &start, &mut solution));
        }
    }))
}
