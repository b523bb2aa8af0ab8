//! Geometric methods: on plain points, and searches of a few sweeps on a skeleton of 22 bones.

use std::error::Error;
use std::hint::black_box;

use kinopt::Problem;
use kinopt::geometric::{Ccd, Elbow, Fabrik, Geometric, TwoBone, fabrik, triangle};
use kinopt::ik::Restarts;
use kinopt::model::{Limits, Model};
use kinopt::solver::Stopping;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::Point;

use super::{Run, Stage, single};
use crate::Sequence;
use crate::figure::five_tips;

const ITERATIONS: usize = 5;
/// Points of the plain chain.
const CHAIN_POINTS: usize = 20;

pub(super) fn stages() -> Vec<Stage> {
    let sweeps = |name, unit, build| Stage {
        name,
        elements: ITERATIONS as u64,
        unit,
        build,
    };
    vec![
        single("two bones, bare", bare_two_bones),
        single("two bones, turn-lift-bend arm, whole solve", two_bones),
        sweeps("CCD sweep, 22 bones, 5 tips", "sweep", || {
            search(
                Ccd::default()
                    .with_stopping(short_stopping())
                    .with_restarts(Restarts::none()),
            )
        }),
        sweeps("FABRIK pass, 22 bones, 5 tips", "pass", || {
            search(
                Fabrik::default()
                    .with_stopping(short_stopping())
                    .with_restarts(Restarts::none()),
            )
        }),
        sweeps("FABRIK pass, bare chain of 20 points", "pass", bare_fabrik),
    ]
}

fn short_stopping() -> Stopping {
    Stopping::default().with_max_iterations(ITERATIONS)
}

fn bare_two_bones() -> Result<Run, Box<dyn Error>> {
    let mut random = Sequence::new(0.5);
    let mut point = || Vector3::new(random.unit(), random.unit(), random.unit());
    let targets: Vec<_> = (0..16).map(|_| [point(), point()]).collect();
    let mut next = 0;
    Ok(Box::new(move || {
        next = (next + 1) % targets.len();
        let [target, pole] = black_box(targets[next]);
        black_box(triangle(Vector3::zero(), [0.9, 0.8], target, pole));
    }))
}

fn two_bones() -> Result<Run, Box<dyn Error>> {
    let mut builder = Model::builder("arm");
    let [x, y, z] = Vector3::UNITS;
    let (still, limits) = (Placement::identity(), Limits::new(-3.0, 3.0));
    let turn = builder.revolute("turn", None, still, z, limits);
    let lift = builder.revolute("lift", Some(turn), still, y, limits);
    let elbow = Placement::translation(x * 0.5);
    let bend = builder.revolute("bend", Some(lift), elbow, y, limits);
    let tip = builder.frame("tip", Some(bend), Placement::translation(x * 0.4));
    let model = builder.build()?;
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(tip, [0.3, 0.4, 0.2]));
    let problem = builder.build()?;
    let solver = TwoBone::new(Elbow::Positive);
    if !solver.solve(&problem, &[0.1, 0.2, 0.3])?.reached {
        return Err("the arm misses its target".into());
    }
    Ok(Box::new(move || {
        let _checked_once = black_box(solver.solve(&problem, &[0.1, 0.2, 0.3]));
    }))
}

fn search(solver: impl Geometric + 'static) -> Result<Run, Box<dyn Error>> {
    let (problem, start) = five_tips()?;
    if solver.solve(&problem, &start)?.iterations != ITERATIONS {
        return Err("the search ends before its sweeps are made".into());
    }
    Ok(Box::new(move || {
        let _checked_once = black_box(solver.solve(&problem, &start));
    }))
}

fn bare_fabrik() -> Result<Run, Box<dyn Error>> {
    let start: Vec<_> = (0..CHAIN_POINTS)
        .map(|k| Vector3::new(0.1 * k as f64, (0.3 * k as f64).sin(), 0.0))
        .collect();
    let mut points = start.clone();
    let target = Vector3::new(0.5, 0.7, 0.9);
    Ok(Box::new(move || {
        points.copy_from_slice(&start);
        black_box(fabrik(&mut points, target, 0.0, ITERATIONS));
    }))
}
