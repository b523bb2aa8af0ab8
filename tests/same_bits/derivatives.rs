//! Promise: so it is for how solutions change with every target, weight and place of a joint, and for whether they do.
#![allow(clippy::unwrap_used)]

use kinopt::ik::{DerivativeWorkspace, Restarts, SolutionDerivative};
use kinopt::model::{Limits, Model, ParameterMap};
use kinopt::problem::{Preferences, Problem, ProblemBuilder, ProblemInstance};
use kinopt::solver::Stopping;
use kinopt::spatial::{Matrix3, Placement, Vector3};
use kinopt::task::{
    Bounded, Camera, CentreOfMass, Distance, FramePose, FrameVelocity, Gaze, JointCoupling, LookAt,
    Orientation, Pixel, Plane, Point, PoseBounds, Posture, Quantity, Ray, Smoothness,
    SupportPolygon, Task,
};
use kinopt::{Solver, Workspace};
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::every_joint::{frames, map, masses, model, vector};
use crate::searches::places;

/// Goals, preferences and rooms of every kind that has a target.
fn everything(
    tasks: &mut ProblemBuilder<'_>,
    model: &Model,
    q: &[f64],
    random: &mut Random,
    part: usize,
) {
    let masses = masses(model, random);
    let at = places(model, q);
    let [foot, hand, back, head] = frames(model, &["foot", "hand", "back", "head"])[..] else {
        unreachable!()
    };
    let [low, near, mid] = [foot, hand, back].map(|frame| at[frame.index()]);
    let (aside, x) = (vector(random, 0.3), Vector3::UNITS[0]);
    match part {
        0 => {
            tasks.add(FramePose::new(foot, low));
            tasks.add(
                Point::new(hand, near.translation + aside)
                    .at(aside)
                    .relative_to(back),
            );
            tasks.add(
                Task::new(Orientation::new(head, Matrix3::identity()).relative_to(hand)).scale(0.3),
            );
        }
        1 => {
            let tool = Placement::new(near.rotation, aside);
            tasks.add(FramePose::new(hand, near).with_tool(tool).relative_to(foot));
            let room = PoseBounds::within([0.1, 0.0, 0.0, 0.3, 0.0, 3.2]);
            tasks.add(FramePose::new(foot, low).with_goal(room));
            tasks.add(Task::new(Posture::new(model, q).by_range(model)).scale(0.2));
        }
        2 => {
            tasks.add(LookAt::new(head, x, near.translation + aside));
            tasks.add(Gaze::at(hand, aside, mid.translation, 0.2));
            tasks.add(Gaze::along(foot, aside, x, 0.4));
            tasks.add(Bounded::new(Plane::new(back, aside, x), 0.05));
            tasks.add(Ray::new(hand, aside, near.translation));
            tasks.add(Posture::new(model, &model.neutral()));
        }
        3 => {
            tasks.add(Distance::new(hand, foot, 0.3));
            let eye = Placement::new(near.rotation, near.translation - near.rotation.z * 3.0);
            let camera = Camera::pinhole(&eye, [50.0, 47.0], [32.0, 24.0]);
            tasks.add(Task::new(Pixel::new(back, camera, [30.0, 20.0])).scale(0.01));
            tasks.add(Task::new(FrameVelocity::new(foot, low, 0.1, (aside, x))).scale(0.1));
            tasks.add(CentreOfMass::new(&masses, aside).relative_to(foot));
            tasks.add(Smoothness::new(model, q, 0.2));
            tasks.preferences(Preferences::Traded);
        }
        4 => {
            // Every number of a posture is a goal.
            tasks.add(
                Task::new(Posture::new(model, q))
                    .goal()
                    .tolerance(Quantity::JointUnits, 1e-3),
            );
            tasks.add(Task::new(Point::new(hand, near.translation)).scale(0.1));
        }
        _ => {
            tasks.add(Task::new(Point::new(foot, low.translation)));
            tasks.add(Task::new(Point::new(hand, near.translation + aside)).at_level(1));
            let joints = ["elbow", "slide"].map(|name| (model.joint(name).unwrap(), 1.0));
            tasks.add(
                Task::new(JointCoupling::new(model, joints, 0.9))
                    .tolerance(Quantity::Radians, 1e-3)
                    .at_level(1),
            );
            tasks.add(
                Task::new(SupportPolygon::new(&masses).with_points([
                    [0.1, 0.2, 0.0],
                    [0.4, -0.2, 0.0],
                    [-0.3, 0.0, 0.0],
                ]))
                .at_level(2),
            );
            tasks.add(Posture::new(model, q).upright(model));
        }
    }
}

