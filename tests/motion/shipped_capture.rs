//! Promise: the capture in `models/` is retargeted to the NAO in `models/` by a map from its tree. Feet are flat in contact,
//! frame by frame and as a whole. Solving as a whole reports its progress by window.

use kinopt::kinematics::ForwardKinematics;
use kinopt::motion::ContactDetection;
use kinopt::motion::retarget::{BodyMap, Capture, RetargetOptions, Retargeting, UpAxis};
use support::arms::floating_nao;
use support::fault_tables::ExpectedError;
use support::retargeted::mean_target_error;

/// A NAO is a third as tall as the subject, so its speed limit in contact is a third as well.
const MAX_CONTACT_SPEED: f64 = 0.06;

#[test]
fn capture_of_steps_is_retargeted_to_the_nao() {
    let robot = floating_nao();
    let read = kinopt::io::bvh::read("../models/captures/steps.bvh").unwrap();
    assert_eq!(read.frames, 181);
    let capture = Capture::of_clip(&read.armature, &read.clip, 30.0).unwrap();
    let guess = BodyMap::guess(&capture, robot.model()).unwrap();
    assert!(guess.from_tree);
    assert_eq!((guess.up, guess.notes.len()), (Some(UpAxis::Y), 0));
    let options = RetargetOptions::default()
        .with_up(UpAxis::Y)
        .with_contacts(ContactDetection::default().with_speed(MAX_CONTACT_SPEED));
    let retargeting = Retargeting::new(&robot, &guess.map, &capture, options).unwrap();
    let mut reported = Vec::new();
    let whole = retargeting
        .whole_with_progress(&mut |done| reported.push(done))
        .unwrap();
    assert!(reported.len() > 1 && reported.is_sorted() && reported.last() == Some(&181));
    let model = robot.model();
    let feet = ["left_foot", "right_foot"].map(|foot| model.frame(foot).unwrap());
    let mut kinematics = ForwardKinematics::of_frames(model, &feet).unwrap();
    for found in [retargeting.per_frame().unwrap(), whole] {
        assert!(
            mean_target_error(&retargeting, &found) < 0.03,
            "{} m",
            mean_target_error(&retargeting, &found)
        );
        assert!(found.report.slip < 1e-3, "{} m", found.report.slip);
        // A crouch with both feet on the ground, and the subject at rest at the end: no toe points up or down.
        for frame in [110, 180] {
            let width = found.nq;
            let q = &found.q[frame * width..(frame + 1) * width];
            for placed in kinematics.place(q).unwrap() {
                let slope = placed.rotation.x.z;
                assert!(slope.abs() < 0.1, "frame {frame}: {slope}");
            }
        }
    }
}

/// At these rates the frames of 6 s exceed any memory.
#[test]
fn more_frames_than_memory_holds_are_rejected() {
    let read = kinopt::io::bvh::read("../models/captures/steps.bvh").unwrap();
    for rate in [1e9, f64::MAX] {
        Capture::of_clip(&read.armature, &read.clip, rate).says("10000000 frames");
    }
}
