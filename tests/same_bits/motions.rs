//! Promise: so it is for whole motions: configurations, costs, counts and the limits in the way, of hinges within limits of
//! speed and of a free body that only its tasks and rates lead.
#![allow(clippy::unwrap_used)]

use kinopt::model::{Limits, Model};
use kinopt::motion::trajectory::{
    Contact, MotionProblem, MotionSolution, MotionSolver, RateCost, Windows,
};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use kinopt::task::{FramePose, Point};
use support::arms::robot;

use crate::digest::{Digest, Value, check};

fn add(digest: &mut Digest, solved: &MotionSolution) {
    digest.doubles(solved.q().iter().copied());
    digest.doubles([solved.cost(), solved.cost_of_rates(), solved.slip()]);
    let counts = solved.counts();
    for count in [
        solved.iterations(),
        counts.residuals,
        counts.gradients,
        counts.factored_frames,
    ] {
        digest.word(count as u64);
    }
    for frame in 0..solved.frames() {
        for limit in solved.active_limits(frame) {
            digest.text(limit.joint);
            digest.bytes(format!("{:?} {:?}", limit.bound, limit.side));
            digest.doubles([limit.push]);
        }
    }
}

/// Joints too slow for a leap, in two windows, with a frame that stands still and a fixed one.
fn arm_in_a_hurry() -> Value {
    let mut digest = Digest::new();
    let robot = robot("universal_ur5e");
    let model = robot.model();
    let tip = model.frame("flange").unwrap();
    let mut motion = MotionProblem::builder(model, 24, 1.0 / 30.0);
    motion.parameters(robot.map().clone());
    let hand = motion.add(Point::new(tip, [0.4, 0.2, 0.4]));
    motion.follow(hand, |frame, point| {
        point.set_target([0.4, 0.2, if frame < 12 { 0.3 } else { 0.6 }]);
    });
    motion.rate_cost(RateCost::acceleration(1e-4));
    motion.rate_cost(RateCost::jerk(1e-6));
    for joint in robot.map().leaders() {
        let name = &model.joints()[model.moving_joints()[*joint].index()].name;
        motion.max_speed(name, 1.0);
    }
    motion.contact(Contact::new(tip, 16..20));
    let rest = [0.0, -1.2, 1.5, -1.0, -1.5, 0.1];
    motion.first(&rest);
    let motion = motion.build().unwrap();
    let windows = Windows::new(10, 6);
    for windows in [None, Some(windows)] {
        let solver = MotionSolver::default().with_windows(windows);
        add(&mut digest, &solver.solve(&motion, &rest).unwrap());
    }
    digest.value()
}

/// A free body within a room and a limit of speed along one axis.
fn free_body() -> Value {
    let mut digest = Digest::new();
    let mut builder = Model::builder("body");
    let room = [Limits::new(-0.8, 0.9); 3];
    let base = builder.free("base", None, Placement::identity(), room);
    let frame = builder.frame("body", Some(base), Placement::identity());
    let model = builder.build().unwrap();
    let at = |frame: usize| {
        let turns = frame as f64 * 0.2;
        let turned = rotation_exp(Vector3::new(0.05, 0.03, 1.0) * turns);
        Placement::new(turned, Vector3::new(turns.cos(), turns.sin(), 0.5))
    };
    let rates = [
        RateCost::velocity(1e-3),
        RateCost::acceleration(1e-4),
        RateCost::jerk(1e-5),
    ];
    for rate in rates {
        let mut motion = MotionProblem::builder(&model, 30, 1.0 / 60.0);
        let follow = motion.add(FramePose::new(frame, at(0)));
        motion.follow(follow, move |frame, pose| pose.set_target(at(frame)));
        motion.rate_cost(rate);
        motion.max_speed("base/x", 5.0);
        let motion = motion.build().unwrap();
        add(
            &mut digest,
            &MotionSolver::default()
                .solve(&motion, &model.neutral())
                .unwrap(),
        );
    }
    digest.value()
}

#[test]
fn of_whole_motions() {
    check(&[
        (
            "an arm in a hurry, all frames as one and in windows",
            arm_in_a_hurry(),
        ),
        ("a free body led through whole turns", free_body()),
    ]);
}
