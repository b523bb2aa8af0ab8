//! Promise: so it is for searches of a body with joints of every kind: under all options of restarts,
//! with preferences within goals and traded, and for every word that a solution says of itself.
#![allow(clippy::unwrap_used)]

use std::ops::ControlFlow;

use kinopt::ik::Restarts;
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{FrameId, Model, ParameterMap};
use kinopt::problem::{Derivatives, Preferences, Problem, ProblemBuilder};
use kinopt::solver::{
    Damping, FirstStep, GaussNewton, Iteration, LevenbergMarquardt, ProjectedGradient, Stopping,
};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use kinopt::task::{
    FramePose, Gaze, Inputs, JointCoupling, LimitCentring, Numeric, NumericResidual, Orientation,
    Point, Posture, Quantity, RowBlock, Smoothness, Task,
};
use kinopt::{Solver, Workspace};
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::every_joint::{configuration, frames, map, model, vector};

/// Where the frames of a model are at a configuration.
pub(crate) fn places(model: &Model, q: &[f64]) -> Vec<Placement<f64>> {
    ForwardKinematics::new(model).place(q).unwrap().to_vec()
}

/// Tasks that can be met at a configuration, and those that cannot be: by reach, by limits, by one another.
fn asked(
    tasks: &mut ProblemBuilder<'_>,
    model: &Model,
    case: usize,
    q: &[f64],
    random: &mut Random,
) {
    let at = places(model, q);
    let [hand, foot, head, back] = frames(model, &["hand", "foot", "head", "back"])[..] else {
        unreachable!()
    };
    let [near, low] = [hand, foot].map(|frame| at[frame.index()]);
    let far = vector(random, 0.2);
    match case {
        0 => {
            tasks.add(FramePose::new(hand, near));
            tasks.add(Point::new(foot, low.translation));
        }
        1 => {
            tasks.add(Point::new(hand, near.translation + Vector3::new(0.0, 40.0, 0.0)).at(far));
            tasks.add(Task::new(Orientation::new(foot, low.rotation)).named("stance"));
        }
        2 => {
            tasks.add(Point::new(hand, near.translation));
            tasks.add(Task::new(Point::new(hand, near.translation + far)).scale(0.5));
            tasks.add(Task::new(Posture::new(model, q)).scale(0.1));
        }
        3 => {
            let turned = rotation_exp(vector(random, 2.5)) * at[head.index()].rotation;
            tasks.add(Orientation::new(head, turned).relative_to(back));
            tasks.add(Task::new(FramePose::new(foot, low)).weight(Quantity::Radians, 0.0));
        }
        4 => {
            tasks.add(Task::new(FramePose::new(hand, near)).tolerance(Quantity::Metres, 0.01));
            tasks.add(Task::new(LimitCentring::new(model)).scale(0.2).preference());
            tasks.add(Smoothness::new(model, &model.neutral(), 0.5));
            tasks.preferences(Preferences::Traded);
        }
        5 => {
            tasks.add(Point::new(hand, near.translation + far * 3.0));
            tasks.add(
                Task::new(Posture::new(model, &model.neutral()).by_range(model)).named("rest"),
            );
            tasks.add(Task::new(LimitCentring::new(model)).scale(2.0));
            tasks.preferences(Preferences::Traded);
        }
        6 => {
            tasks.add(Gaze::at(head, [1.0, 0.0, 0.0], far * 9.0, 0.05));
            let joints = ["elbow", "slide"].map(|name| (model.joint(name).unwrap(), 1.0));
            tasks.add(
                Task::new(JointCoupling::new(model, joints, 4.0)).tolerance(Quantity::Radians, 0.1),
            );
        }
        _ => {
            tasks.add(
                Task::new(Posture::new(model, q))
                    .goal()
                    .tolerance(Quantity::JointUnits, 1e-4),
            );
        }
    }
}

pub(crate) fn problems(random: &mut Random, free: bool) -> (Model, Vec<(Problem, Vec<f64>)>) {
    let model = model(random, free);
    let mut all = Vec::new();
    for case in 0..8 {
        for map in [ParameterMap::free(&model), map(&model)] {
            let mut x = vec![0.0; map.variables()];
            let mut q = match random.below(4) {
                0 => configuration(&model, random),
                seed => model.random_configuration(seed as u64),
            };
            map.reduce(&q, &mut x).unwrap();
            map.expand_within_limits(&x, &mut q).unwrap();
            let mut tasks = Problem::builder(&model);
            tasks.parameters(map);
            asked(&mut tasks, &model, case, &q, random);
            all.push((tasks.build().unwrap(), configuration(&model, random)));
        }
    }
    (model, all)
}

