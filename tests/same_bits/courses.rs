//! Promise: so it is for everything that a search of the core counts and says: steps, evaluations, attempts,
//! why it ended, which limits and preferences stand in the way; for drags, frame by frame; for the geometric
//! methods.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use kinopt::geometric::{Ccd, Elbow, Fabrik, Geometric, TwoBone};
use kinopt::ik::{Drag, Restarts};
use kinopt::io::rig::Rig;
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{FrameId, Limits, Model, ParameterMap};
use kinopt::problem::{Derivatives, Preferences, Problem};
use kinopt::solver::{LevenbergMarquardt, Stopping};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{
    Camera, Distance, FramePose, LimitCentring, LookAt, Orientation, Pixel, Plane, Point, Posture,
    Quantity, Ray, Smoothness, Task,
};
use kinopt::{Skeleton, Solver, Workspace};
use support::arms::robot;
use support::methods::solvers;
use support::random::Random;
use support::trees::configuration_of;

use crate::digest::{Digest, Value, check};

fn places(model: &Model, q: &[f64]) -> Vec<Placement<f64>> {
    ForwardKinematics::new(model).place(q).unwrap().to_vec()
}

/// A number within ±`size`, thrice.
fn vector(random: &mut Random, size: f64) -> Vector3<f64> {
    let [x, y, z] = [(); 3].map(|()| random.within(-size, size));
    Vector3::new(x, y, z)
}

/// One task of every kind around a configuration, some reached there, some not.
fn every_task(
    model: &Model,
    map: ParameterMap,
    frames: [FrameId; 2],
    random: &mut Random,
    preferences: Preferences,
) -> Problem {
    let [frame, other] = frames;
    let q = configuration_of(model, random);
    let at = places(model, &q)[frame.index()];
    let near = at.translation + vector(random, 0.1);
    let mut tasks = Problem::builder(model);
    tasks.parameters(map);
    tasks.add(
        Task::new(Point::new(frame, near).at(vector(random, 0.1))).weight(Quantity::Metres, 2.0),
    );
    tasks.add(Task::new(FramePose::new(other, at)).tolerance(Quantity::Radians, 0.3));
    tasks.add(Task::new(LookAt::new(frame, vector(random, 1.0), near)).scale(0.5));
    tasks.add(Task::new(Orientation::new(other, at.rotation)).named("stance"));
    tasks.add(Plane::new(frame, near, vector(random, 1.0)));
    tasks.add(Task::new(Distance::new(frame, other, 0.2)).weight(Quantity::Metres, 0.0));
    tasks.add(Ray::new(other, near + vector(random, 1.0), near));
    let camera = Camera::pinhole(
        &Placement::new(at.rotation, near - at.rotation.z * 3.0),
        [500.0, 480.0],
        [320.0, 240.0],
    );
    tasks.add(Task::new(Pixel::new(frame, camera, [300.0, 200.0])).scale(1e-3));
    tasks.add(Task::new(Posture::new(model, &q)).preference());
    tasks.add(Task::new(Smoothness::new(model, &q, 0.5)).preference());
    tasks.add(Task::new(LimitCentring::new(model)).scale(0.3).preference());
    tasks.preferences(preferences);
    tasks.build().unwrap()
}

/// Joints free, locked, following, narrowed.
fn maps(model: &Model) -> [ParameterMap; 2] {
    let joints = model.moving_joints();
    let [a, b, c, d] = [0, 1, 2, 4].map(|k| joints[k]);
    let limits: Vec<Limits> = model.limits().collect();
    let middle = |k: usize| 0.5 * (limits[k].lower + limits[k].upper);
    let narrow = Limits::new(middle(4), limits[4].upper);
    let mixed = ParameterMap::builder(model)
        .with_locked(a, middle(0))
        .with_narrowed(d, narrow);
    let mixed = mixed.with_coupled(c, b, -0.4, middle(2) + 0.4 * middle(1));
    [ParameterMap::free(model), mixed.build().unwrap()]
}

fn few(attempts: usize) -> Restarts {
    Restarts::default().with_attempts(attempts).with_seed(3)
}

