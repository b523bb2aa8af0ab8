//! Arm of seven joints of all kinds, and small problems on it.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use kinopt::Problem;
use kinopt::model::{Joint, JointKind, Limits, Model};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Distance, FramePose, Point, Quantity, Task};

const X: Vector3<f64> = Vector3::UNITS[0];
const Y: Vector3<f64> = Vector3::UNITS[1];
const Z: Vector3<f64> = Vector3::UNITS[2];

/// Arm with revolute, continuous and prismatic joints. The last joint is prismatic, from 0 without an upper limit.
pub(crate) fn arm() -> Model {
    let mut builder = Model::builder("bent arm");
    let step = Placement::translation(Vector3::new(0.02, 0.01, 0.25));
    let mut parent = None;
    let joints = [
        (JointKind::Revolute, Z, Limits::new(-2.9, 2.9)),
        (JointKind::Revolute, Y, Limits::new(-1.0, 2.0)),
        (JointKind::Continuous, Z, Limits::UNBOUNDED),
        (JointKind::Revolute, Y, Limits::new(-2.4, -0.1)),
        (JointKind::Revolute, X, Limits::new(-0.5, 0.5)),
        (JointKind::Revolute, Y, Limits::new(-2.0, 2.0)),
        (JointKind::Prismatic, Z, Limits::new(0.0, f64::INFINITY)),
    ];
    for (k, (kind, axis, limits)) in joints.into_iter().enumerate() {
        let name = format!("joint {k}");
        parent = Some(builder.joint(Joint::new(name, parent, step, kind, axis, limits)));
    }
    builder.frame("tip", parent, step);
    builder.frame(
        "side",
        parent,
        Placement::translation(Vector3::new(0.2, 0.0, 0.1)),
    );
    builder.build().unwrap()
}

/// Pose of the tip at a configuration well within the limits, evaluated joint by joint.
pub(crate) fn world_from_tip(model: &Model, q: &[f64]) -> Placement<f64> {
    let mut placement = Placement::identity();
    for (joint, &value) in model.joints().iter().zip(q) {
        let motion = match joint.kind {
            JointKind::Prismatic => Placement::translation(joint.axis * value),
            _ => Placement::new(
                kinopt::spatial::Matrix3::rotation(joint.axis, value.sin_cos()),
                Vector3::zero(),
            ),
        };
        placement = placement * joint.parent_from_joint * motion;
    }
    placement * model.frames()[0].joint_from_frame
}

/// Reachable target pose of the tip.
pub(crate) fn reachable() -> Problem {
    let model = arm();
    let target = world_from_tip(&model, &[0.5, 0.6, -0.4, -1.3, 0.2, 0.9, 0.12]);
    let mut builder = Problem::builder(&model);
    builder.add(FramePose::new(model.frame("tip").unwrap(), target));
    builder.build().unwrap()
}

/// Target point of the tip with many solutions.
pub(crate) fn point_within_reach() -> Problem {
    let model = arm();
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(model.frame("tip").unwrap(), [0.5, 0.3, 0.8]));
    builder.build().unwrap()
}

/// Target of the tip below the floor, outside the limits.
pub(crate) fn held_by_limits() -> Problem {
    let model = arm();
    let mut builder = Problem::builder(&model);
    let tip = model.frame("tip").unwrap();
    builder.add(Point::new(tip, [0.3, 0.2, -0.6]));
    let slide = model.joint("joint 6").unwrap();
    builder.bound(slide, Limits::new(0.0, 0.1));
    let shoulder = model.joint("joint 1").unwrap();
    builder.bound(shoulder, Limits::new(-0.3, 0.4));
    builder.build().unwrap()
}

/// Two points of the last link and a distance.
pub(crate) fn two_tips() -> Problem {
    let model = arm();
    let (tip, side) = (model.frame("tip").unwrap(), model.frame("side").unwrap());
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(tip, [0.5, 0.3, 0.8]));
    builder.add(Task::new(Point::new(side, [0.6, 0.1, 0.7])).weight(Quantity::Metres, 0.7));
    builder.add(Distance::new(tip, side, 0.3));
    builder.build().unwrap()
}

/// Reproducible configurations within the limits; some variables are on a limit.
pub(crate) fn configurations(problem: &Problem, count: usize) -> Vec<Vec<f64>> {
    let range = |k: usize| {
        let (low, high) = (problem.lower()[k], problem.upper()[k]);
        (
            if low.is_finite() { low } else { -3.0 },
            if high.is_finite() { high } else { 2.0 },
        )
    };
    let golden = 0.618_033_988_749_894_9;
    (0..count)
        .map(|index| {
            let share = |k: usize| ((1 + index * 7 + k) as f64 * golden).fract();
            (0..problem.variables())
                .map(|k| {
                    let (low, high) = range(k);
                    match share(k) {
                        share if share < 0.1 => low,
                        share if share > 0.9 => high,
                        share => low + share * (high - low),
                    }
                })
                .collect()
        })
        .collect()
}
