//! Promise: hands keep their places on an object that the subject holds, also on one of another size.

use kinopt::kinematics::ForwardKinematics;
use kinopt::motion::retarget::{
    BodyMap, Capture, HeldObject, ObjectShape, RetargetOptions, Retargeting, UpAxis,
};
use kinopt::spatial::Vector3;
use support::arms::floating_nao;
use support::fault_tables::ExpectedError;

fn steps() -> Capture {
    let read = kinopt::io::bvh::read("../models/captures/steps.bvh").unwrap();
    Capture::of_clip(&read.armature, &read.clip, 30.0).unwrap()
}

/// A box between the hands of the subject, with its y axis along them, in the axes of the capture.
fn object(capture: &Capture, model_shape: Option<ObjectShape>) -> HeldObject {
    let hands = ["LeftHand", "RightHand"].map(|joint| capture.joint(joint).unwrap());
    let positions = |frame: usize| hands.map(|hand| capture.frame(frame).unwrap()[hand]);
    let length = (0..capture.frames()).map(|frame| {
        let [left, right] = positions(frame);
        (left - right).norm()
    });
    let length = length.fold(f64::INFINITY, f64::min);
    let poses = (0..capture.frames()).map(|frame| {
        let [left, right] = positions(frame);
        let (centre, along) = (
            (left + right) * 0.5,
            (left - right) * (1.0 / (left - right).norm()),
        );
        // Smallest rotation of y to the direction between the hands.
        let y = Vector3::UNITS[1];
        let (axis, w) = (y.cross(along), 1.0 + y.dot(along));
        let norm = (axis.dot(axis) + w * w).sqrt();
        let [x, y, z] = centre.to_array();
        [
            x,
            y,
            z,
            w / norm,
            axis.x / norm,
            axis.y / norm,
            axis.z / norm,
        ]
    });
    HeldObject {
        shape: ObjectShape::Box([0.1 * length, 0.98 * length, 0.1 * length]),
        model_shape,
        poses: poses.collect(),
    }
}

#[test]
fn hands_keep_their_places_on_the_object() {
    let robot = floating_nao();
    let model = robot.model();
    let capture = steps();
    let map = BodyMap::guess(&capture, model).unwrap().map;
    let options = RetargetOptions::default().with_up(UpAxis::Y);
    let plain = Retargeting::new(&robot, &map, &capture, options).unwrap();
    let hands = ["LeftHand", "RightHand"].map(|joint| {
        map.drives
            .iter()
            .find(|drive| drive.joint == joint)
            .unwrap()
    });
    let mut kinematics = ForwardKinematics::new(model);
    let joints = ["LeftHand", "RightHand"].map(|joint| capture.joint(joint).unwrap());
    let apart = |frame: usize| {
        let positions = capture.frame(frame).unwrap();
        (positions[joints[0]] - positions[joints[1]]).norm()
    };
    let nearest = (0..capture.frames())
        .map(apart)
        .fold(f64::INFINITY, f64::min);
    let width = 0.2;
    let held = object(&capture, Some(ObjectShape::Box([0.03, width, 0.03])));
    let fitted = plain.clone().with_object(&held, &capture).unwrap();
    assert_eq!(fitted.object_poses().len(), fitted.frames());
    let found = fitted.per_frame().unwrap();
    let mut errors = Vec::new();
    for (frame, (q, pose)) in found.rows().zip(fitted.object_poses()).enumerate() {
        assert!(model.is_within_limits(q));
        // The subject spreads its arms, too, and then holds nothing.
        if apart(frame) > 1.05 * nearest {
            continue;
        }
        let placed = kinematics.place(q).unwrap();
        for (hand, side) in hands.iter().zip([1.0, -1.0]) {
            let frame = model.frame(&hand.frame).unwrap();
            let position = placed[frame.index()].apply(hand.offset);
            let place = pose.inverse().apply(position);
            errors.push((place - Vector3::new(0.0, side * 0.5 * width, 0.0)).norm());
        }
    }
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    assert!(
        errors.len() > 100 && mean < 0.008,
        "{}: {mean} m",
        errors.len()
    );
}

#[test]
fn damaged_objects_are_rejected() {
    let capture = steps();
    let robot = floating_nao();
    let map = BodyMap::guess(&capture, robot.model()).unwrap().map;
    let options = RetargetOptions::default().with_up(UpAxis::Y);
    let plain = Retargeting::new(&robot, &map, &capture, options).unwrap();
    let valid = object(&capture, None);
    let with = |change: &dyn Fn(&mut HeldObject)| {
        let mut damaged = valid.clone();
        change(&mut damaged);
        plain.clone().with_object(&damaged, &capture).map(|_| ())
    };
    with(&|object| object.poses.truncate(3)).says("3 poses, but the capture has 181 frames");
    with(&|object| object.poses[2][3] = 2.0).says("frame 2");
    with(&|object| object.shape = ObjectShape::Ball(0.0)).says("shape");
    HeldObject::from_json(r#"{"shape": {"cone": 1}, "poses": []}"#).says("cone");
}
