//! Promise: so it is for whole motions of which several things are asked at once, drawn at random, of models of mixed joints.
#![allow(clippy::unwrap_used)]

use kinopt::model::{BallLimits, JointId, Limits, Model, ModelBuilder, ParameterMap};
use kinopt::motion::trajectory::{
    Contact, MotionProblem, MotionProblemBuilder, MotionSolver, RateCost, Windows,
};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Point, Posture, Quantity, Task};
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::drawn::{at_times, one_of};
use crate::robot_texts::add_text;
use crate::whole_motions::{STEP, solve};

/// A joint of any kind; its name is its number.
fn joint(
    random: &mut Random,
    builder: &mut ModelBuilder,
    number: usize,
    parent: Option<JointId>,
) -> JointId {
    let name = format!("j{number}");
    let (units, at) = (
        Vector3::UNITS,
        Placement::translation(Vector3::new(0.5, 0.1, 0.0)),
    );
    let axis = one_of(random, &units);
    let limits = Limits::new(random.within(-1.5, -0.2), random.within(0.2, 1.5));
    match random.below(6) {
        0 => builder.prismatic(name, parent, at, axis, Limits::new(-0.1, 0.4)),
        1 => builder.continuous(name, parent, at, axis),
        2 => {
            let cone = one_of(
                random,
                &[
                    None,
                    Some(BallLimits::cone(0.7, limits)),
                    Some(BallLimits::within_angle(0.8)),
                ],
            );
            builder.ball(name, parent, at, axis, cone)
        }
        3 if number == 0 => {
            let room = [
                Limits::new(-0.5, 0.6),
                Limits::UNBOUNDED,
                Limits::new(-0.2, 0.3),
            ];
            builder.free(name, parent, at, room)
        }
        _ => builder.revolute(name, parent, at, axis, limits),
    }
}

fn model(random: &mut Random) -> Model {
    let mut builder = Model::builder("drawn");
    let mut parent = None;
    builder.fixed("mount", None, Placement::identity());
    for number in 0..2 + random.below(3) {
        parent = Some(joint(random, &mut builder, number, parent));
    }
    builder.frame(
        "tip",
        parent,
        Placement::translation(Vector3::new(0.4, 0.0, 0.1)),
    );
    builder.frame(
        "mid",
        parent,
        Placement::translation(Vector3::new(0.0, 0.2, 0.0)),
    );
    builder.build().unwrap()
}

fn wave(frame: usize, size: f64) -> [f64; 3] {
    let (sin, cos) = kinopt::Scalar::sin_cos(0.5 * frame as f64 + size);
    [1.2 + size * cos, size * sin, 0.3 * sin]
}

/// A joint's name, of one that moves as a rule.
fn joint_name(random: &mut Random, model: &Model) -> String {
    let odd = ["j0/rotation", "j0/x", "j9", "mount"];
    match at_times(random, 0.1) {
        true => one_of(random, &odd).to_owned(),
        false => {
            let id = one_of(random, model.moving_joints());
            model.joints()[id.index()].name.clone()
        }
    }
}

fn rate_cost(random: &mut Random, model: &Model) -> RateCost {
    let size = one_of(random, &[1e-5, 1e-3, 1e-4, 0.0]);
    let mut cost = match random.below(3) {
        0 => RateCost::velocity(size),
        1 => RateCost::acceleration(size),
        _ => RateCost::jerk(0.1 * size),
    };
    for _ in 0..random.below(3) {
        let factor = one_of(random, &[3.0, 0.0, 0.5]);
        cost = cost.scale(joint_name(random, model).as_str(), factor);
    }
    cost
}

fn map(random: &mut Random, model: &Model) -> ParameterMap {
    let mut builder = ParameterMap::builder(model);
    let hinges = model.moving_joints().iter().filter(|id| {
        let joint = &model.joints()[id.index()];
        joint.kind.coordinates() == 1 && !joint.name.contains('/')
    });
    for id in hinges {
        builder = match random.below(4) {
            0 => builder.with_locked(*id, 0.05),
            1 => builder.with_narrowed(*id, Limits::new(-0.1, 0.15)),
            _ => builder,
        };
    }
    builder.build().unwrap()
}