/// Trees of robots under tasks of every kind, by every method and every route of derivatives.
fn every_method() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(11));
    let nao = robot("aldebaran_nao");
    let model = nao.model();
    let frames = ["left_hand", "right_sole"].map(|name| model.frame(name).unwrap());
    for (map, preferences) in maps(model)
        .into_iter()
        .zip([Preferences::WithinGoals, Preferences::Traded])
    {
        let problem = every_task(model, map, frames, &mut random, preferences);
        let start = configuration_of(model, &mut random);
        for (solver, route) in solvers()
            .into_iter()
            .zip(Derivatives::ALL.into_iter().cycle())
        {
            let problem = problem.clone().with_derivatives(route);
            let solver = solver.with_stopping(Stopping::default().with_max_iterations(9));
            let solver = solver.with_restarts(few(2));
            digest.solution(&solver.solve_once(&problem, &start).unwrap());
        }
    }
    digest.value()
}

/// The same tree with poses within reach, poses out of reach and postures within them, to the end.
fn to_the_end() -> [Value; 2] {
    let (mut reached, mut missed, mut random) = (Digest::new(), Digest::new(), Random::new(12));
    let nao = robot("aldebaran_nao");
    let model = nao.model();
    let map = nao.map();
    let [hand, sole] = ["left_hand", "right_sole"].map(|name| model.frame(name).unwrap());
    let mut workspace = Workspace::new();
    for case in 0..8 {
        let q = configuration_of(model, &mut random);
        let (mut x, mut own) = (vec![0.0; map.variables()], q.clone());
        map.reduce(&q, &mut x).unwrap();
        map.expand_within_limits(&x, &mut own).unwrap();
        let at = places(model, &own);
        let far = if case % 2 == 0 { 0.0 } else { 0.5 };
        let mut tasks = Problem::builder(model);
        tasks.parameters(map.clone());
        tasks.add(Point::new(sole, at[sole.index()].translation));
        tasks.add(Point::new(
            hand,
            at[hand.index()].translation + vector(&mut random, far),
        ));
        if case % 4 > 1 {
            tasks.add(Task::new(Posture::new(model, &model.neutral())).preference());
            tasks.add(Task::new(LimitCentring::new(model)).scale(0.1).preference());
        }
        if case == 7 {
            tasks.preferences(Preferences::Traded);
        }
        let problem = tasks.build().unwrap();
        let start = configuration_of(model, &mut random);
        let solver = Solver::default().with_restarts(few(12));
        let solution = solver.solve(&problem, &start, &mut workspace).unwrap();
        let digest = if solution.reached {
            &mut reached
        } else {
            &mut missed
        };
        digest.solution(solution);
        let agreeing = solver.with_restarts(few(6).with_agreeing(2).with_steps(120));
        digest.solution(agreeing.solve(&problem, &start, &mut workspace).unwrap());
    }
    [reached.value(), missed.value()]
}

/// Steps of Levenberg-Marquardt one after the other where the residual stays large and joints stand on limits.
fn slow_steps(rig: &Skeleton) -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(13));
    let start = rig.model().neutral();
    let tips = ["left_hand", "right_hand", "head", "left_foot"];
    let mut tasks = Problem::builder(rig.model());
    for name in tips {
        let tip = rig.tip(rig.bone(name).unwrap());
        tasks.add(Point::new(tip, vector(&mut random, 2.5)));
    }
    let problem = tasks.build().unwrap();
    let solver = Solver::new(LevenbergMarquardt::default()).with_restarts(Restarts::none());
    let mut workspace = Workspace::new();
    let solution = solver.solve_observed(
        &problem,
        &start,
        &mut workspace,
        &mut |step: &kinopt::solver::Iteration<'_>| {
            digest.doubles([step.cost, step.step, step.control]);
            digest.doubles(step.projected_gradient);
            std::ops::ControlFlow::Continue(())
        },
    );
    let solution = solution.unwrap().clone();
    digest.solution(&solution);
    digest.value()
}

