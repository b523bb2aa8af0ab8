//! Promise: a capture is written with the channels, frames and frame time of its file, and is read back as the same
//! motion.

use std::fmt::Write;

use glam::{Affine3A, Quat};
use kinopt::animation::{Cursor, Playback, Pose};
use kinopt::io::FormatError;
use kinopt::io::bvh::{self, BvhChannel, BvhFormat, MotionCapture};
use support::random::Random;

const ROTATIONS: [&str; 3] = ["Xrotation", "Yrotation", "Zrotation"];

fn read(text: &str) -> MotionCapture {
    bvh::from_bytes(text.as_bytes(), "order.bvh").unwrap()
}

/// Chain of joints with the given channels, and random frames with angles within ±170°.
fn chain(channels: &[Vec<&str>], frames: usize) -> String {
    let mut random = Random::new(3);
    let mut text = String::from("HIERARCHY\n");
    for (index, names) in channels.iter().enumerate() {
        let kind = if index == 0 { "ROOT" } else { "JOINT" };
        write!(text, "{kind} j{index} {{\nOFFSET 1 2 {index}\n").unwrap();
        writeln!(text, "CHANNELS {} {}", names.len(), names.join(" ")).unwrap();
    }
    text += "End Site {\nOFFSET 0 1 0\n}\n";
    text += &"}\n".repeat(channels.len());
    write!(text, "MOTION\nFrames: {frames}\nFrame Time: 0.0083333\n").unwrap();
    for _ in 0..frames {
        for name in channels.iter().flatten() {
            let range = if name.ends_with("rotation") {
                170.0
            } else {
                3.0
            };
            write!(text, "{:.4} ", random.within(-range, range)).unwrap();
        }
        text += "\n";
    }
    text
}

fn sampled(capture: &MotionCapture, frame: usize) -> Pose {
    let mut pose = capture.armature.rest().clone();
    let seconds = f64::from((frame as f64 * capture.frame_time) as f32);
    let clip = &capture.clip;
    clip.sample(seconds, Playback::Hold, &mut Cursor::new(), &mut pose)
        .unwrap();
    pose
}

fn placed(capture: &MotionCapture, pose: &Pose) -> Vec<Affine3A> {
    let mut placed = vec![Affine3A::IDENTITY; capture.armature.bones()];
    capture.armature.local_to_model(pose, &mut placed).unwrap();
    placed
}

fn assert_equal(a: &MotionCapture, b: &MotionCapture) {
    assert_eq!(a.armature, b.armature);
    assert_eq!(a.channels, b.channels);
    assert_eq!((a.frames, a.frame_time), (b.frames, b.frame_time));
    for frame in 0..a.frames {
        let [original, back] = [a, b].map(|capture| placed(capture, &sampled(capture, frame)));
        for (original, back) in original.iter().zip(back) {
            assert!(
                original.abs_diff_eq(back, 1e-5),
                "frame {frame}: {original} {back}"
            );
        }
    }
}

/// All orders of one to three axes in which neighbours differ.
fn orders() -> Vec<Vec<&'static str>> {
    let mut all: Vec<Vec<&str>> = ROTATIONS.iter().map(|axis| vec![*axis]).collect();
    let mut start = 0;
    for _ in 0..2 {
        let end = all.len();
        for index in start..end {
            let current = all[index].clone();
            let next = ROTATIONS.iter().filter(|axis| current.last() != Some(axis));
            all.extend(next.map(|axis| [current.as_slice(), &[*axis]].concat()));
        }
        start = end;
    }
    all
}

#[test]
fn capture_written_keeps_every_rotation_order() {
    let orders = orders();
    assert_eq!(orders.len(), 3 + 6 + 12);
    for order in orders {
        let capture = read(&chain(&[order.clone(), order], 20));
        assert_equal(&capture, &read(&capture.to_text().unwrap()));
    }
}

#[test]
fn capture_written_keeps_positions_among_rotations() {
    let channels = [
        vec![
            "Zrotation",
            "Yposition",
            "Yrotation",
            "Xposition",
            "Xrotation",
            "Zposition",
        ],
        vec!["Yposition", "Xrotation"],
        vec![],
        vec!["Zposition"],
    ];
    let capture = read(&chain(&channels, 30));
    let text = capture.to_text().unwrap();
    assert!(
        text.contains("CHANNELS 6 Zrotation Yposition Yrotation Xposition Xrotation Zposition")
    );
    assert_equal(&capture, &read(&text));
}

