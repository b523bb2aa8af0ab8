//! Promise: a real capture of 2 752 frames is read according to its matrices. Every joint and End Site is checked in
//! every frame, and every bone has a constant length. Written and read again, it is the same motion.
//!
//! The file is not shipped: set `KINOPT_SHARED` to a folder that contains it as `assets/bvh/01_01.bvh`.
#![allow(clippy::print_stderr)]

use crate::bvh::matrices::{File, distance};
use glam::Affine3A;
use kinopt::animation::{Cursor, Playback};
use kinopt::io::bvh::{self, MotionCapture};

fn text() -> Option<String> {
    let Some(shared) = std::env::var_os("KINOPT_SHARED") else {
        eprintln!("SKIPPED: KINOPT_SHARED is not set, so no real motion capture was read");
        return None;
    };
    let path = std::path::PathBuf::from(shared).join("assets/bvh/01_01.bvh");
    Some(std::fs::read_to_string(path).unwrap())
}

/// Positions of the bones in each frame of the file.
fn frames(capture: &MotionCapture, frame_time: f64) -> Vec<Vec<[f64; 3]>> {
    let mut cursor = Cursor::new();
    let mut pose = capture.armature.rest().clone();
    let mut placed = vec![Affine3A::IDENTITY; capture.armature.bones()];
    let frames = (0..capture.frames).map(|frame| {
        let seconds = frame as f64 * frame_time;
        (capture.clip)
            .sample(seconds, Playback::Hold, &mut cursor, &mut pose)
            .unwrap();
        capture.armature.local_to_model(&pose, &mut placed).unwrap();
        let positions = placed
            .iter()
            .map(|placement| placement.translation.as_dvec3().to_array());
        positions.collect()
    });
    frames.collect()
}

#[test]
fn captured_joints_and_bone_lengths_are_correct() {
    let Some(text) = text() else { return };
    let file = File::parse(&text);
    let start = std::time::Instant::now();
    let capture = bvh::from_bytes(text.as_bytes(), "01_01.bvh").unwrap();
    eprintln!("read {} frames in {:?}", capture.frames, start.elapsed());
    assert_eq!((capture.frames, capture.armature.bones()), (2752, 38));
    assert!(file.joints.iter().any(|joint| joint.offset == [0.0; 3]));
    let all_frames = frames(&capture, file.frame_time);
    for (frame, placed) in all_frames.iter().enumerate() {
        for ((joint, at), (expected, _)) in file.joints.iter().zip(placed).zip(file.placed(frame)) {
            let apart = distance(*at, expected);
            assert!(apart < 5e-5, "frame {frame}, {}: {apart}", joint.name);
            let Some(parent) = joint.parent else { continue };
            let length = distance(*at, placed[parent]);
            let stretched = (length - distance(joint.offset, [0.0; 3])).abs();
            assert!(
                stretched < 2e-5,
                "frame {frame}, {}: {stretched}",
                joint.name
            );
        }
    }
}

#[test]
fn real_capture_survives_a_round_trip() {
    let Some(text) = text() else { return };
    let capture = bvh::from_bytes(text.as_bytes(), "01_01.bvh").unwrap();
    let rate = 1.0 / capture.frame_time;
    let written = bvh::to_text(&capture.armature, &capture.clip, rate).unwrap();
    let again = bvh::from_bytes(written.as_bytes(), "again.bvh").unwrap();
    assert_eq!(again.armature, capture.armature);
    assert_eq!(again.frames, capture.frames);
    let [original, read] = [&capture, &again].map(|capture| frames(capture, capture.frame_time));
    for (frame, (original, read)) in original.iter().zip(&read).enumerate() {
        for (bone, (original, read)) in original.iter().zip(read).enumerate() {
            let apart = distance(*original, *read);
            assert!(apart < 5e-5, "frame {frame}, bone {bone}: {apart}");
        }
    }
}
