//! Promise: joints of a motion capture file have the positions of the product of its matrices, for every order of
//! channels and every frame.

use crate::bvh::matrices::{File, Joint, distance};
use glam::{Affine3A, Quat, Vec3};
use kinopt::animation::rotation::EulerOrder;
use kinopt::animation::{Cursor, Playback};
use kinopt::io::bvh::{self, BvhChannel, MotionCapture};
use support::random::Random;

const POSITIONS: &str = "Xposition Yposition Zposition";

fn read(file: &File) -> MotionCapture {
    bvh::from_bytes(file.text().as_bytes(), "shot.bvh").unwrap()
}

fn placed(capture: &MotionCapture, seconds: f64) -> Vec<Affine3A> {
    let mut pose = capture.armature.rest().clone();
    let mut cursor = Cursor::new();
    (capture.clip)
        .sample(seconds, Playback::Hold, &mut cursor, &mut pose)
        .unwrap();
    let mut placed = vec![Affine3A::IDENTITY; capture.armature.bones()];
    capture.armature.local_to_model(&pose, &mut placed).unwrap();
    placed
}

/// Compares every joint of every frame with the matrices.
fn check(file: &File, case: &str) {
    let capture = read(file);
    let names = file.joints.iter().map(|joint| &joint.name);
    assert!(capture.armature.names().iter().eq(names), "{case}");
    assert_eq!(capture.frames, file.frames.len(), "{case}");
    for frame in 0..file.frames.len() {
        let expected = file.placed(frame);
        let placed = placed(&capture, frame as f64 * file.frame_time);
        for ((joint, placement), (position, turn)) in file.joints.iter().zip(&placed).zip(&expected)
        {
            let context = || format!("{case}, frame {frame}, {}", joint.name);
            let at = placement.translation.as_dvec3().to_array();
            assert!(
                distance(at, *position) < 2e-5,
                "{}: {at:?} {position:?}",
                context()
            );
            for (axis, column) in [placement.x_axis, placement.y_axis, placement.z_axis]
                .into_iter()
                .enumerate()
            {
                let column = column.as_dvec3().to_array();
                let expected = turn.map(|row| row[axis]);
                assert!(distance(column, expected) < 2e-6, "{}", context());
            }
        }
    }
}

fn frames(joints: &[Joint], count: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut random = Random::new(seed);
    let channels = joints.iter().flat_map(|joint| &joint.channels);
    let channels: Vec<&String> = channels.collect();
    let mut frame = || {
        let values = channels
            .iter()
            .map(|channel| match channel.contains("pos") {
                true => random.within(-3.0, 3.0),
                // Also beyond full turns.
                false => random.within(-500.0, 500.0),
            });
        values.collect()
    };
    (0..count).map(|_| frame()).collect()
}

/// Chain of two joints, and a branch, with these channels on the joints that are not roots.
fn body(root: &str, joint: &str) -> File {
    let joints = vec![
        Joint::new("Hips", None, [0.5, 9.0, -0.25], root),
        Joint::new("Chest", Some(0), [0.0, 5.0, 0.5], joint),
        Joint::new("Zero", Some(1), [0.0; 3], joint),
        Joint::end("Zero", 2, [1.0, 2.0, 3.0]),
        Joint::new("Left leg:1", Some(0), [-1.5, -4.0, 0.25], joint),
        Joint::end("Left leg:1", 4, [0.0, -4.0, 0.0]),
    ];
    File {
        frames: frames(&joints, 4, joint.len() as u64),
        joints,
        frame_time: 0.04,
    }
}

#[test]
fn every_order_of_three_rotations_is_read() {
    for order in EulerOrder::ALL {
        let names = order.axes().map(|axis| ["X", "Y", "Z"][axis]);
        let rotations = names.map(|axis| format!("{axis}rotation")).join(" ");
        check(
            &body(&format!("{POSITIONS} {rotations}"), &rotations),
            &rotations,
        );
    }
}

#[test]
fn fewer_than_three_rotations_are_read() {
    let axes = ["Xrotation", "Yrotation", "Zrotation"];
    for first in axes {
        check(&body(POSITIONS, first), first);
        for second in axes.into_iter().filter(|&second| second != first) {
            check(&body("", &format!("{first} {second}")), second);
        }
    }
    check(&body("Yrotation", ""), "no channels");
}

#[test]
fn position_channels_replace_offsets_in_any_order() {
    for channels in [
        "Zposition Yposition Xposition",
        "Yposition",
        "Zrotation Xposition Xrotation Zposition Yrotation",
        "Zrotation Xrotation Yrotation Xposition Yposition Zposition",
    ] {
        check(&body(channels, channels), channels);
    }
}

