//! Promise: a frame that hardly moves is in contact only below the configured height over the ground.

use glam::Vec3;
use kinopt::animation::{Armature, Clip};
use kinopt::kinematics::ForwardKinematics;
use kinopt::motion::ContactDetection;
use kinopt::motion::retarget::{BodyMap, Capture, RetargetOptions, Retargeting};

use crate::clip_ik::{HIPS, bend, figure, planted};
use crate::retargeted_feet::{MAP, RATE, legs};

/// Subject on the right foot, with the left foot held still at this height in metres for the middle second of three.
fn crane(lifted: f64) -> Vec<f64> {
    let mut numbers = Vec::new();
    for frame in 0..300 {
        let time = f64::from(frame) / RATE;
        let up = ((time - 0.5) / 0.5).clamp(0.0, 1.0) - ((time - 2.0) / 0.5).clamp(0.0, 1.0);
        numbers.extend([0.1, 0.0, 1.35]);
        for (y, lift) in [(0.12, lifted * up), (-0.12, 0.0)] {
            let bent = 0.1 + 0.2 * lift;
            for [x, z] in [
                [0.0, 0.88],
                [bent, 0.48 + 0.5 * lift],
                [0.0, 0.09 + lift],
                [0.17, 0.03 + lift],
            ] {
                numbers.extend([x, y, z]);
            }
        }
    }
    numbers
}

#[test]
fn still_foot_in_the_air_is_in_contact_below_height() {
    let robot = legs("");
    let map = BodyMap::from_json(MAP, "legs").unwrap();
    let capture = Capture::new(map.joints.clone(), &crane(0.3), RATE).unwrap();
    // The model is two thirds as large: its foot is lifted by 0.2 m.
    for (height, stands_aloft) in [(0.1, false), (0.3, true), (f64::INFINITY, true)] {
        let mut options = RetargetOptions::default();
        options.contacts.height = height;
        let retargeting = Retargeting::new(&robot, &map, &capture, options).unwrap();
        let found = retargeting.per_frame().unwrap();
        let toe = found
            .report
            .contact_frames
            .iter()
            .position(|name| name == "left_toe")
            .unwrap();
        let in_contact =
            |frame: usize| found.report.contacts[frame * found.report.contact_frames.len() + toe];
        assert!(
            in_contact(20) && in_contact(290) && !in_contact(75),
            "{height}"
        );
        assert_eq!(in_contact(150), stands_aloft, "{height}");
        // Its support is as high as the subject is lifted; elsewhere it is the ground.
        let driven = retargeting.driven();
        let frame = robot.model().frame("left_toe").unwrap();
        let index = driven
            .iter()
            .position(|candidate| *candidate == frame)
            .unwrap();
        let heights = [20, 150, 290].map(|frame| retargeting.targets(frame).unwrap()[index].z);
        let up = 0.3 * retargeting.stride();
        assert!(
            (heights[1] - heights[0] - up).abs() < 0.01,
            "{heights:?} {up}"
        );
        assert!((heights[2] - heights[0]).abs() < 0.01, "{heights:?}");
    }
}

/// The allowed speed of a foot in contact is proportional to the length of one leg, not of all legs. It is 0.25 m/s for
/// legs of 0.9 m.
#[test]
fn slow_foot_is_in_contact_by_leg_length() {
    let robot = legs("");
    let map = BodyMap::from_json(MAP, "legs").unwrap();
    let person = |speed: f64| {
        let mut numbers = crane(0.0);
        for (frame, places) in numbers.chunks_mut(27).enumerate() {
            let ahead = speed * frame as f64 / RATE;
            places.iter_mut().step_by(3).for_each(|x| *x += ahead);
        }
        Capture::new(map.joints.clone(), &numbers, RATE).unwrap()
    };
    let options = RetargetOptions::default;
    let still = Retargeting::new(&robot, &map, &person(0.0), options()).unwrap();
    // Speed in the model's metres per second. Its legs of 0.6 m are in contact below 0.17 m/s.
    for (speed, in_contact) in [(0.12, true), (0.23, false)] {
        let moving = person(speed / still.stride());
        let retargeting = Retargeting::new(&robot, &map, &moving, options()).unwrap();
        let found = retargeting.per_frame().unwrap();
        let all = found
            .report
            .contacts
            .iter()
            .filter(|contact| **contact)
            .count();
        assert_eq!(
            all > found.report.contacts.len() / 2,
            in_contact,
            "{speed}: {all}"
        );
    }
}

