//! Promise: unusual captures are retargeted, and errors are named.
//!
//! Unusual are a single frame, limbs without length, and subjects that are rotated or lying. Errors are joints that are
//! missing or not finite. Results are finite and within their limits.

use kinopt::animation::Clip;
use kinopt::kinematics::ForwardKinematics;
use kinopt::motion::Trajectory;
use kinopt::motion::retarget::{
    BodyMap, Capture, RetargetError, RetargetOptions, RetargetReport, Retargeting, UpAxis,
};
use kinopt::robot::Robot;
use kinopt::spatial::Vector3;
use support::arms::floating_nao;
use support::fault_tables::ExpectedError;

const JOINTS: [&str; 9] = [
    "Hips",
    "LeftUpLeg",
    "LeftLeg",
    "LeftFoot",
    "RightUpLeg",
    "RightLeg",
    "RightFoot",
    "LeftHand",
    "RightHand",
];

/// A swaying subject with legs apart.
fn person(frame: usize) -> [Vector3<f64>; 9] {
    let sway = 0.03 * (frame as f64 * 0.1).sin();
    [
        [0.0, sway, 1.0],
        [0.0, 0.1 + sway, 0.9],
        [0.03, 0.12, 0.5],
        [0.0, 0.15, 0.1],
        [0.0, -0.1 + sway, 0.9],
        [0.03, -0.12, 0.5],
        [0.0, -0.15, 0.1],
        [0.2, 0.3, 0.9],
        [0.2, -0.3, 0.9],
    ]
    .map(Vector3::from)
}

fn capture(frames: usize, position_at: impl Fn(usize, Vector3<f64>) -> Vector3<f64>) -> Capture {
    let places = (0..frames).flat_map(|frame| {
        let positions = person(frame).into_iter().enumerate();
        positions
            .flat_map(|(joint, at)| position_at(joint, at).to_array())
            .collect::<Vec<_>>()
    });
    let numbers: Vec<f64> = places.collect();
    Capture::new(JOINTS.map(str::to_owned).to_vec(), &numbers, 30.0).unwrap()
}

fn retargeted(
    robot: &Robot,
    capture: &Capture,
    up: UpAxis,
    whole: bool,
) -> Trajectory<RetargetReport> {
    let guess = BodyMap::guess(capture, robot.model()).unwrap();
    let options = RetargetOptions::default().with_up(up);
    let retargeting = Retargeting::new(robot, &guess.map, capture, options).unwrap();
    let found = if whole {
        retargeting.whole()
    } else {
        retargeting.per_frame()
    }
    .unwrap();
    assert_eq!(found.rows().len(), capture.frames());
    let model = robot.model();
    for q in found.rows() {
        assert!(q.iter().all(|number| number.is_finite()));
        assert!(model.is_within_limits(q));
    }
    found
}

#[test]
fn single_frame_is_retargeted() {
    let robot = floating_nao();
    for whole in [false, true] {
        let found = retargeted(&robot, &capture(1, |_, at| at), UpAxis::Z, whole);
        assert_eq!(found.report.slip, 0.0);
    }
}

#[test]
fn limbs_and_subjects_without_length_are_retargeted() {
    let robot = floating_nao();
    let shinless = capture(5, |joint, at| if joint == 3 { person(0)[2] } else { at });
    let message = BodyMap::guess(&shinless, robot.model())
        .unwrap()
        .notes
        .join("\n");
    assert!(message.contains("the left shin"), "{message}");
    retargeted(&robot, &shinless, UpAxis::Z, false);
    retargeted(
        &robot,
        &capture(5, |_, _| Vector3::new(1.0, 2.0, 3.0)),
        UpAxis::Z,
        false,
    );
}