fn derivatives() -> [Value; 2] {
    let (mut found, mut existing, mut random) = (Digest::new(), Digest::new(), Random::new(182));
    let mut memory = DerivativeWorkspace::default();
    let mut workspace = Workspace::new();
    for case in 0..18 {
        let model = model(&mut random, case % 2 == 1);
        let map = if case % 3 == 0 {
            ParameterMap::free(&model)
        } else {
            map(&model)
        };
        let (mut x, mut q) = (
            vec![0.0; map.variables()],
            model.random_configuration(case as u64),
        );
        map.reduce(&q, &mut x).unwrap();
        map.expand_within_limits(&x, &mut q).unwrap();
        let mut tasks = Problem::builder(&model);
        tasks.parameters(map);
        everything(&mut tasks, &model, &q, &mut random, case % 6);
        let problem = tasks.build().unwrap();
        let solver = Solver::default().with_restarts(Restarts::default().with_attempts(2));
        let solver = solver.with_stopping(Stopping::default().with_max_iterations(35));
        let solution = solver.solve(&problem, &q, &mut workspace).unwrap();
        let (question, q) = (ProblemInstance::from(&problem), solution.q.clone());
        let own = SolutionDerivative::new(question, &q, &mut memory).unwrap();
        let mut own = if case % 2 == 0 {
            own.with_joint_origins(&model).unwrap()
        } else {
            own
        };
        existing.bytes(format!(
            "{} {} {:?}",
            own.differentiability(),
            own.differentiability().name(),
            own.differentiability()
        ));
        existing.word(own.differentiability().is_unique().into());
        let n = own.degrees_of_freedom();
        let mut rates = own.parameters();
        rates
            .targets_mut()
            .iter_mut()
            .for_each(|v| *v = random.within(-1.0, 1.0));
        rates
            .weights_mut()
            .iter_mut()
            .for_each(|v| *v = random.within(-1.0, 1.0));
        rates
            .joint_origins_mut()
            .iter_mut()
            .for_each(|v| *v = vector(&mut random, 1.0));
        let mut v = vec![0.0; n];
        existing.refusal(own.velocity(&rates, &mut v));
        found.doubles(v.iter().copied());
        let slope: Vec<f64> = (0..n).map(|_| random.within(-1.0, 1.0)).collect();
        let mut gradient = own.parameters();
        existing.refusal(own.gradient(&slope, &mut gradient));
        found.doubles(gradient.targets().iter().chain(gradient.weights()).copied());
        gradient
            .joint_origins()
            .iter()
            .for_each(|v| found.doubles(v.to_array()));
        for task in 0..problem.tasks() {
            found.noted(&gradient.target(task));
            found.doubles(own.by_target(task).unwrap().iter().copied());
        }
        let by_q: Vec<f64> = q.iter().map(|_| random.within(-1.0, 1.0)).collect();
        found.doubles(own.slope_by_velocity(&q, &by_q).unwrap());
        existing.refusal(own.by_target(99));
        existing.refusal(own.velocity(&rates, &mut v[1..]));
        existing.refusal(own.gradient(&slope[1..], &mut gradient));
        existing.refusal(own.slope_by_velocity(&q[1..], &by_q));
        existing.refusal(own.slope_by_velocity(&q, &by_q[1..]));
        gradient.clear();
        existing.noted(&gradient);
        let resumed = SolutionDerivative::resume(&problem, &mut memory);
        existing.noted(&resumed.map(|own| own.differentiability().clone()));
        existing.refusal(SolutionDerivative::new(question, &q[1..], &mut memory));
    }
    [found.value(), existing.value()]
}

/// Where there is no derivative: on limits that nothing pushes to, at the edge of a room, where it is not still.
fn without() -> Value {
    let mut digest = Digest::new();
    let planar = support::planar_arm(&[0.5, 0.4, 0.3], Some((-1.0, 1.5)));
    let tip = planar.frame("tip").unwrap();
    let solver = Solver::default().with_restarts(Restarts::none());
    let mut memory = DerivativeWorkspace::default();
    let ends: [[f64; 3]; 6] = [
        [0.3, 0.4, 0.2],
        [-1.0, 0.4, 0.2],
        [0.3, 1.5, -1.0],
        [0.0, 0.0, 0.0],
        [0.3, 0.4, f64::NAN],
        [1.5, 1.5, 1.5],
    ];
    for q in ends {
        let at = match q[2].is_finite() {
            true => places(&planar, &q)[tip.index()],
            false => Placement::identity(),
        };
        for case in 0..5 {
            let mut tasks = Problem::builder(&planar);
            let to = at.translation;
            match case {
                0 => drop(tasks.add(Point::new(tip, to)).index()),
                1 => drop(tasks.add(Point::new(tip, to * 3.0)).index()),
                2 => {
                    tasks.add(Bounded::at_most(Plane::new(tip, to, [0.0, 1.0, 0.0]), 0.0));
                    tasks.add(Posture::new(&planar, &[0.3, 0.4, 0.2]));
                }
                3 => {
                    tasks.add(Point::new(tip, to));
                    tasks.add(Posture::new(&planar, &[0.1, 0.2, 0.3]));
                }
                _ => {
                    tasks.add(Plane::new(tip, to, [0.0, 1.0, 0.0]));
                    tasks.bound(planar.joint("joint 1").unwrap(), Limits::new(0.4, 1.5));
                }
            }
            let problem = tasks.build().unwrap();
            let solved = solver.solve_once(&problem, &q).map(|own| own.q);
            for q in [Ok(q.to_vec()), solved].into_iter().flatten() {
                let own = SolutionDerivative::new(&problem, &q, &mut memory);
                match own {
                    Ok(mut own) => {
                        digest.bytes(format!(
                            "{} {:?}\n",
                            own.differentiability(),
                            own.differentiability()
                        ));
                        for task in 0..problem.tasks() {
                            digest.doubles(own.by_target(task).unwrap().iter().copied());
                        }
                        let rates = own.parameters();
                        let mut rates = rates;
                        rates.targets_mut().fill(0.3);
                        rates.weights_mut().fill(-0.4);
                        let mut v = [0.0; 3];
                        own.velocity(&rates, &mut v).unwrap();
                        digest.doubles(v);
                        own.gradient(&[0.5, -1.0, 2.0], &mut rates).unwrap();
                        digest.noted(&rates);
                    }
                    Err(error) => digest.refusal(Err::<(), _>(error)),
                }
            }
        }
    }
    digest.value()
}

#[test]
fn of_derivatives() {
    let [found, existing] = derivatives();
    check(&[
        ("how solutions change with everything", found),
        ("whether solutions have a derivative", existing),
        ("where solutions have none", without()),
    ]);
}
