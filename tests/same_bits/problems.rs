//! Promise: so it is for problems with bounds, weights and origins of their own, and for what is refused of them.
#![allow(clippy::unwrap_used)]

use kinopt::Solver;
use kinopt::ik::Restarts;
use kinopt::model::{Limits, Model, ParameterMap};
use kinopt::problem::{Derivatives, Preferences, Problem, ProblemBuilder};
use kinopt::solver::Stopping;
use kinopt::spatial::Vector3;
use kinopt::task::{FramePose, Point, Posture, Quantity, Task};
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::every_joint::{configuration, frames, map, model, place, vector};
use crate::maps::joints;
use crate::tasks::evaluate;

/// Problems restated: weights, origins, bounds, tolerances.
fn restated() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(133));
    let model = model(&mut random, true);
    let q = configuration(&model, &mut random);
    let [hand, foot] = frames(&model, &["hand", "foot"])[..] else {
        unreachable!()
    };
    let [chest, elbow, plate] = joints(&model, ["chest", "elbow", "plate"]);
    let mut tasks = Problem::builder(&model);
    tasks.add(
        Task::new(FramePose::new(hand, place(&mut random, 0.4)))
            .weight(Quantity::Radians, 0.7)
            .at_level(1),
    );
    tasks.add(
        Task::new(Point::new(foot, vector(&mut random, 0.5)))
            .scale(2.0)
            .named("step"),
    );
    tasks.add(Task::new(Posture::new(&model, &q)).scale(0.1));
    tasks
        .bound(elbow, Limits::new(0.4, 9.0))
        .bound(plate, Limits::new(-1.0, 1.0));
    tasks
        .tolerance(Quantity::Metres, 0.02)
        .derivatives(Derivatives::Dual);
    tasks
        .preferences(Preferences::Traded)
        .parameters(map(&model));
    digest.refusal(tasks.build());
    let mut tasks = Problem::builder(&model);
    tasks.add(
        Task::new(FramePose::new(hand, place(&mut random, 0.4)))
            .weight(Quantity::Radians, 0.7)
            .at_level(1),
    );
    tasks.add(
        Task::new(Point::new(foot, vector(&mut random, 0.5)))
            .scale(2.0)
            .named("step"),
    );
    tasks.add(Task::new(Posture::new(&model, &q)).scale(0.1));
    tasks
        .bound(elbow, Limits::new(0.4, 9.0))
        .bound(plate, Limits::new(-1.0, 1.0))
        .bound(chest, Limits::new(-0.3, 0.1));
    tasks
        .tolerance(Quantity::Metres, 0.02)
        .derivatives(Derivatives::CentralDifference);
    tasks.preferences(Preferences::Traded);
    let problem = tasks.build().unwrap();
    digest.noted(&(
        problem.has_preferences(),
        problem.preferences(),
        problem.derivatives(),
        problem.weights(),
    ));
    digest.noted(&(
        problem.tasks(),
        problem.rows(),
        problem.variables(),
        problem.configuration_len(),
    ));
    let origins = model
        .joint_ids()
        .step_by(2)
        .map(|id| (id, [0.1, -0.2, 0.05]));
    let elsewhere = model.clone().with_joint_origins(origins).unwrap();
    let weighted = problem
        .clone()
        .with_weights(&[0.5, 0.0, 3.0, 1e-200])
        .unwrap();
    let moved = problem.clone().with_joint_origins(&elsewhere).unwrap();
    let both = weighted.clone().with_joint_origins(&elsewhere).unwrap();
    let mut x = vec![0.0; problem.variables()];
    problem.parameters().reduce(&q, &mut x).unwrap();
    for own in [&problem, &weighted, &moved, &both] {
        digest.doubles(own.weights());
        digest.doubles(own.lower().iter().chain(own.upper()).copied());
        let solver = Solver::default().with_restarts(Restarts::default().with_attempts(6));
        let solver = solver.with_stopping(Stopping::default().with_max_iterations(5));
        digest.told(&solver.solve_once(own, &q).unwrap());
        for route in Derivatives::ALL {
            evaluate(&mut digest, &own.clone().with_derivatives(route), &x);
        }
    }
    digest.refusal(problem.clone().with_weights(&[1.0]));
    digest.refusal(problem.clone().with_weights(&[1.0, -1.0, 1.0, 1.0]));
    digest.refusal(problem.clone().with_weights(&[1.0, 1.0, f64::NAN, 1.0]));
    let other = Model::builder("other").build().unwrap();
    digest.refusal(problem.with_joint_origins(&other));
    digest.value()
}

/// What a builder says that has no problem.
fn refused_problems() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(134));
    let model = model(&mut random, false);
    let [chest, hip, plate] = joints(&model, ["chest", "hip", "plate"]);
    let hand = model.frame("hand").unwrap();
    let mut bigger = kinopt::model::ModelBuilder::from_model(&model);
    let foreign = bigger.fixed("more", None, place(&mut random, 0.1));
    let bigger_frame = bigger.frame("lost", None, place(&mut random, 0.1));
    let mut narrow = ParameterMap::builder(&model);
    for joint in model
        .joint_ids()
        .filter(|id| model.coordinate(*id).is_some())
    {
        let own = &model.joints()[joint.index()];
        narrow = match own.kind.is_ball() {
            true => narrow.with_locked_ball(joint, [1.0, 0.0, 0.0, 0.0]),
            false => narrow.with_locked(joint, own.limits.clamp(0.0)),
        };
    }
    let still = narrow.build().unwrap();
    let other = Model::builder("other").build().unwrap();
    let add = |tasks: &mut ProblemBuilder<'_>| {
        tasks.add(Point::new(hand, Vector3::zero()));
    };
    let mut all: Vec<ProblemBuilder<'_>> = (0..9).map(|_| Problem::builder(&model)).collect();
    all[1..].iter_mut().for_each(add);
    all[1].parameters(still);
    all[2].parameters(ParameterMap::free(&other));
    all[3].bound(chest, Limits::new(3.0, 4.0));
    all[4].bound(hip, Limits::new(-1.0, 1.0));
    all[5].bound(plate, Limits::new(1.0, 2.0));
    all[6].bound(foreign, Limits::new(1.0, 2.0));
    all[7].add(Point::new(bigger_frame, Vector3::zero()));
    all[8].tolerance(Quantity::Metres, -1.0);
    for tasks in all {
        digest.refusal(tasks.build());
    }
    digest.value()
}

#[test]
fn of_problems() {
    check(&[
        ("problems restated", restated()),
        ("problems that are refused", refused_problems()),
    ]);
}