/// One thing more that is asked.
fn ask(random: &mut Random, model: &Model, frames: usize, motion: &mut MotionProblemBuilder<'_>) {
    let tip = model.frame(one_of(random, &["tip", "mid"])).unwrap();
    match random.below(14) {
        0 | 1 => {
            let speed = one_of(random, &[0.3, 1.0, 4.0]);
            motion.max_speed(joint_name(random, model).as_str(), speed);
        }
        2 if !model.free_joints().is_empty() || at_times(random, 0.1) => {
            let [linear, angular] = [(); 2].map(|()| one_of(random, &[0.4, 1.5, 30.0]));
            motion.max_free_speed("j0", linear, angular);
        }
        3 => {
            let limits = one_of(
                random,
                &[
                    Limits::new(-0.1, 0.2),
                    Limits::new(0.05, 0.05),
                    Limits::new(-9.0, 9.0),
                ],
            );
            motion.bound(joint_name(random, model).as_str(), limits);
        }
        4 => _ = motion.tolerance(Quantity::Metres, one_of(random, &[0.5, 1e-9])),
        5 => _ = motion.rate_cost(rate_cost(random, model)),
        6 | 7 => {
            let first = random.below(frames);
            let most = frames + usize::from(at_times(random, 0.05));
            let last = (first + 2 + random.below(4)).min(most);
            let mut contact = Contact::new(tip, first..last.max(first + 1));
            if at_times(random, 0.5) {
                let points = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.05], [0.0, -0.1, 0.0]];
                contact = contact.at(points[..random.below(4)].to_vec());
            }
            motion.contact(contact);
        }
        8 => _ = motion.first(&model.neutral()),
        9 => _ = motion.last(&model.neutral()),
        10 => _ = motion.parameters(map(random, model)),
        11 => {
            let posture = Task::new(Posture::new(model, &model.neutral())).scale(0.3);
            let posture = match at_times(random, 0.5) {
                true => posture.preference(),
                false => posture,
            };
            motion.add(posture);
        }
        _ => {
            let name = one_of(random, &["second", "third"]);
            let task = motion.add(
                Task::new(Point::new(tip, [1.0, 0.2, 0.1]))
                    .named(name)
                    .scale(0.5),
            );
            let size = random.within(0.1, 0.6);
            if at_times(random, 0.5) {
                motion.follow(task, move |frame, point| {
                    point.set_target(wave(frame, size))
                });
            }
            if at_times(random, 0.6) {
                let count = frames + usize::from(at_times(random, 0.05));
                let weights: Vec<f64> = (0..count)
                    .map(|_| one_of(random, &[0.0, 1.0, 2.5]))
                    .collect();
                motion.weights(task, &weights);
            }
        }
    }
}

fn solver(random: &mut Random) -> MotionSolver {
    let mut solver = MotionSolver::default().with_max_iterations(one_of(random, &[2, 8, 15]));
    if at_times(random, 0.3) {
        solver = solver.with_tolerance(one_of(random, &[0.0, 1e-3, 0.2]));
    }
    if at_times(random, 0.2) {
        solver = solver.with_curvature(false);
    }
    if at_times(random, 0.2) {
        solver = solver.with_slip(one_of(random, &[0.0, 1e-3]));
    }
    if at_times(random, 0.4) {
        let windows = Windows::new(one_of(random, &[1, 3, 5]), one_of(random, &[0, 1, 4]));
        solver = solver.with_windows(Some(windows));
    }
    solver
}

fn motions() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2041));
    for _ in 0..180 {
        let model = model(&mut random);
        let frames = one_of(&mut random, &[1, 2, 4, 7, 9]);
        let mut builder = MotionProblem::builder(&model, frames, STEP);
        let tip = builder.add(Point::new(model.frame("tip").unwrap(), [1.0, 1.0, 0.0]));
        let size = random.within(0.1, 0.8);
        builder.follow(tip, move |frame, point| point.set_target(wave(frame, size)));
        if at_times(&mut random, 0.8) {
            builder.rate_cost(RateCost::acceleration(1e-4));
        }
        for _ in 0..random.below(6) {
            ask(&mut random, &model, frames, &mut builder);
        }
        let Some(motion) = digest.answer(builder.build()) else {
            continue;
        };
        add_text(&mut digest, &format!("{:?}", motion.contacts()));
        let mut start = model.neutral();
        if at_times(&mut random, 0.3) {
            start[0] += 0.1;
        }
        for _ in 0..2 {
            solve(&mut digest, &motion, &start, &solver(&mut random));
        }
        let near = start.repeat(frames - usize::from(at_times(&mut random, 0.1)));
        let mut heard = Vec::new();
        let solved = solver(&mut random)
            .solve_near_with_progress(&motion, &near, &mut |done| heard.push(done));
        if let Some(solved) = digest.answer(solved) {
            digest.doubles(solved.q().iter().copied());
        }
        add_text(&mut digest, &format!("{heard:?}"));
    }
    digest.value()
}

#[test]
fn of_drawn_motions() {
    check(&[("drawn motions", motions())]);
}
