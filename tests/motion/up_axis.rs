//! Promise: the up axis of a captured body is detected, and nothing is reported if it is uncertain.

use kinopt::io::bvh;
use kinopt::motion::retarget::{Capture, UpAxis};

/// Subject of three joints as BVH: offsets from the hips to the feet along `-axis`, frames with the hips' rotation
/// about x.
fn person(axis: usize, turns: &[f64]) -> Capture {
    let foot = |side: &str, x: f64| {
        let mut offset = [x, 0.0, 0.0];
        offset[axis] = -90.0;
        let [x, y, z] = offset;
        format!(
            "JOINT {side}Foot {{ OFFSET {x} {y} {z} CHANNELS 1 Xrotation End Site {{ OFFSET 0 0 1 }} }} "
        )
    };
    let rows: Vec<String> = turns.iter().map(|turn| format!("{turn} 0 0")).collect();
    let text = format!(
        "HIERARCHY ROOT Hips\n{{ OFFSET 0 0 0 CHANNELS 1 Xrotation {}{} }}\nMOTION\nFrames: {}\nFrame Time: 0.1\n{}\n",
        foot("Left", 10.0).replace(" {", "\n{"),
        foot("Right", -10.0).replace(" {", "\n{"),
        turns.len(),
        rows.join("\n")
    );
    let read = bvh::from_bytes(text.as_bytes(), "person.bvh").unwrap();
    Capture::of_clip(&read.armature, &read.clip, 10.0).unwrap()
}

#[test]
fn standing_body_shows_the_axis() {
    assert_eq!(person(1, &[0.0, 5.0, -5.0]).up_axis(), Some(UpAxis::Y));
    assert_eq!(person(2, &[0.0, 5.0, -5.0]).up_axis(), Some(UpAxis::Z));
    let steps = bvh::read("../models/captures/steps.bvh").unwrap();
    let capture = Capture::of_clip(&steps.armature, &steps.clip, 10.0).unwrap();
    assert_eq!(capture.up_axis(), Some(UpAxis::Y));
}

#[test]
fn lying_body_shows_no_axis() {
    assert_eq!(person(1, &[90.0, 85.0, 95.0]).up_axis(), None);
    assert_eq!(person(2, &[-90.0, -85.0, -95.0]).up_axis(), None);
}

#[test]
fn bent_body_shows_the_axis_of_its_rest() {
    assert_eq!(person(1, &[45.0, 40.0]).up_axis(), Some(UpAxis::Y));
    assert_eq!(person(2, &[45.0, 40.0]).up_axis(), Some(UpAxis::Z));
}

#[test]
fn body_upside_down_shows_no_axis() {
    let joints = ["Hips", "LeftFoot", "RightFoot"]
        .map(str::to_owned)
        .to_vec();
    let below = [0.0, 0.0, -0.9, 0.1, 0.0, 0.0, -0.1, 0.0, 0.0];
    let capture = Capture::new(joints, &below, 30.0).unwrap();
    assert_eq!(capture.up_axis(), None);
}

#[test]
fn joints_of_no_body_show_no_axis() {
    let joints = ["a", "b", "c"].map(str::to_owned).to_vec();
    let places = [0.0, 0.0, 0.9, 0.1, 0.0, 0.0, -0.1, 0.0, 0.0];
    assert_eq!(Capture::new(joints, &places, 30.0).unwrap().up_axis(), None);
}