/// Hips at a single point do not define an orientation: they stay level.
#[test]
fn hips_at_a_single_point_stay_level() {
    let robot = floating_nao();
    let model = robot.model();
    let narrow = capture(10, |joint, at| match joint {
        1 | 4 => Vector3::new(at.x, 0.0, at.z),
        _ => at,
    });
    let found = retargeted(&robot, &narrow, UpAxis::Z, false);
    let torso = model.frame("torso").unwrap();
    let mut kinematics = ForwardKinematics::new(model);
    for q in found.rows() {
        let across = kinematics.place(q).unwrap()[torso.index()].rotation.y;
        assert!(across.z.abs() < 0.02, "{across:?}");
    }
}

/// Without limbs that show the subject's size, the robot moves by the same distance as the subject.
#[test]
fn single_driven_frame_moves_as_far_as_the_subject() {
    let robot = floating_nao();
    let capture = capture(40, |_, at| at * 2.0);
    let map = BodyMap::from_json(r#"{"drives": {"Hips": "torso"}}"#, "").unwrap();
    let retargeting = Retargeting::new(&robot, &map, &capture, RetargetOptions::default());
    let retargeting = retargeting.unwrap();
    let at = |frame: usize| retargeting.targets(frame).unwrap()[0];
    for frame in 1..capture.frames() {
        let gone = at(frame) - at(0);
        let person = (person(frame)[0] - person(0)[0]) * 2.0;
        assert!((gone - person).norm() < 1e-12, "{gone:?} {person:?}");
    }
}

/// Two joints may drive two points of a frame, but not the same point.
#[test]
fn frame_may_be_driven_at_two_distinct_points() {
    let robot = floating_nao();
    let capture = capture(3, |_, at| at);
    let made = |offset: &str| {
        let hand = format!(r#"{{"frame": "left_hand", "offset": {offset}}}"#);
        let map = format!(
            r#"{{"drives": {{"Hips": "torso", "LeftHand": "left_hand", "RightHand": {hand}}}}}"#
        );
        let map = BodyMap::from_json(&map, "").unwrap();
        let made = Retargeting::new(&robot, &map, &capture, RetargetOptions::default());
        made.map(|made| made.driven().len())
    };
    assert_eq!(made("[0.05, 0, 0]"), Ok(3));
    let twice = RetargetError::DrivenTwice {
        frame: "left_hand".to_owned(),
        first: "LeftHand".to_owned(),
        second: "RightHand".to_owned(),
    };
    assert_eq!(made("[0, 0, 0]"), Err(twice));
}

#[test]
fn rotated_subject_gives_the_rotated_robot() {
    let robot = floating_nao();
    let straight = retargeted(&robot, &capture(20, |_, at| at), UpAxis::Z, false);
    let turned = capture(20, |_, at| Vector3::new(-at.y, at.x, at.z));
    let turned = retargeted(&robot, &turned, UpAxis::Z, false);
    let width = straight.nq;
    for (unrotated, other) in straight
        .q
        .chunks_exact(width)
        .zip(turned.q.chunks_exact(width))
    {
        let deviation = unrotated[7..]
            .iter()
            .zip(&other[7..])
            .map(|(a, b)| (a - b).abs());
        // The tolerance covers the three steps per frame, which differ between the two.
        assert!(deviation.fold(0.0, f64::max) < 1e-3);
        assert!((unrotated[0] - other[1]).abs() < 1e-4 && (unrotated[1] + other[0]).abs() < 1e-4);
    }
}

#[test]
fn up_axis_is_found_from_the_posture() {
    let robot = floating_nao();
    let standing = capture(20, |_, at| at);
    let lying = capture(20, |_, at| Vector3::new(at.x, at.z, -at.y));
    for (capture, up) in [(&standing, UpAxis::Z), (&lying, UpAxis::Y)] {
        assert_eq!(BodyMap::guess(capture, robot.model()).unwrap().up, Some(up));
    }
    // With the right axis both are exactly the same motion.
    let one = retargeted(&robot, &standing, UpAxis::Z, false);
    assert_eq!(retargeted(&robot, &lying, UpAxis::Y, false).q, one.q);
}

#[test]
fn missing_joints_and_frames_are_named() {
    let robot = floating_nao();
    let capture = capture(3, |_, at| at);
    let refused = |map: &str| {
        let map = BodyMap::from_json(map, "").unwrap();
        let made = Retargeting::new(&robot, &map, &capture, RetargetOptions::default());
        made.unwrap_err().to_string()
    };
    let joint = refused(r#"{"drives": {"Hips": "torso", "LeftFeet": "left_sole"}}"#);
    assert!(
        joint.contains("LeftFeet") && joint.contains("did you mean `LeftFoot`"),
        "{joint}"
    );
    let frame = refused(r#"{"drives": {"Hips": "torso", "LeftFoot": "left_soul"}}"#);
    assert!(
        frame.contains("left_soul") && frame.contains("did you mean `left_sole`"),
        "{frame}"
    );
    let contact = refused(r#"{"drives": {"Hips": "torso"}, "contacts": ["LeftFoot"]}"#);
    assert!(contact.contains("LeftFoot"), "{contact}");
    for (speed, height) in [(-0.1, 1.0), (f64::NAN, 1.0), (0.1, -0.1), (0.1, f64::NAN)] {
        let mut options = RetargetOptions::default();
        (options.contacts.speed, options.contacts.height) = (speed, height);
        let map = BodyMap::from_json(r#"{"drives": {"Hips": "torso"}}"#, "").unwrap();
        let made = Retargeting::new(&robot, &map, &capture, options);
        made.says("option contact ");
    }
    let mut numbers = vec![0.0; 3 * 9 * 4];
    numbers[3 * 9 * 2 + 3 * 7 + 1] = f64::INFINITY;
    let lost = Capture::new(JOINTS.map(str::to_owned).to_vec(), &numbers, 30.0);
    let named = RetargetError::NotFinite {
        frame: 2,
        joint: "LeftHand".to_owned(),
    };
    assert_eq!(lost.unwrap_err(), named);
    // At this distance positions are not resolved to a tenth of a millimetre.
    numbers[3 * 9 * 2 + 3 * 7 + 1] = -1e300;
    let result = Capture::new(JOINTS.map(str::to_owned).to_vec(), &numbers, 30.0);
    let named = RetargetError::TooFar {
        frame: 2,
        joint: "LeftHand".to_owned(),
    };
    assert_eq!(result.unwrap_err(), named);
}

/// A file without frames is not a frame in the rest pose. A file with a frame in the rest pose is a motion.
#[test]
fn capture_without_frames_is_an_error() {
    let captured = |frames: &str| {
        let end = "End Site { OFFSET 0 1 0 }";
        let text = format!(
            "HIERARCHY ROOT Hips {{ OFFSET 0 0 0 CHANNELS 3 Zrotation Xrotation Yrotation {end} }} MOTION {frames}"
        );
        kinopt::io::bvh::from_bytes(text.as_bytes(), "empty.bvh").unwrap()
    };
    let none = captured("Frames: 0 Frame Time: 0.1");
    let again = serde_json::to_string(&none.clip).unwrap();
    let again: Clip = serde_json::from_str(&again).unwrap();
    let (rest_armature, lifted) = (&none.armature, none.armature.clone());
    for clip in [
        &none.clip,
        &again,
        &none.clip.at_rest_in(rest_armature, &lifted).unwrap(),
    ] {
        assert!(clip.is_empty() && clip.span() == [0.0, 0.0]);
        let refused = Capture::of_clip(&none.armature, clip, 30.0);
        assert_eq!(refused.unwrap_err(), RetargetError::NoFrames);
    }
    let rest = captured("Frames: 1 Frame Time: 0.1\n0 0 0");
    assert!(!rest.clip.is_empty());
    let capture = Capture::of_clip(&rest.armature, &rest.clip, 30.0).unwrap();
    assert_eq!(capture.frames(), 1);
}
