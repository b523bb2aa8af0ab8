//! Promise: so it is for drags under options that are drawn at random, led on, held, taken elsewhere and followed to rest in any
//! order: of bodies of every joint under tasks of every kind, and of small arms that are stuck.
#![allow(clippy::unwrap_used)]

use kinopt::Solver;
use kinopt::ik::{Drag, Restarts};
use kinopt::model::Model;
use kinopt::problem::{Problem, TaskId};
use kinopt::solver::Stopping;
use kinopt::spatial::Vector3;
use kinopt::task::{LimitCentring, Point, Posture, Quantity, Task};
use support::methods::solvers;
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::drags::told;
use crate::drawn::one_of;
use crate::every_joint::vector;
use crate::mixed_arms::{INF, rarely};
use crate::mixed_problems::{Body, problem};
use crate::searches::places;
use crate::small_drags::chain;

/// Another method, another limit or a search; a refusal leaves the drag as it was.
fn tuned(mut drag: Drag, random: &mut Random, digest: &mut Digest) -> Drag {
    for _ in 0..random.below(4) {
        let own = drag.clone();
        let steps = Stopping::default().with_max_iterations(one_of(random, &[0, 2, 6, 12]));
        let steps = match random.below(4) {
            0 => steps.with_patience(Some(2)),
            1 => steps.with_gradient_tolerance(1e-3),
            _ => steps,
        };
        let other = match random.below(4) {
            0 => own.with_max_move(one_of(random, &[0.02, 0.4, INF, 1e-13, 1e-13, 0.15, 0.0])),
            1 => {
                let restarts = Restarts::default().with_attempts(one_of(random, &[1, 2, 3]));
                own.with_search(restarts.with_seed(random.bits() % 3))
            }
            2 => own.with_solver(solvers()[random.below(5)].clone(), steps),
            _ => own.with_solver(Solver::default(), steps),
        };
        match other {
            Ok(other) => drag = other,
            Err(error) => digest.text(error.to_string()),
        }
    }
    drag
}

/// Leads a drag about, by so many moves; `from` is where the led point stood.
fn led_about(
    digest: &mut Digest,
    mut drag: Drag,
    (led, from, wide): (TaskId<Point>, Vector3<f64>, f64),
    q: &[f64],
    moves: usize,
    random: &mut Random,
) {
    let mut way = vector(random, wide);
    for _ in 0..moves {
        let share = one_of(random, &[0.0, 0.05, 0.3, 1.0, 1.0, 4.0]);
        if random.below(4) > 0 {
            drag.target_mut(led).unwrap().set_target(from + way * share);
        }
        match random.below(12) {
            0 | 1 => drop(drag.follow(one_of(random, &[0, 1, 3])).q.len()),
            2 | 3 => drop(drag.settle(one_of(random, &[1, 2, 4])).q.len()),
            4 => {
                let mut other = q.to_vec();
                if rarely(random, 3) {
                    other[0] = f64::NAN;
                }
                digest.refusal(drag.set_configuration(&other));
            }
            5 => way = vector(random, wide),
            6 => drag = tuned(drag, random, digest),
            _ => drop(drag.advance().q.len()),
        }
        told(digest, &drag);
    }
}

fn of_bodies(cases: usize) -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(1231));
    for _ in 0..cases {
        let body = Body::new(&mut random);
        let (problem, led) = problem(&body, &mut random, &mut Vec::new());
        let Ok(problem) = problem else {
            continue;
        };
        let start = body.start(&mut random);
        let hand = body.model.frame("hand").unwrap();
        let from = places(&body.model, &start)[hand.index()].translation;
        let drag = Drag::new(problem, &start).unwrap();
        let few = Stopping::default().with_max_iterations(5);
        let drag = drag.with_solver(Solver::default(), few).unwrap();
        let drag = tuned(drag, &mut random, &mut digest);
        led_about(&mut digest, drag, (led, from, 0.6), &body.q, 4, &mut random);
    }
    digest.value()
}

/// What a small arm is asked beside its tip.
fn asked(model: &Model, q: &[f64], random: &mut Random) -> (Problem, TaskId<Point>, Vector3<f64>) {
    let tip = model.frame("tip").unwrap();
    let from = places(model, q)[tip.index()].translation;
    let mut tasks = Problem::builder(model);
    let led = tasks.add(Point::new(tip, from));
    match random.below(6) {
        0 => drop(tasks.add(Posture::new(model, q)).index()),
        1 => {
            let centred = Task::new(LimitCentring::new(model)).scale(0.3).goal();
            tasks.add(centred.tolerance(Quantity::Ratio, one_of(random, &[0.1, 0.6])));
        }
        2 => drop(
            tasks
                .add(Task::new(Point::new(tip, from)).at_level(1))
                .index(),
        ),
        _ => {}
    }
    (tasks.build().unwrap(), led, from)
}

fn of_arms(cases: usize) -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(1232));
    for _ in 0..cases {
        let links = 2 + random.below(5);
        let planar = random.below(2) == 0;
        let limits = one_of(&mut random, &[None, Some(2.5), Some(0.8)]);
        let model = chain(&mut random, links, planar, limits);
        let q = match random.below(3) {
            0 => model.neutral(),
            _ => model.random_configuration(random.bits() % 90),
        };
        let (problem, led, from) = asked(&model, &q, &mut random);
        let drag = tuned(Drag::new(problem, &q).unwrap(), &mut random, &mut digest);
        led_about(&mut digest, drag, (led, from, 1.2), &q, 8, &mut random);
    }
    digest.value()
}

#[test]
fn of_drags_of_bodies() {
    check(&[("drawn drags of bodies", of_bodies(22))]);
}

#[test]
fn of_drags_of_arms() {
    check(&[("drawn drags of arms", of_arms(120))]);
}