#[test]
fn several_roots_move_independently() {
    let mut file = body(POSITIONS, "Xrotation");
    let second = Joint::new("Prop", None, [3.0, 0.0, 0.0], "Zposition Yrotation");
    file.joints.push(second);
    file.joints.push(Joint::end("Prop", 6, [0.0, 0.0, 1.0]));
    file.frames = frames(&file.joints, 3, 7);
    check(&file, "two roots");
}

#[test]
fn text_layout_is_irrelevant() {
    let file = body(POSITIONS, "Zrotation Xrotation");
    let text = file.text();
    let expected = bvh::from_bytes(text.as_bytes(), "shot.bvh").unwrap();
    let head = text.find("Frames").unwrap();
    let (hierarchy, motion) = text.split_at(head);
    let numbers = motion.split_once("0.04\n").unwrap().1;
    let one_a_line = numbers.split_whitespace().collect::<Vec<_>>().join("\n");
    let variants = [
        text.replace('\n', "\r\n"),
        text.replace('\n', "\r"),
        text.replace('\n', "\n\n\t "),
        text.replace("\n{\n", " {\n"),
        text.replace("\n{\nOFFSET", "{OFFSET"),
        text.replace("\n}", "}"),
        text.to_uppercase()
            .replace("HIPS", "Hips")
            .replace("CHEST", "Chest")
            .replace("ZERO", "Zero")
            .replace("LEFT LEG", "Left leg"),
        format!("\u{feff}{text}"),
        format!("{hierarchy}frames 4 frame   time 0.04 {one_a_line}"),
        format!("{hierarchy}Frames:4\nFrame Time:0.04\n{numbers}"),
        format!(
            "{hierarchy}Frames : 4\nFrame Time : 4e-2\n{}",
            numbers.replace('\n', " ")
        ),
        text.replace("Left leg:1", "  Left \t leg:1  "),
    ];
    for variant in variants {
        assert_ne!(variant, text);
        let read = bvh::from_bytes(variant.as_bytes(), "folder/shot.bvh");
        assert_eq!(read.unwrap(), expected, "{variant}");
    }
}

#[test]
fn file_properties_are_reported() {
    let capture = read(&body(POSITIONS, "Yrotation"));
    assert_eq!((capture.frames, capture.frame_time), (4, 0.04));
    assert_eq!(capture.clip.name(), "shot");
    assert_eq!(capture.clip.span(), [0.0, 0.12]);
    let [x, y, z, _, turn, _] = BvhChannel::ALL;
    let (root, joint, end) = (vec![x, y, z], vec![turn], vec![]);
    let channels = [&root, &joint, &joint, &end, &joint, &end].map(Clone::clone);
    assert_eq!(capture.channels, channels);
    // The rest pose has no rotations, and the offsets as positions.
    let rest = capture.armature.rest();
    assert!(rest.rotations().iter().all(|turn| *turn == Quat::IDENTITY));
    assert_eq!(
        Vec3::from(rest.translations()[0]),
        Vec3::new(0.5, 9.0, -0.25)
    );
}

#[test]
fn rotations_between_frames_are_slerped() {
    let text = "HIERARCHY ROOT a\n{ OFFSET 0 0 0 CHANNELS 2 Xposition Zrotation\n\
                End Site { OFFSET 1 0 0 } }\n\
                MOTION Frames: 3 Frame Time: 0.5\n 0 170\n 4 -150\n 4 -150";
    let capture = bvh::from_bytes(text.as_bytes(), "wrapped.bvh").unwrap();
    for (seconds, x, degrees) in [(0.0, 0.0, 170.0), (0.125, 1.0, 180.0), (0.375, 3.0, 200.0)] {
        let tip = placed(&capture, seconds)[1].translation;
        let (sin, cos) = f32::to_radians(degrees).sin_cos();
        let expected = Vec3::new(x + cos, sin, 0.0);
        assert!(tip.abs_diff_eq(expected.into(), 2e-6), "{seconds} s: {tip}");
    }
}

#[test]
fn single_frame_is_a_pose_and_none_is_the_rest_pose() {
    let mut file = body(POSITIONS, "Zrotation Xrotation Yrotation");
    file.frames.truncate(1);
    check(&file, "one frame");
    assert_eq!(read(&file).clip.span(), [0.0, 0.0]);
    assert_eq!(placed(&read(&file), 0.0), placed(&read(&file), 9.0));

    file.frames.clear();
    let capture = read(&file);
    assert_eq!((capture.frames, capture.clip.span()), (0, [0.0, 0.0]));
    let hips = placed(&capture, 1.0)[0].translation;
    assert_eq!(hips.to_array(), [0.5, 9.0, -0.25]);
}