#[test]
fn capture_written_twice_is_the_same_text() {
    let capture = read(&chain(&[vec!["Yrotation", "Xrotation", "Zrotation"]], 50));
    let first = capture.to_text().unwrap();
    let second = read(&first).to_text().unwrap();
    assert_eq!(first.lines().count(), second.lines().count());
    let numbers = |text: &str| {
        let motion = text.split_once("Time:").unwrap().1.to_owned();
        let numbers = motion.split_whitespace().map(|word| word.parse::<f64>());
        numbers.collect::<Result<Vec<_>, _>>().unwrap()
    };
    for (a, b) in numbers(&first).into_iter().zip(numbers(&second)) {
        assert!((a - b).abs() < 1e-3, "{a} {b}");
    }
}

#[test]
fn gimbal_lock_keeps_every_order() {
    for order in orders().into_iter().filter(|order| order.len() == 3) {
        let mut text = chain(&[order], 0).replace("Frames: 0", "Frames: 6");
        text += "30 90 20\n30 -90 20\n30 0 20\n30 180 20\n30 90 -60\n30 0 75\n";
        let capture = read(&text);
        assert_equal(&capture, &read(&capture.to_text().unwrap()));
    }
}

#[test]
fn poses_beyond_the_channels_get_the_missing_ones() {
    let capture = read(&chain(
        &[vec!["Xrotation"], vec!["Yposition", "Yrotation"], vec![]],
        2,
    ));
    let armature = &capture.armature;
    let mut pose = armature.rest().clone();
    for index in 0..3 {
        let bone = armature.bone_at(index).unwrap();
        let mut local = pose.local(bone).unwrap();
        local.rotation = Quat::from_euler(glam::EulerRot::XYZ, 0.3, -0.5, 0.7);
        local.translation.x += 0.25;
        pose.set_local(bone, local).unwrap();
    }
    let text = bvh::poses_to_text(armature, std::slice::from_ref(&pose), capture.format()).unwrap();
    for expected in [
        "CHANNELS 4 Xposition Xrotation Yrotation Zrotation\n",
        "CHANNELS 5 Xposition Yposition Yrotation Zrotation Xrotation\n",
        "CHANNELS 4 Xposition Zrotation Xrotation Yrotation\n",
    ] {
        assert!(text.contains(expected), "no {expected} in {text}");
    }
    let back = read(&text);
    let places = placed(&back, &sampled(&back, 0));
    for (placement, back) in placed(&capture, &pose).iter().zip(places) {
        assert!(placement.abs_diff_eq(back, 1e-5));
    }
}

#[test]
fn clip_without_channels_keeps_default_order() {
    let capture = read(&chain(&[vec!["Yrotation", "Xrotation", "Zrotation"]], 3));
    let text = bvh::to_text(&capture.armature, &capture.clip, 120.0).unwrap();
    assert!(
        text.contains("CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n")
    );
}

#[test]
fn capture_without_frames_stays_without() {
    let capture = read(&chain(&[vec!["Xrotation"]], 0));
    assert_eq!(read(&capture.to_text().unwrap()).frames, 0);
}

#[test]
fn joints_without_end_sites_stay_without() {
    let text = chain(&[vec!["Xrotation"]], 2).replace("End Site {\nOFFSET 0 1 0\n}\n", "");
    let capture = read(&text);
    assert_eq!(capture.armature.bones(), 1);
    assert_equal(&capture, &read(&capture.to_text().unwrap()));
}

#[test]
fn wrong_channels_are_errors() {
    let capture = read(&chain(&[vec!["Xrotation"]], 2));
    let poses = [capture.armature.rest().clone()];
    let write = |channels: &[Vec<BvhChannel>]| {
        let format = BvhFormat::from(30.0).with_channels(channels);
        bvh::poses_to_text(&capture.armature, &poses, format).unwrap_err()
    };
    assert!(matches!(write(&[]), FormatError::Size(_)));
    let twice = vec![BvhChannel::Xrotation, BvhChannel::Xrotation];
    assert_eq!(
        write(&[twice, Vec::new()]).to_string(),
        "bone `j0` has Xrotation twice; a joint has each position at most once and at most three rotations"
    );
}

#[test]
fn shipped_capture_is_written_with_its_channels() {
    let capture = bvh::read("../models/captures/steps.bvh").unwrap();
    assert_equal(&capture, &read(&capture.to_text().unwrap()));
}
