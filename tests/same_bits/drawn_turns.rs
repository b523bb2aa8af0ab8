//! Promise: so it is for CCD, FABRIK and the two-bone solution on trees of hinges that are drawn at random, with joints at one
//! point, joints that follow and are locked, several goals by any weights, and limits of every kind on the search.
#![allow(clippy::unwrap_used)]

use std::ops::ControlFlow;

use kinopt::geometric::{Ccd, Elbow, Fabrik, Geometric, TwoBone};
use kinopt::ik::{MoveLimits, Restarts};
use kinopt::model::{FrameId, JointId, Limits, Model, ParameterMap};
use kinopt::problem::{Problem, ProblemInstance};
use kinopt::solver::{Iteration, Stopping};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{FramePose, LookAt, Orientation, Point, Posture, Quantity, Residual, Task};
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::drawn::one_of;
use crate::every_joint::{place, vector};
use crate::mixed_arms::rarely;
use crate::searches::places;

/// A tree of up to nine joints, some at the same point as their parents, and a frame on some of them.
fn tree(random: &mut Random) -> (Model, Vec<JointId>, Vec<FrameId>) {
    let mut own = Model::builder("tree");
    let [x, y, z] = Vector3::UNITS;
    let (mut joints, mut frames) = (Vec::new(), Vec::new());
    let plain = random.below(2) == 0;
    let count = 1 + random.below(9);
    let root = one_of(random, &[0.0, 0.3]);
    for k in 0..count {
        let parent = match k {
            0 => None,
            _ if rarely(random, 5) => Some(joints[random.below(k)]),
            _ => Some(joints[k - 1]),
        };
        let along = match k {
            0 => root,
            _ => one_of(random, &[0.4, 0.3, 0.0, 0.25]),
        };
        let at = Placement::translation([along, 0.0, 0.0].into());
        let axis = match plain {
            true => one_of(random, &[z, z, y, x]),
            false => vector(random, 1.0),
        };
        let name = format!("j{k}");
        let limits = Limits::new(
            one_of(random, &[-3.0, -1.0, -0.1]),
            one_of(random, &[0.2, 2.0, 3.0]),
        );
        joints.push(match random.below(12) {
            0 => own.continuous(name, parent, at, axis),
            1 if rarely(random, 3) => own.prismatic(name, parent, at, axis, limits),
            2 if rarely(random, 4) => own.ball(name, parent, at, axis, None),
            _ => own.revolute(name, parent, at, axis, limits),
        });
        if k + 1 == count || rarely(random, 4) {
            let tip = Placement::new(place(random, 0.1).rotation, [0.2, 0.0, 0.0].into());
            frames.push(own.frame(format!("f{k}"), joints.last().copied(), tip));
        }
    }
    frames.push(own.frame("still", None, Placement::identity()));
    (own.build().unwrap(), joints, frames)
}

/// Joints locked and following, as far as they let themselves.
fn map(model: &Model, joints: &[JointId], random: &mut Random) -> ParameterMap {
    let mut own = ParameterMap::builder(model);
    for _ in 0..random.below(3) {
        let [a, b] = [(); 2].map(|()| joints[random.below(joints.len())]);
        own = match random.below(3) {
            0 => own.with_locked(a, 0.1),
            1 => own.with_coupled(a, b, one_of(random, &[-1.0, 0.5, 2.0]), 0.05),
            _ => own.with_narrowed(a, Limits::new(-0.3, 0.4)),
        };
    }
    own.build().unwrap_or_else(|_| ParameterMap::free(model))
}

fn weighed<R: Residual>(own: R, random: &mut Random) -> Task<R> {
    let quantities: Vec<_> = own.rows().iter().map(|rows| rows.quantity).collect();
    let mut own = Task::new(own);
    for _ in 0..random.below(5) {
        let quantity: Quantity = one_of(random, &quantities);
        own = match random.below(4) {
            0 => own.weight(quantity, one_of(random, &[0.0, 0.2, 3.0])),
            1 => own.tolerance(quantity, one_of(random, &[1e-9, 1e-3, 0.1, 0.3])),
            2 => own.scale(one_of(random, &[0.5, 2.0])),
            _ => own.named("led"),
        };
    }
    own
}