/// A figure drawn by a hand out of reach and back, with nudges, and with searches.
fn drags(rig: &Skeleton) -> Value {
    let mut digest = Digest::new();
    let model = rig.model();
    let hand = rig.tip(rig.bone("left_hand").unwrap());
    let feet = ["left_foot", "right_foot"].map(|name| rig.tip(rig.bone(name).unwrap()));
    let rest = model.neutral();
    let stands = places(model, &rest);
    for search in [false, true] {
        let mut tasks = Problem::builder(model);
        let goal = tasks.add(Point::new(hand, stands[hand.index()].translation));
        for foot in feet {
            tasks.add(Point::new(foot, stands[foot.index()].translation));
        }
        if search {
            tasks.add(Task::new(Posture::new(model, &rest)).preference());
        }
        let mut drag = Drag::new(tasks.build().unwrap(), &rest).unwrap();
        if search {
            drag = drag.with_search(few(3)).unwrap();
            drag = drag.with_max_move(0.3).unwrap();
        }
        for frame in 0..24_i32 {
            let out = 0.15 * f64::from((frame - 12).abs());
            let target = stands[hand.index()].translation + Vector3::new(1.6 - out, 0.3, 0.1 * out);
            drag.target_mut(goal).unwrap().set_target(target);
            digest.solution(drag.advance());
            digest.word(u64::from(drag.is_speed_limited()) + 2 * u64::from(drag.is_at_rest()));
            if let Some(leap) = drag.jump() {
                digest.text(leap.joint);
                digest.doubles([leap.distance]);
            }
            digest.doubles(drag.q().iter().copied());
        }
        drag.set_configuration(&rest).unwrap();
        digest.solution(drag.settle(5));
    }
    digest.value()
}

/// Turns about points: reached, missed, with restarts, with the elbow on either side.
fn geometric(rig: &Skeleton) -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(14));
    let model = rig.model();
    let rest = model.neutral();
    let hand = rig.bone("left_hand").unwrap();
    for far in [0.2, 0.4, 3.0] {
        let mut tasks = Problem::builder(model);
        let near = places(model, &rest)[rig.tip(hand).index()].translation;
        tasks.add(Point::new(rig.tip(hand), near + vector(&mut random, far)));
        let problem = tasks.build().unwrap();
        let stopping = Stopping::default().with_max_iterations(12);
        let (ccd, fabrik) = (Ccd::default(), Fabrik::default());
        let ccd = ccd.with_stopping(stopping).with_restarts(few(3));
        let fabrik = fabrik.with_stopping(stopping).with_restarts(few(3));
        digest.solution(&ccd.solve(&problem, &rest).unwrap());
        digest.solution(&fabrik.solve(&problem, &rest).unwrap());
    }
    let planar = support::planar_arm(&[0.5, 0.4], Some((-2.0, 2.5)));
    for (target, elbow) in [
        ([0.3, 0.4, 0.0], Elbow::Positive),
        ([0.3, 0.4, 0.0], Elbow::Negative),
        ([0.05, 0.02, 0.0], Elbow::Negative),
        ([1.3, 0.4, 0.0], Elbow::Towards(Vector3::new(0.0, 1.0, 0.0))),
    ] {
        let mut tasks = Problem::builder(&planar);
        tasks.add(Point::new(planar.frame("tip").unwrap(), target));
        let problem = tasks.build().unwrap();
        digest.solution(&TwoBone::new(elbow).solve(&problem, &[0.1, 0.2]).unwrap());
    }
    digest.value()
}

fn humanoid() -> Rig {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    Rig::read(root.join("../models/humanoid/humanoid.json")).unwrap()
}

#[test]
fn of_every_method() {
    check(&[(
        "a tree under every task by every method, counted",
        every_method(),
    )]);
}

#[test]
fn of_reached_and_missed_goals() {
    let [reached, missed] = to_the_end();
    check(&[
        ("a tree on its goals, counted", reached),
        ("a tree that misses its goals, counted", missed),
        (
            "steps where a residual stays large",
            slow_steps(&humanoid().skeleton),
        ),
    ]);
}

#[test]
fn of_drags_and_turns() {
    let rig = humanoid();
    check(&[
        ("a figure dragged, frame by frame", drags(&rig.skeleton)),
        ("turns about points, counted", geometric(&rig.skeleton)),
    ]);
}