/// Both feet on the ground, with the left one lifted by this many metres for the middle second of three.
fn lifted(armature: &Armature, lift: f32) -> Clip {
    let times: Vec<f32> = (0..=90).map(|k| k as f32 / 30.0).collect();
    let poses = times.iter().map(|&time| {
        let mut pose = armature.rest().clone();
        let up = ((time - 0.5) / 0.5).clamp(0.0, 1.0) - ((time - 2.0) / 0.5).clamp(0.0, 1.0);
        for (side, lift) in [("l", lift * up), ("r", 0.0)] {
            let limb = ["thigh", "shin", "foot"]
                .map(|part| armature.bone(&format!("{part}.{side}")).unwrap());
            bend(&mut pose, limb, Vec3::new(0.0, lift - HIPS + 0.05, 0.0));
        }
        pose
    });
    let poses: Vec<_> = poses.collect();
    Clip::through_poses("crane", armature, &times, &poses).unwrap()
}

/// For a clip the default height is a fraction of the leg's length.
#[test]
fn still_foot_in_the_air_of_a_clip_has_no_contact() {
    let armature = figure();
    let foot = armature.bone("foot.l").unwrap();
    let stances = |lift: f32, detection: Option<ContactDetection>| {
        let mut solver = planted(&armature);
        if let Some(detection) = detection {
            solver = solver.with_detection(detection);
        }
        let edited = solver.solve(&lifted(&armature, lift)).unwrap();
        edited
            .report
            .stances
            .iter()
            .filter(|stance| stance.bone == foot)
            .count()
    };
    let up_to = |height: f64| Some(ContactDetection::default().with_height(height));
    assert_eq!(stances(0.4, None), 2);
    assert_eq!(stances(0.4, up_to(0.35)), 2);
    assert_eq!(stances(0.4, up_to(0.45)), 3);
    assert_eq!(stances(0.4, up_to(f64::INFINITY)), 3);
}

/// A contact of the shortest duration counts; one that is a frame shorter does not.
#[test]
fn contact_counts_from_the_shortest_duration() {
    let armature = figure();
    let foot = armature.bone("foot.l").unwrap();
    let clip = lifted(&armature, 0.4);
    let stances = |shortest: f64| {
        let detection = ContactDetection::default().with_height(0.35);
        let solver = planted(&armature).with_detection(detection.with_shortest(shortest));
        let edited = solver.with_keys_per_second(30.0).solve(&clip).unwrap();
        let stances = edited
            .report
            .stances
            .into_iter()
            .filter(|own| own.bone == foot);
        stances.map(|stances| stances.span).collect::<Vec<_>>()
    };
    let all = stances(0.1);
    assert_eq!(all.len(), 2);
    for span in &all[..1] {
        let frames = (span[1] - span[0]) * 30.0 + 1.0;
        assert!(stances((frames - 0.5) / 30.0).contains(span), "{span:?}");
        assert!(!stances((frames + 0.5) / 30.0).contains(span), "{span:?}");
    }
}

/// Captures contain positions below the ground: retargeted feet stay above it, frame by frame and online.
#[test]
fn foot_below_ground_in_the_capture_stays_above() {
    let robot = legs("");
    let map = BodyMap::from_json(MAP, "legs").unwrap();
    let mut numbers = crane(0.0);
    // The left ankle and toe, for a few frames.
    for (frame, places) in numbers.chunks_mut(27).enumerate().skip(150).take(10) {
        let down = 0.12 * (0.1 * (frame - 150) as f64 * std::f64::consts::PI).sin();
        [11, 14].into_iter().for_each(|z| places[z] -= down);
    }
    let capture = Capture::new(map.joints.clone(), &numbers, RATE).unwrap();
    let retargeting = Retargeting::new(&robot, &map, &capture, RetargetOptions::default()).unwrap();
    let mut kinematics = ForwardKinematics::new(robot.model());
    let toe = robot.model().frame("left_toe").unwrap().index();
    let mut height = |q: &[f64]| kinematics.place(q).unwrap()[toe].translation.z;
    let found = retargeting.per_frame().unwrap();
    let by_frame: Vec<f64> = found.q.chunks(found.nq).map(&mut height).collect();
    let mut live = retargeting.live().unwrap();
    let frames = (0..capture.frames()).map(|frame| capture.frame(frame).unwrap());
    let live: Vec<f64> = frames.map(|at| height(live.step(at).unwrap())).collect();
    for heights in [by_frame, live] {
        let lowest = heights[30..].iter().copied().fold(f64::INFINITY, f64::min);
        assert!(lowest > heights[30] - 0.02, "{lowest} {}", heights[30]);
    }
}