fn asked(
    (model, joints, frames): (&Model, &[JointId], &[FrameId]),
    random: &mut Random,
    digest: &mut Digest,
) -> Option<Problem> {
    let at = places(model, &model.random_configuration(random.bits() % 90));
    let mut tasks = Problem::builder(model);
    tasks.parameters(map(model, joints, random));
    for turn in 0..1 + random.below(3) {
        let frame = match turn {
            0 => frames[frames.len().saturating_sub(2)],
            _ => frames[random.below(frames.len())],
        };
        let size = one_of(random, &[0.0, 0.0, 0.1, 3.0]);
        let off = vector(random, size);
        let to = at[frame.index()].apply(vector(random, 0.0) + off);
        let turned = at[frame.index()].rotation;
        match random.below(12) {
            0 => drop(
                tasks
                    .add(weighed(Orientation::new(frame, turned), random))
                    .index(),
            ),
            1 | 2 => {
                let to = Placement::new(turned, to);
                tasks.add(weighed(
                    FramePose::new(frame, to).with_tool(Vector3::new(0.1, 0.0, 0.05) * size),
                    random,
                ));
            }
            3 | 4 => {
                let own = Point::new(frame, to).at(off);
                tasks.add(weighed(own, random));
            }
            5 if rarely(random, 4) => {
                tasks.add(LookAt::new(frame, [1.0, 0.0, 0.0], off));
            }
            6 if rarely(random, 4) => {
                tasks.add(Posture::new(model, &model.neutral()));
            }
            _ => drop(tasks.add(weighed(Point::new(frame, to), random)).index()),
        }
    }
    match tasks.build() {
        Ok(problem) => Some(problem),
        Err(error) => {
            digest.text(error.to_string());
            None
        }
    }
}

/// One of the methods within limits of every kind.
fn method(random: &mut Random) -> Box<dyn Geometric> {
    let mut stopping = Stopping::default().with_max_iterations(one_of(random, &[0, 1, 6, 15]));
    let mut restarts = Restarts::default().with_attempts(one_of(random, &[1, 1, 2, 5]));
    for _ in 0..random.below(3) {
        match random.below(4) {
            0 => stopping = stopping.with_patience(one_of(random, &[Some(0), Some(2), None])),
            1 => stopping = stopping.with_step_tolerance(one_of(random, &[0.0, 1e-2, -1.0])),
            2 => restarts = restarts.with_agreeing(one_of(random, &[1, 2])),
            _ => restarts = restarts.with_seed(5).with_steps(one_of(random, &[3, 20])),
        }
    }
    let pole = vector(random, 2.0);
    let elbow = one_of(
        random,
        &[Elbow::Positive, Elbow::Negative, Elbow::Towards(pole)],
    );
    match random.below(5) {
        0 | 1 => Box::new(
            Ccd::default()
                .with_stopping(stopping)
                .with_restarts(restarts),
        ),
        2 | 3 => Box::new(
            Fabrik::default()
                .with_stopping(stopping)
                .with_restarts(restarts),
        ),
        _ => Box::new(TwoBone::new(elbow)),
    }
}

fn mixes(cases: usize) -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(1241));
    for _ in 0..cases {
        let (model, joints, frames) = tree(&mut random);
        let of = (&model, &joints[..], &frames[..]);
        let Some(problem) = asked(of, &mut random, &mut digest) else {
            continue;
        };
        for _ in 0..3 {
            let mut start = match random.below(3) {
                0 => model.neutral(),
                _ => model.random_configuration(random.bits() % 90),
            };
            if rarely(&mut random, 30) {
                start[0] = f64::INFINITY;
            }
            let moves = MoveLimits::by_angle(&problem, 0.3, &start);
            let question = match &moves {
                Ok(moves) if rarely(&mut random, 4) => {
                    ProblemInstance::from(&problem).with_moves(moves).unwrap()
                }
                _ => ProblemInstance::from(&problem),
            };
            let method = method(&mut random);
            let most = one_of(&mut random, &[usize::MAX, usize::MAX, 2]);
            let mut seen = Digest::new();
            let mut count = 0;
            let found = method.solve_question(question, &start, &mut |step: &Iteration<'_>| {
                seen.doubles([step.cost, step.step]);
                seen.word(step.index as u64);
                count += 1;
                match count > most {
                    true => ControlFlow::Break(()),
                    false => ControlFlow::Continue(()),
                }
            });
            digest.text(method.name());
            digest.answered(found);
            digest.word(seen.value().numbers);
        }
    }
    digest.value()
}

#[test]
fn of_turns() {
    check(&[("drawn turns about points", mixes(500))]);
}
