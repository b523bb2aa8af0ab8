//! Promise: so it is for closed-form turns: two bones on every side, CCD and FABRIK on chains that
//! branch, slide, follow and stop, sweep by sweep, and what they refuse.
#![allow(clippy::unwrap_used)]

use std::ops::ControlFlow;

use kinopt::geometric::{Ccd, Elbow, Fabrik, Geometric, TwoBone};
use kinopt::ik::Restarts;
use kinopt::model::{Limits, Model, ParameterMap};
use kinopt::problem::Problem;
use kinopt::solver::{Iteration, Stopping};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use kinopt::task::{FramePose, LookAt, Orientation, Point, PoseBounds, Quantity, Task};
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::every_joint::{configuration, place, vector};
use crate::searches::places;

/// Two arms on a trunk: hinges about skew axes, some at one point, some with an end near, a fixed link; slides if asked for.
fn tree(random: &mut Random, slides: bool) -> Model {
    let mut own = Model::builder("two arms");
    let [x, y, z] = Vector3::UNITS;
    let ends =
        |random: &mut Random| Limits::new(random.within(-2.0, -0.2), random.within(0.2, 2.0));
    let trunk = own.continuous("trunk", None, place(random, 0.3), z);
    let here = Placement::identity();
    let bend = own.revolute("bend", Some(trunk), here, y, ends(random));
    for side in ["left", "right"] {
        let name = |what: &str| format!("{side} {what}");
        let mut last = own.revolute(
            name("swing"),
            Some(bend),
            place(random, 0.3),
            x,
            ends(random),
        );
        last = own.revolute(name("lift"), Some(last), here, y, ends(random));
        last = own.revolute(name("roll"), Some(last), here, z, ends(random));
        if slides {
            let axis = vector(random, 1.0);
            last = own.prismatic(
                name("slide"),
                Some(last),
                place(random, 0.1),
                axis,
                Limits::new(-0.2, 0.3),
            );
        }
        let link = Placement::translation([0.0, 0.0, 0.4].into());
        last = own.revolute(name("elbow"), Some(last), link, y, ends(random));
        last = own.fixed(name("plate"), Some(last), place(random, 0.2));
        last = own.revolute(
            name("wrist"),
            Some(last),
            here,
            vector(random, 1.0),
            ends(random),
        );
        own.frame(name("hand"), Some(last), place(random, 0.2));
        own.frame(name("palm"), Some(last), here);
    }
    own.frame("still", None, here);
    own.build().unwrap()
}

/// The model as it is, with followers, with joints that are locked.
fn maps(model: &Model) -> [ParameterMap; 3] {
    let joint = |name: &str| model.joint(name).unwrap();
    let follows = ParameterMap::builder(model)
        .with_coupled(joint("right elbow"), joint("left elbow"), -0.5, 0.1)
        .with_coupled(joint("right lift"), joint("trunk"), 0.0, 0.2)
        .with_coupled(joint("left roll"), joint("left lift"), 0.7, 0.0);
    let locked = ParameterMap::builder(model)
        .with_locked(joint("bend"), 0.1)
        .with_locked(joint("left lift"), 0.15);
    [
        ParameterMap::free(model),
        follows.build().unwrap(),
        locked.build().unwrap(),
    ]
}

fn asked(model: &Model, map: ParameterMap, case: usize, random: &mut Random) -> Problem {
    let at = places(model, &configuration(model, random));
    let frame = |name: &str| model.frame(name).unwrap();
    let [left, right, palm] = ["left hand", "right hand", "left palm"].map(frame);
    let near = |random: &mut Random, frame: kinopt::model::FrameId| {
        let own = at[frame.index()];
        let size = [0.0, 0.1, 1.5][case % 3];
        Placement::new(
            own.rotation * rotation_exp(vector(random, size)),
            own.translation + vector(random, size),
        )
    };
    let mut tasks = Problem::builder(model);
    tasks.parameters(map);
    match case % 5 {
        0 => drop(
            tasks
                .add(Point::new(left, near(random, left).translation))
                .index(),
        ),
        1 => {
            tasks.add(Point::new(left, near(random, left).translation).at(vector(random, 0.1)));
            tasks.add(Task::new(Point::new(right, near(random, right).translation)).scale(0.5));
        }
        2 => {
            tasks.add(
                Task::new(FramePose::new(left, near(random, left))).weight(Quantity::Radians, 0.2),
            );
        }
        3 => {
            tasks.add(FramePose::new(left, near(random, left)).with_tool(place(random, 0.1)));
            tasks.add(Point::new(frame("still"), vector(random, 0.1)));
        }
        _ => {
            tasks.add(Point::new(palm, near(random, palm).translation));
            tasks.add(Task::new(Point::new(left, vector(random, 1.0))).scale(0.0));
            tasks.add(Point::new(right, near(random, right).translation));
        }
    }
    tasks.build().unwrap()
}

fn told(digest: &mut Digest, method: &dyn Geometric, problem: &Problem, start: &[f64]) {
    digest.text(method.name());
    let mut steps = 0;
    let mut seen = |step: &Iteration<'_>| {
        digest.word(step.index as u64);
        digest.doubles([step.cost, step.step, step.control]);
        digest.doubles(step.projected_gradient);
        digest.doubles(step.x.iter().copied());
        steps += 1;
        if steps > 40 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    match method.solve_question(problem.into(), start, &mut seen) {
        Ok(solution) => digest.told(&solution),
        Err(error) => digest.refusal(Err::<(), _>(error)),
    }
}