fn searches() -> [Value; 2] {
    let (mut by_restarts, mut by_methods) = (Digest::new(), Digest::new());
    let mut random = Random::new(151);
    let mut workspace = Workspace::new();
    let few = Stopping::default();
    let restarts = [
        Restarts::default().with_attempts(6),
        Restarts::none(),
        Restarts::default().with_attempts(3).with_seed(9),
        Restarts::default().with_attempts(7).with_agreeing(2),
        Restarts::default().with_attempts(14).with_steps(40),
    ];
    let methods = [
        Solver::new(LevenbergMarquardt::new(Damping::ErrorProportional)),
        Solver::new(GaussNewton::default()),
        Solver::new(ProjectedGradient::new(FirstStep::BarzilaiBorwein)),
        Solver::new(ProjectedGradient::default()),
    ];
    for free in [false, true] {
        let (_, problems) = problems(&mut random, free);
        for (number, (problem, start)) in problems.iter().enumerate() {
            let restarts = restarts[number % 5].with_seed(number as u64 / 5);
            let solver = Solver::default().with_restarts(restarts);
            let solver = solver.with_stopping(few.with_max_iterations(60 - number));
            by_restarts.bytes(format!("{solver:?} {}", solver.method()));
            by_restarts.told(solver.solve(problem, start, &mut workspace).unwrap());
            let solver = methods[number % 4]
                .clone()
                .with_restarts(Restarts::default().with_attempts(2));
            let stopping = few.with_max_iterations(12).with_patience(Some(5));
            let solver = solver.with_stopping(stopping);
            let route = Derivatives::ALL[number % 4];
            let problem = problem.clone().with_derivatives(route);
            by_methods.told(&solver.solve_once(&problem, start).unwrap());
        }
    }
    [by_restarts.value(), by_methods.value()]
}

/// A residual that is no number past a place.
#[derive(Clone)]
struct Lost(FrameId);

impl NumericResidual for Lost {
    fn inputs(&self) -> Inputs {
        Inputs::frames([self.0])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Pixels, 1)]
    }

    fn evaluate(&self, frames: &[Placement<f64>], _joints: &[f64], residual: &mut [f64]) {
        let x = frames[0].translation.x;
        residual[0] = if x > 1e9 { 0.0 } else { f64::INFINITY };
    }
}

/// Searches that are stopped, that have no number to go by, that may not begin.
fn stopped() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(152));
    let (model, problems) = problems(&mut random, true);
    let mut workspace = Workspace::new();
    let hand = model.frame("hand").unwrap();
    for (problem, start) in &problems[..12] {
        let mut steps = 0;
        let mut stop = |step: &Iteration<'_>| {
            steps += step.index.min(1);
            if steps > 2 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let solver = Solver::default().with_restarts(Restarts::default().with_attempts(3));
        let solution = solver.solve_observed(problem, start, &mut workspace, &mut stop);
        digest.told(solution.unwrap());
        let once = solver.with_stopping(Stopping::default().with_max_iterations(0));
        digest.told(once.solve(problem, start, &mut workspace).unwrap());
        digest.word((workspace.solution().iterations == 0).into());
    }
    for preference in [false, true] {
        let mut tasks = Problem::builder(&model);
        let lost = Task::new(Numeric(Lost(hand))).tolerance(Quantity::Pixels, 1.0);
        tasks.add(if preference { lost.preference() } else { lost });
        tasks.add(Point::new(
            hand,
            places(&model, &problems[0].1)[hand.index()].translation,
        ));
        let problem = tasks.build().unwrap();
        let solver = Solver::default().with_restarts(Restarts::default().with_attempts(2));
        let solution = solver.solve_once(&problem, &problems[0].1).unwrap();
        digest.noted(&(
            solution.termination,
            solution.iterations,
            solution.attempts,
            solution.reached,
        ));
        digest.text(solution.explain());
    }
    let (problem, start) = &problems[0];
    let mut refused =
        |solver: &Solver, start: &[f64]| digest.refusal(solver.solve_once(problem, start));
    let solver = Solver::default();
    refused(&solver, &start[1..]);
    for coordinate in [0, 3, 5] {
        let mut start = start.clone();
        start[coordinate] = f64::NAN;
        refused(&solver, &start);
    }
    for name in ["base/rotation", "waist", "hip"] {
        let mut start = start.clone();
        let at = model.coordinate(model.joint(name).unwrap()).unwrap();
        start[at..at + 4].fill(0.0);
        refused(&solver, &start);
    }
    refused(
        &solver
            .clone()
            .with_restarts(Restarts::default().with_attempts(0)),
        start,
    );
    refused(
        &solver
            .clone()
            .with_restarts(Restarts::default().with_agreeing(0)),
        start,
    );
    refused(
        &solver.with_stopping(Stopping::default().with_step_tolerance(-1.0)),
        start,
    );
    refused(
        &Solver::new(GaussNewton::default().with_rank_tolerance(2.0)),
        start,
    );
    digest.value()
}

#[test]
fn of_searches() {
    let [restarts, methods] = searches();
    check(&[
        ("searches of a body under every kind of restarts", restarts),
        ("searches of a body by every other method", methods),
        ("searches that are stopped", stopped()),
    ]);
}
