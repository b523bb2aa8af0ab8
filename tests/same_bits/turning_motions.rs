//! Promise: so it is for whole motions of balls within cones, twists and angles, of free bodies within rooms, at their speeds, and of
//! linkages that stay closed.
#![allow(clippy::unwrap_used)]

use kinopt::model::{BallLimits, JointId, Limits, Loop, Model, ModelBuilder};
use kinopt::motion::trajectory::{MotionError, MotionProblem, MotionSolver, RateCost, Windows};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use kinopt::task::{FramePose, Point};

use crate::digest::{Digest, Value, check};
use crate::robot_texts::add_error;
use crate::whole_motions::{Ask, STEP, solve};

/// A body that is led by two frames of it, along turns and ways.
fn led(
    model: &Model,
    frames: usize,
    [turn, way]: [Vector3<f64>; 2],
    ask: Ask<'_>,
) -> Result<MotionProblem, MotionError> {
    let mut motion = MotionProblem::builder(model, frames, STEP);
    let tip = model.frame("tip").unwrap();
    let at = move |frame: usize| {
        let (sin, cos) = kinopt::Scalar::sin_cos(0.5 * frame as f64);
        Placement::new(rotation_exp(turn * (sin + 0.2 * frame as f64)), way * cos)
    };
    let pose = motion.add(FramePose::new(tip, at(0)));
    motion.follow(pose, move |frame, pose| pose.set_target(at(frame)));
    motion.rate_cost(RateCost::acceleration(1e-4));
    ask(&mut motion);
    motion.build()
}

fn one(add: impl Fn(&mut ModelBuilder) -> JointId) -> Model {
    let mut builder = Model::builder("one");
    let joint = add(&mut builder);
    let at = Placement::translation(Vector3::new(0.2, 0.1, 0.0));
    builder.frame("tip", Some(joint), at);
    builder.build().unwrap()
}

/// Balls under each kind of limit, free bodies, planar ones.
fn turning() -> Value {
    let mut digest = Digest::new();
    let here = Placement::identity();
    let x = Vector3::UNITS[0];
    let twist = Limits::new(-0.4, 0.7);
    let balls = [
        None,
        Some(BallLimits::cone(0.6, twist)),
        Some(BallLimits::within_angle(0.9)),
        Some(BallLimits::elliptic(Vector3::UNITS[1], [0.3, 0.9], twist)),
        Some(BallLimits::cone(0.8, twist).with_angle(0.5)),
    ];
    let ways = [Vector3::new(0.3, 0.8, -0.5), Vector3::new(0.4, -0.2, 0.3)];
    let solver = MotionSolver::default();
    for limits in balls {
        let model = one(|builder| builder.ball("ball", None, here, x, limits));
        let q = model.neutral();
        let asks: [Ask<'_>; 3] = [
            &|_| {},
            &|motion| {
                _ = motion
                    .max_speed("ball", 2.0)
                    .rate_cost(RateCost::jerk(1e-5).scale("ball", 2.0))
            },
            &|motion| _ = motion.first(&q).max_speed("ball", 3.0),
        ];
        for ask in asks {
            let motion = led(&model, 14, ways, ask).unwrap();
            solve(&mut digest, &motion, &q, &solver);
        }
        // From one end to another that few frames lead to.
        for (frames, speed) in [(6, 3.0), (9, 1.0), (4, 1.0)] {
            let turned = [0.98, 0.05, 0.1, -0.12];
            let motion = led(&model, frames, ways, &|motion| {
                motion.first(&q).last(&turned).max_speed("ball", speed);
            });
            solve(&mut digest, &motion.unwrap(), &q, &solver);
        }
        for turned in [
            [0.7, 0.7, 0.1, 0.1],
            [0.9, 0.0, 0.4, 0.0],
            [0.9, 0.0, 0.0, -0.45],
        ] {
            match led(&model, 6, ways, &|motion| _ = motion.last(&turned)) {
                Ok(motion) => solve(&mut digest, &motion, &q, &solver),
                Err(error) => add_error(&mut digest, &error),
            }
        }
    }
    let room = [
        Limits::new(-0.3, 0.35),
        Limits::UNBOUNDED,
        Limits::new(-1.0, 0.2),
    ];
    let free = one(|builder| builder.free("base", None, here, room));
    let planar = one(|builder| {
        builder.planar(
            "base",
            None,
            here,
            Vector3::UNITS[2],
            [room[0], room[1]],
            Limits::new(-0.5, 0.5),
        )
    });
    let there = [0.2, 0.3, -0.1, 0.98, 0.05, 0.1, -0.12];
    let still = free.neutral();
    let asks: [Ask<'_>; 5] = [
        &|motion| {
            _ = motion
                .max_free_speed("base", 0.8, 1.5)
                .first(&still)
                .last(&there)
        },
        &|motion| _ = motion.max_free_speed("base", 0.8, 1.5),
        &|motion| {
            _ = motion
                .max_free_speed("base", 1.5, 40.0)
                .max_speed("base/z", 0.3)
        },
        &|motion| _ = motion.max_free_speed("base", 0.0, 1.0),
        &|motion| _ = motion.max_free_speed("bas", 1.0, 1.0),
    ];
    for ask in asks {
        match led(&free, 14, ways, ask) {
            Ok(motion) => {
                solve(&mut digest, &motion, &free.neutral(), &solver);
                let windows = solver.clone().with_windows(Some(Windows::new(5, 4)));
                solve(&mut digest, &motion, &free.neutral(), &windows);
            }
            Err(error) => add_error(&mut digest, &error),
        }
    }
    let motion = led(&planar, 14, ways, &|motion| {
        _ = motion.max_speed("base/yaw", 1.0).max_speed("base/x", 0.5)
    });
    solve(&mut digest, &motion.unwrap(), &planar.neutral(), &solver);
    digest.value()
}