fn sweeps() -> [Value; 2] {
    let (mut ccd, mut fabrik, mut random) = (Digest::new(), Digest::new(), Random::new(163));
    for case in 0..30 {
        let model = tree(&mut random, case % 2 == 0);
        for map in maps(&model) {
            let problem = asked(&model, map, case, &mut random);
            let start = configuration(&model, &mut random);
            let stopping = Stopping::default().with_max_iterations(4 + case);
            let stopping = stopping.with_patience(if case % 4 == 0 { Some(3) } else { None });
            let restarts = match case % 3 {
                0 => Restarts::none(),
                1 => Restarts::default().with_attempts(3).with_seed(case as u64),
                _ => Restarts::default()
                    .with_attempts(4)
                    .with_agreeing(2)
                    .with_steps(30),
            };
            let method = Ccd::default()
                .with_stopping(stopping)
                .with_restarts(restarts);
            told(&mut ccd, &method, &problem, &start);
            let method = Fabrik::default()
                .with_stopping(stopping)
                .with_restarts(restarts);
            told(&mut fabrik, &method, &problem, &start);
        }
    }
    [ccd.value(), fabrik.value()]
}

/// Limbs of two bones: a hinge, a hinge about any axis, a shoulder of three hinges, ends that stop it.
fn two_bones() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(164));
    let [x, y, z] = Vector3::UNITS;
    for case in 0..24 {
        let mut own = Model::builder("limb");
        let wide = Limits::new(-3.0, 3.0);
        let shoulder = own.revolute("lift", None, place(&mut random, 0.3), y, wide);
        let here = Placement::identity();
        let mut upper = own.revolute("swing", Some(shoulder), here, z, wide);
        if case % 3 > 0 {
            let axis = if case % 3 == 1 {
                x
            } else {
                vector(&mut random, 1.0)
            };
            upper = own.revolute("roll", Some(upper), here, axis, wide);
        }
        let axis = if case % 2 == 0 {
            z
        } else {
            vector(&mut random, 1.0)
        };
        let ends = if case % 5 == 4 {
            Limits::new(0.2, 0.7)
        } else {
            wide
        };
        let link = Placement::translation([0.5, 0.0, 0.0].into());
        let elbow = own.revolute("elbow", Some(upper), link, axis, ends);
        let at = Placement::translation([0.4, 0.05, 0.0].into());
        let tip = own.frame("tip", Some(elbow), at);
        let model = own.build().unwrap();
        let start = configuration(&model, &mut random);
        for far in [0.3, 0.8, 2.0, 0.01] {
            let root = places(&model, &start)[tip.index()].translation;
            let mut tasks = Problem::builder(&model);
            tasks.add(Point::new(tip, root + vector(&mut random, far)));
            let problem = tasks.build().unwrap();
            for elbow in [
                Elbow::Positive,
                Elbow::Negative,
                Elbow::Towards(vector(&mut random, 1.0)),
            ] {
                told(&mut digest, &TwoBone::new(elbow), &problem, &start);
            }
        }
    }
    digest.value()
}

fn refused() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(165));
    let bodies = [
        tree(&mut random, true),
        tree(&mut random, false),
        crate::every_joint::model(&mut random, false),
    ];
    for model in &bodies {
        let frame = model.frame_ids().nth(2).unwrap();
        let base = model.frame_ids().nth(1).unwrap();
        let at = place(&mut random, 0.3);
        let mut all: Vec<_> = (0..7).map(|_| Problem::builder(model)).collect();
        all[0].add(Point::new(frame, at.translation));
        all[1].add(Orientation::new(frame, at.rotation));
        all[2].add(LookAt::new(frame, [0.0, 0.0, 1.0], at.translation));
        all[3].add(Point::new(frame, at.translation).relative_to(base));
        all[4].add(FramePose::new(frame, at).with_goal(PoseBounds::position()));
        all[5].add(Task::new(FramePose::new(frame, at)).weight(Quantity::Metres, 0.0));
        all[6].add(Task::new(Point::new(frame, at.translation)).named("reach"));
        all[6].add(FramePose::new(base, at).relative_to(frame));
        let start = model.neutral();
        for tasks in all {
            let problem = tasks.build().unwrap();
            digest.refusal(Ccd::default().solve(&problem, &start));
            digest.refusal(Fabrik::default().solve(&problem, &start));
            digest.refusal(TwoBone::new(Elbow::Positive).solve(&problem, &start));
            digest.refusal(Fabrik::default().solve(&problem, &start[1..]));
            let none = Restarts::default().with_attempts(0);
            digest.refusal(Ccd::default().with_restarts(none).solve(&problem, &start));
            let wrong = Stopping::default().with_step_tolerance(-1.0);
            digest.refusal(
                Fabrik::default()
                    .with_stopping(wrong)
                    .solve(&problem, &start),
            );
        }
    }
    digest.value()
}

#[test]
fn of_limbs() {
    let [ccd, fabrik] = sweeps();
    check(&[
        ("trees by CCD, sweep by sweep", ccd),
        ("trees by FABRIK, sweep by sweep", fabrik),
        ("limbs of two bones on every side", two_bones()),
        ("what closed forms refuse", refused()),
    ]);
}
