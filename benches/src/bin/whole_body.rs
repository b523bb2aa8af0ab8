//! How often and how fast a humanoid on a free base puts both hands where it can while its feet stay:
//! `cargo run --release -p kinopt-benches --bin whole_body -- ROBOT.urdf LEFT_FOOT,RIGHT_FOOT LEFT_HAND,RIGHT_HAND [problems]`.
//!
//! What it can: a configuration drawn at random within limits, whose feet the solver has put where they stand
//! at neutral. Asked from neutral and from within 0.3 rad of that; beside it, in the same run, a figure of 22
//! bones with five tips from within 0.3 rad.
#![allow(clippy::print_stdout)]

use std::error::Error;

use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{FrameId, Model};
use kinopt::robot::{BaseJoint, Robot};
use kinopt::spatial::Placement;
use kinopt::task::{Point, Pose};
use kinopt::{Problem, Solver, Workspace};
use kinopt_benches::{Sequence, ThreadTime, figure, random_targets};

const NEAR: f64 = 0.3;

/// Frames that should be at poses.
fn problem(model: &Model, goals: &[(FrameId, Placement<f64>)]) -> Result<Problem, Box<dyn Error>> {
    let mut builder = Problem::builder(model);
    for &(frame, at) in goals {
        builder.add(Pose::new(frame, at));
    }
    Ok(builder.build()?)
}

/// Every number of a velocity up to so far either way.
fn beside(model: &Model, q: &[f64], sequence: &mut Sequence) -> Result<Vec<f64>, Box<dyn Error>> {
    let v: Vec<f64> = (0..model.degrees_of_freedom())
        .map(|_| NEAR * (2.0 * sequence.unit() - 1.0))
        .collect();
    let mut moved = q.to_vec();
    model.integrate(q, &v, &mut moved)?;
    Ok(moved)
}

/// Reached of all, median and 99th percentile in µs.
fn told(name: &str, mut micros: Vec<f64>, reached: usize) -> f64 {
    let all = micros.len();
    micros.sort_by(f64::total_cmp);
    let at = |share: f64| micros[((all - 1) as f64 * share) as usize];
    let (median, p99) = (at(0.5), at(0.99));
    let percent = 100.0 * reached as f64 / all as f64;
    println!(
        "{name:<34} {reached:>5} of {all} ({percent:.1} %), median {median:.1} us, p99 {p99:.1} us"
    );
    median
}

fn bones(count: usize) -> Result<f64, Box<dyn Error>> {
    let (skeleton, tips) = figure(2, 4);
    let targets = random_targets(&skeleton, &tips, count, &mut Sequence::new(0.5));
    let model = skeleton.model();
    let (mut micros, mut reached) = (Vec::new(), 0);
    let (mut workspace, solver) = (Workspace::new(), Solver::default());
    let mut sequence = Sequence::new(0.25);
    for target in &targets {
        let mut builder = Problem::builder(model);
        for (&tip, &at) in tips.iter().zip(target) {
            builder.add(Point::new(skeleton.tip(tip), at));
        }
        let problem = builder.build()?;
        let there = solver
            .solve(&problem, &model.neutral(), &mut workspace)?
            .q
            .clone();
        let start = beside(model, &there, &mut sequence)?;
        let begun = ThreadTime::now();
        let solution = solver.solve(&problem, &start, &mut workspace)?;
        micros.push(begun.micros());
        reached += usize::from(solution.reached);
    }
    Ok(told("22 bones, five tips, from near", micros, reached))
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [path, feet, hands, rest @ ..] = arguments.as_slice() else {
        return Err("ROBOT.urdf LEFT_FOOT,RIGHT_FOOT LEFT_HAND,RIGHT_HAND [problems]".into());
    };
    let count: u64 = rest.first().map_or(Ok(200), |count| count.parse())?;
    let robot = Robot::reader().lenient().read(path)?;
    let robot = robot.with_base_joint(BaseJoint::FREE)?;
    let model = robot.model();
    let named = |names: &str| -> Result<Vec<FrameId>, Box<dyn Error>> {
        names
            .split(',')
            .map(|name| Ok(model.frame(name)?))
            .collect()
    };
    let (feet, hands) = (named(feet)?, named(hands)?);
    let neutral = model.neutral();
    let mut kinematics = ForwardKinematics::new(model);
    let standing = kinematics.place(&neutral)?.to_vec();
    let stand: Vec<_> = feet
        .iter()
        .map(|&foot| (foot, standing[foot.index()]))
        .collect();
    let (mut workspace, solver) = (Workspace::new(), Solver::default());
    let mut sequence = Sequence::new(0.75);
    let [mut micros, mut reached] = [[Vec::new(), Vec::new()], [Vec::new(), Vec::new()]];
    for seed in 0..count {
        let mut drawn = model.random_configuration(seed);
        drawn[..7].copy_from_slice(&neutral[..7]);
        let on_feet = problem(model, &stand)?;
        let solution = solver.solve(&on_feet, &drawn, &mut workspace)?;
        if !solution.reached {
            continue;
        }
        let there = solution.q.clone();
        let placed = kinematics.place(&there)?.to_vec();
        let mut goals = stand.clone();
        goals.extend(hands.iter().map(|&hand| (hand, placed[hand.index()])));
        let asked = problem(model, &goals)?;
        let near = beside(model, &there, &mut sequence)?;
        for (k, start) in [&near, &neutral].into_iter().enumerate() {
            solver.solve(&asked, start, &mut workspace)?;
            let begun = ThreadTime::now();
            let solution = solver.solve(&asked, start, &mut workspace)?;
            micros[k].push(begun.micros());
            reached[k].push(f64::from(u8::from(solution.reached)));
        }
    }
    println!(
        "{}: {} degrees of freedom",
        robot.name(),
        model.degrees_of_freedom()
    );
    let [near, standing] = micros;
    let sums = reached.map(|all| all.iter().sum::<f64>() as usize);
    let near = told("hands and feet, from near", near, sums[0]);
    let standing = told("hands and feet, from standing", standing, sums[1]);
    let bones = bones(count as usize)?;
    println!(
        "from near {:.2} times the bones, from standing {:.2} times",
        near / bones,
        standing / bones
    );
    Ok(())
}