/// Linkages of both kinds, closed in every frame, or never.
fn loops() -> Value {
    let mut digest = Digest::new();
    let z = Vector3::UNITS[2];
    let along = |length: f64| Placement::translation(Vector3::new(length, 0.0, 0.0));
    for weld in [false, true] {
        for rocker_limits in [Limits::new(-3.2, 3.2), Limits::new(0.5, 1.1)] {
            let mut builder = Model::builder("four bars");
            let any = Limits::new(-3.2, 3.2);
            let crank = builder.revolute("crank", None, along(0.0), z, any);
            let coupler = builder.revolute("coupler", Some(crank), along(0.3), z, any);
            let rocker = builder.revolute("rocker", None, along(0.4), z, rocker_limits);
            let wrist = builder.revolute("wrist", Some(rocker), along(0.3), z, any);
            builder.frame("tip", Some(coupler), along(0.2));
            let end = builder.frame("coupler end", Some(coupler), along(0.4));
            let other = builder.frame("wrist", Some(wrist), along(0.0));
            builder.close(match weld {
                true => Loop::weld("pin", [end, other]),
                false => Loop::connect("pin", [end, other]),
            });
            let model = builder.build().unwrap();
            let mut motion = MotionProblem::builder(&model, 12, STEP);
            let tip = motion.add(Point::new(model.frame("tip").unwrap(), [0.0; 3]));
            motion.follow(tip, |frame, point| {
                let (sin, cos) = kinopt::Scalar::sin_cos(0.6 + 0.02 * (frame * frame) as f64);
                point.set_target([0.2 + 0.3 * cos, 0.3 * sin, 0.0]);
            });
            motion
                .rate_cost(RateCost::acceleration(1e-4))
                .max_speed("crank", 5.0);
            let motion = motion.build().unwrap();
            let start = [0.8, -0.8, 0.8, -0.8];
            for solver in [
                MotionSolver::default(),
                MotionSolver::default().with_windows(Some(Windows::new(5, 3))),
                MotionSolver::default().with_slip(1e-4),
            ] {
                solve(&mut digest, &motion, &start, &solver);
            }
        }
    }
    digest.value()
}

#[test]
fn of_motions_that_turn_and_close() {
    check(&[
        ("motions of balls and free bodies", turning()),
        ("motions of linkages", loops()),
    ]);
}
