//! Promise: `by_range` weights each joint by half its range. `upright` weights root-chain joints five times as much as
//! limbs, whatever additional frames the model has.

use kinopt::model::{BallLimits, Limits, Model};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::Posture;

fn at(x: f64, y: f64, z: f64) -> Placement<f64> {
    Placement::translation(Vector3::new(x, y, z))
}

#[test]
fn by_range_weights_by_half_the_range() {
    let mut builder = Model::builder("joints");
    let z = Vector3::UNITS[2];
    let cone = BallLimits::cone(0.25, Limits::new(-1.5, 1.5));
    // Of an ellipse the larger half-axis counts.
    let [flat, steep] = [[0.5, 0.25], [0.25, 0.5]]
        .map(|swing| BallLimits::elliptic([1.0, 0.0, 0.0], swing, Limits::new(-1.5, 1.5)));
    let hinge = builder.revolute("hinge", None, at(0.0, 0.0, 0.0), z, Limits::new(-1.0, 3.0));
    let endless = builder.continuous("endless", Some(hinge), at(0.5, 0.0, 0.0), z);
    let short = builder.prismatic(
        "short",
        Some(endless),
        at(0.25, 0.0, 0.0),
        z,
        Limits::new(0.0, 0.5),
    );
    let long = builder.prismatic("long", Some(short), at(0.0, 0.0, 0.0), z, Limits::UNBOUNDED);
    let mut last = long;
    for (name, limits) in [("round", cone), ("flat", flat), ("steep", steep)] {
        last = builder.ball(name, Some(last), at(0.0, 0.0, 0.0), z, Some(limits));
    }
    builder.frame("tip", Some(last), at(0.25, 0.0, 0.0));
    let model = builder.build().unwrap();
    let rest = model.neutral();
    let half_turn = std::f64::consts::PI;
    let halves = [2.0, half_turn, 0.25, model.reach(), 0.25, 0.5, 0.5];
    let expected = Posture::new(&model, &rest).with_weights(halves.map(|half| 1.0 / half));
    assert_eq!(Posture::new(&model, &rest).by_range(&model), expected);
}

/// A spine of two joints with two arms of shoulder, elbow and hand on a base with two legs. Optional frames of a camera
/// and a bolt in each elbow, before or after the hand. Lengths scale with `size`.
fn body(size: f64, before: bool, after: bool) -> Model {
    let at = |x: f64, y: f64, z: f64| at(size * x, size * y, size * z);
    let mut builder = Model::builder("body");
    let [x, y, _] = Vector3::UNITS;
    let limits = Limits::new(-2.0, 2.0);
    let pelvis = builder.revolute("pelvis", None, at(0.0, 0.0, 0.0), x, limits);
    for (name, side) in [("left leg", 0.1), ("right leg", -0.1)] {
        let hip = builder.revolute(
            format!("{name} hip"),
            Some(pelvis),
            at(0.0, side, 0.0),
            y,
            limits,
        );
        let knee = builder.revolute(
            format!("{name} knee"),
            Some(hip),
            at(0.0, 0.0, -0.5),
            y,
            limits,
        );
        builder.frame(format!("{name} foot"), Some(knee), at(0.0, 0.0, -0.5));
    }
    let waist = builder.revolute("waist", Some(pelvis), at(0.0, 0.0, 0.05), x, limits);
    let back = builder.revolute("back", Some(waist), at(0.0, 0.0, 0.05), y, limits);
    for (name, side) in [("left arm", 0.05), ("right arm", -0.05)] {
        let shoulder = builder.revolute(
            format!("{name} shoulder"),
            Some(back),
            at(0.0, side, 0.0),
            y,
            limits,
        );
        let elbow = builder.revolute(
            format!("{name} elbow"),
            Some(shoulder),
            at(0.0, 0.0, 0.05),
            y,
            limits,
        );
        if before {
            builder.frame(format!("{name} camera"), Some(elbow), at(0.01, 0.0, 0.0));
        }
        builder.frame(format!("{name} hand"), Some(elbow), at(0.0, 0.0, 0.4));
        if after {
            builder.frame(format!("{name} bolt"), Some(elbow), at(0.0, 0.01, 0.0));
        }
    }
    builder.build().unwrap()
}

#[test]
fn upright_ignores_additional_frames() {
    for (before, after) in [(false, false), (true, false), (false, true), (true, true)] {
        for size in [0.01, 1.0, 100.0] {
            let model = body(size, before, after);
            let stiff = ["pelvis", "waist", "back"].map(|name| model.joint(name).unwrap());
            let joints = model.moving_joints().iter();
            let weights = joints.map(|joint| if stiff.contains(joint) { 5.0 } else { 1.0 });
            let posture = Posture::new(&model, &model.neutral());
            let expected = posture.clone().with_weights(weights);
            assert_eq!(posture.upright(&model), expected, "{size} {before} {after}");
        }
    }
}

/// The length of a limb is relative to the whole body, from its root.
#[test]
fn fingers_of_a_long_arm_are_no_limbs() {
    let mut builder = Model::builder("arm");
    let [x, y, _] = Vector3::UNITS;
    let limits = Limits::new(-2.0, 2.0);
    let shoulder = builder.revolute("shoulder", None, at(0.0, 0.0, 0.0), x, limits);
    let wrist = builder.revolute("wrist", Some(shoulder), at(0.0, 0.0, 1.0), y, limits);
    for (name, side) in [("thumb", 0.02), ("finger", -0.02)] {
        let placement = at(0.0, side, 0.0);
        let first = builder.revolute(format!("{name} 1"), Some(wrist), placement, x, limits);
        let placement = at(0.0, 0.0, 0.1);
        let second = builder.revolute(format!("{name} 2"), Some(first), placement, x, limits);
        builder.frame(name, Some(second), at(0.0, 0.0, 0.1));
    }
    let model = builder.build().unwrap();
    let posture = Posture::new(&model, &model.neutral());
    let expected = posture.clone().with_weights([1.0; 6]);
    assert_eq!(posture.upright(&model), expected);
}
