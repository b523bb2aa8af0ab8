//! Promise: so it is for closed loops: how they are closed nearest to where a body stands, drawn, told of when they are open, and
//! searched with; and for stances whose knees are bent.
#![allow(clippy::unwrap_used)]

use kinopt::Solver;
use kinopt::ik::{LoopClosure, Restarts, crouched_configuration};
use kinopt::model::{BallLimits, JointId, Limits, Loop, Model, ParameterMap};
use kinopt::problem::Problem;
use kinopt::solver::Stopping;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Point, Posture, Task};
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::every_joint::{configuration, frames, looped, model, place, vector};

/// A bar on a ball and a slide between two posts, welded to one; a crank and a rocker, pinned.
fn linkages(random: &mut Random, welded: bool) -> Model {
    let mut own = Model::builder("linkages");
    let (z, turns) = (Vector3::UNITS[2], Limits::new(-7.0, 7.0));
    let along = |length: f64| Placement::translation([length, 0.0, 0.0].into());
    let crank = own.revolute("crank", None, along(0.0), z, turns);
    let coupler = own.revolute("coupler", Some(crank), along(0.12), z, turns);
    let rocker = own.continuous("rocker", None, along(0.4), z);
    let ends = [
        own.frame("coupler end", Some(coupler), along(0.35)),
        own.frame("rocker end", Some(rocker), along(0.3)),
    ];
    own.close(Loop::connect("pin", ends));
    let cone = BallLimits::cone(1.2, Limits::new(-2.0, 2.0));
    let bar = own.ball("bar", Some(crank), place(random, 0.1), z, Some(cone));
    let rod = own.prismatic(
        "rod",
        Some(bar),
        along(0.1),
        [1.0, 0.0, 0.0],
        Limits::new(0.0, 0.6),
    );
    let end = own.ball("end", Some(rod), along(0.05), z, None);
    let post = own.frame("post", None, along(0.2));
    let tip = own.frame("tip", Some(end), along(0.05));
    let places = [place(random, 0.02), Placement::identity()];
    own.close(match welded {
        true => Loop::weld("tie", [tip, post]).at(places),
        false => Loop::connect("tie", [post, tip]).at(places),
    });
    own.build().unwrap()
}

fn joints(model: &Model, names: &[&str]) -> Vec<JointId> {
    names
        .iter()
        .map(|name| model.joint(name).unwrap())
        .collect()
}

fn closed() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(171));
    for welded in [false, true] {
        let model = linkages(&mut random, welded);
        let names = ["coupler", "rocker", "bar", "rod", "end"];
        let couple = ParameterMap::builder(&model);
        let closure = LoopClosure::new(couple, &joints(&model, &names)).unwrap();
        digest.noted(&closure.dependent());
        for case in 0..8 {
            let mut q = model.random_configuration(case);
            q[0] = 0.4 * case as f64 - 1.5;
            if case % 2 == 1 {
                q[1] += 6.3;
            }
            for gap in closure.gaps(&q).unwrap() {
                digest.bytes(format!("{gap} {gap:?} {}", gap.is_closed()));
            }
            digest.refusal(closure.close(&mut q));
            digest.doubles(q.iter().copied());
            digest.noted(&closure.gaps(&q).unwrap());
        }
        for seed in 0..4 {
            match closure.random_configuration(seed) {
                Ok(q) => digest.doubles(q),
                Err(error) => digest.refusal(Err::<(), _>(error)),
            }
        }
        // Fewer joints than the loops need; joints beyond their limits; no number.
        let few =
            LoopClosure::new(ParameterMap::builder(&model), &joints(&model, &["coupler"])).unwrap();
        let mut q = model.neutral();
        digest.refusal(few.close(&mut q));
        digest.doubles(q.iter().copied());
        digest.refusal(few.random_configuration(1));
        q[0] = 8.0;
        digest.refusal(closure.close(&mut q));
        digest.refusal(closure.close(&mut q[1..]));
        digest.refusal(closure.gaps(&q[1..]));
        q[0] = f64::NAN;
        digest.refusal(closure.close(&mut q));
        digest.refusal(closure.gaps(&q));
        digest.refusal(LoopClosure::new(ParameterMap::builder(&model), &[]));
        let crank = model.joint("crank").unwrap();
        let locked = ParameterMap::builder(&model).with_locked(crank, 9.0);
        digest.refusal(LoopClosure::new(locked, &joints(&model, &names)));
    }
    let open = model(&mut random, false);
    let closure = LoopClosure::new(ParameterMap::builder(&open), &[]).unwrap();
    let mut q = configuration(&open, &mut random);
    digest.refusal(closure.close(&mut q));
    digest.doubles(q.iter().copied());
    digest.doubles(closure.random_configuration(5).unwrap());
    digest.noted(&closure.gaps(&q).unwrap());
    digest.value()
}

/// Goals of bodies whose loops have to close as well.
fn searched() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(172));
    let bodies = [
        linkages(&mut random, false),
        linkages(&mut random, true),
        looped(&mut random),
    ];
    let solver = Solver::default().with_restarts(Restarts::default().with_attempts(3));
    let solver = solver.with_stopping(Stopping::default().with_max_iterations(40));
    for model in &bodies {
        let frame = model.frame_ids().next().unwrap();
        for case in 0..4 {
            let mut tasks = Problem::builder(model);
            tasks.add(Task::new(Point::new(frame, vector(&mut random, 0.3))).at_level(case % 2));
            if case > 1 {
                tasks.add(Posture::new(model, &model.neutral()));
            }
            let problem = tasks.build().unwrap();
            for k in 0..problem.tasks() {
                digest.noted(&problem.task_name(k));
            }
            let start = model.random_configuration(case as u64);
            digest.told(&solver.solve_once(&problem, &start).unwrap());
        }
    }
    digest.value()
}

fn stances() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(173));
    for free in [true, false] {
        let mut grown = crate::every_joint::builder(&mut random, free);
        if free {
            let base = grown
                .clone()
                .build()
                .unwrap()
                .joint("base/rotation")
                .unwrap();
            grown.frame("trunk", Some(base), place(&mut random, 0.1));
        }
        let model = grown.build().unwrap();
        let feet = frames(&model, &["foot"]);
        let both = frames(&model, &["foot", "hand"]);
        let map = ParameterMap::free(&model);
        for (feet, up) in [
            (&feet, [0.0, 0.0, 2.0]),
            (&both, [0.0, 1.0, 0.0]),
            (&Vec::new(), [0.0, 0.0, 1.0]),
        ] {
            let q = model.random_configuration(3);
            digest.doubles(crouched_configuration(&model, &map, feet, &q, up).unwrap());
            digest.refusal(crouched_configuration(&model, &map, feet, &q[1..], up));
        }
    }
    digest.value()
}

#[test]
fn of_loops() {
    check(&[
        ("loops closed, drawn and told of", closed()),
        ("bodies with loops on their goals", searched()),
        ("stances whose knees are bent", stances()),
    ]);
}
