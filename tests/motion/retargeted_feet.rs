//! Promise: limbs of another body fit a model's own lengths in any order of a map's names. Feet with two points, ankle
//! and toe, are motionless in contact while the joints above them are pulled away.

use std::fmt::Write as _;

use kinopt::kinematics::ForwardKinematics;
use kinopt::motion::Trajectory;
use kinopt::motion::retarget::{BodyMap, Capture, RetargetOptions, RetargetReport, Retargeting};
use kinopt::robot::{BaseJoint, Robot};
use kinopt::spatial::Vector3;
use support::retargeted::mean_target_error;

pub(crate) const RATE: f64 = 100.0;
const FRAMES: usize = 240;
/// The ankle's name precedes the knee's, and both are points of one joint.
pub(crate) const MAP: &str = r#"{
    "joints": ["chest", "l_hip", "l_knee", "l_ankle", "l_toe", "r_hip", "r_knee", "r_ankle", "r_toe"],
    "drives": {
        "chest": "pelvis",
        "l_hip": "left_thigh", "l_knee": "left_shank", "l_ankle": "left_heel_string", "l_toe": "left_toe",
        "r_hip": "right_thigh", "r_knee": "right_shank", "r_ankle": "right_heel_string", "r_toe": "right_toe"
    }
}"#;

/// Two legs whose ankle point is on the shank, a little above the joint; `feet` is added to the links of the feet.
pub(crate) fn legs(feet: &str) -> Robot {
    let mut text = String::from(r#"<robot name="legs"><link name="pelvis"/>"#);
    let mut joint = |name: &str, kind: &str, parent: &str, child: &str, at: &str, more: &str| {
        let geometry = if child.ends_with("_foot") { feet } else { "" };
        write!(
            text,
            r#"<link name="{child}">{geometry}</link><joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>
               <origin xyz="{at}"/>{more}</joint>"#
        )
        .unwrap();
    };
    for (side, y) in [("left", 0.1), ("right", -0.1)] {
        let link = |name: &str| format!("{side}_{name}");
        let turn = |axis: &str, lower: f64, upper: f64| {
            format!(
                r#"<axis xyz="{axis}"/><limit lower="{lower}" upper="{upper}" velocity="10" effort="1"/>"#
            )
        };
        for (name, parent, child, at, axis, range) in [
            (
                "roll",
                "pelvis".to_owned(),
                "hip",
                format!("0 {y} -0.1"),
                "1 0 0",
                [-0.5, 0.5],
            ),
            (
                "yaw",
                link("hip"),
                "socket",
                "0 0 0".to_owned(),
                "0 0 1",
                [-1.0, 1.0],
            ),
            (
                "pitch",
                link("socket"),
                "thigh",
                "0 0 0".to_owned(),
                "0 1 0",
                [-2.0, 1.0],
            ),
            (
                "knee",
                link("thigh"),
                "shank",
                "0 0 -0.3".to_owned(),
                "0 1 0",
                [-0.09, 2.6],
            ),
            (
                "ankle_pitch",
                link("shank"),
                "ankle",
                "0 0 -0.3".to_owned(),
                "0 1 0",
                [-0.87, 0.52],
            ),
            (
                "ankle_roll",
                link("ankle"),
                "foot",
                "0 0 -0.02".to_owned(),
                "1 0 0",
                [-0.26, 0.26],
            ),
        ] {
            let turn = turn(axis, range[0], range[1]);
            joint(&link(name), "revolute", &parent, &link(child), &at, &turn);
        }
        for (parent, child, at) in [
            ("shank", "heel_string", "0 0 -0.28"),
            ("foot", "toe", "0.14 0 -0.03"),
            ("thigh", "hip_mark", "0.03 0.02 0.06"),
        ] {
            let name = link(&format!("{child}_mount"));
            joint(&name, "fixed", &link(parent), &link(child), at, "");
        }
    }
    text.push_str("</robot>");
    Robot::parse(&text, "legs.urdf")
        .unwrap()
        .with_base_joint(BaseJoint::FREE)
        .unwrap()
}

/// Subject with longer legs and larger feet that kneels, sways, and moves the left foot forward. The chest is far above
/// the hips.
pub(crate) fn person() -> Vec<f64> {
    let mut numbers = Vec::new();
    for frame in 0..FRAMES {
        let phase = frame as f64 / FRAMES as f64;
        let step = ((phase - 0.4) * 5.0).clamp(0.0, 1.0);
        let down = 0.14 * (1.0 - (phase * 19.0).cos());
        let hips = Vector3::new(0.3 * phase, 0.06 * (phase * 12.0).sin(), 0.93 - down);
        numbers.extend((hips + Vector3::new(0.1, 0.0, 0.45)).to_array());
        for (y, step) in [(0.12, step), (-0.12, 0.0)] {
            let hip = hips + Vector3::new(0.0, y, 0.0);
            let lift = 0.6 * step * (1.0 - step);
            let ankle = Vector3::new(0.3 * step, 1.2 * y, 0.09 + lift);
            // Knee of two bones, forward.
            let leg = ankle - hip;
            let half = 0.5 * leg.norm();
            let (upper, lower) = (0.42, 0.45);
            let along = half + (upper * upper - lower * lower) / (4.0 * half);
            let ahead = (upper * upper - along * along).max(0.0).sqrt();
            let forward = Vector3::new(1.0, 0.0, 0.0) - leg * (leg.x / (4.0 * half * half));
            let knee = hip + leg * (along / (2.0 * half)) + forward * (ahead / forward.norm());
            let toe = ankle + Vector3::new(0.17, 0.2 * y, -0.06);
            for at in [hip, knee, ankle, toe] {
                numbers.extend(at.to_array());
            }
        }
    }
    numbers
}

pub(crate) fn check_limits(robot: &Robot, found: &Trajectory<RetargetReport>) {
    let frames: Vec<&[f64]> = found.rows().collect();
    assert!(frames.iter().all(|q| robot.model().is_within_limits(q)));
    for pair in frames.windows(2) {
        for (k, speed) in robot.moves_within(1.0).iter().enumerate() {
            assert!((pair[1][k] - pair[0][k]).abs() * RATE <= *speed);
        }
    }
}

#[test]
fn ankles_and_toes_are_in_contact_together() {
    let robot = legs("");
    let map = BodyMap::from_json(MAP, "legs").unwrap();
    let capture = Capture::new(map.joints.clone(), &person(), RATE).unwrap();
    let options = RetargetOptions::default();
    let retargeting = Retargeting::new(&robot, &map, &capture, options).unwrap();
    let found = retargeting.per_frame().unwrap();
    check_limits(&robot, &found);
    // The ankles' points are on the shanks, so they are not points of the feet.
    assert_eq!(found.report.contact_frames, ["left_toe", "right_toe"]);
    assert!(
        found.report.lost_contacts.is_empty(),
        "{:?}",
        found.report.lost_contacts
    );
    assert!(found.report.slip < 1e-3, "{} m", found.report.slip);
    // Knees bend over feet in contact: with fixed shanks the error would be twice as large.
    assert!(
        mean_target_error(&retargeting, &found) < 0.045,
        "{} m",
        mean_target_error(&retargeting, &found)
    );
    // Computed again from the configurations.
    let mut kinematics = ForwardKinematics::new(robot.model());
    for (k, name) in found.report.contact_frames.iter().enumerate() {
        let frame = robot.model().frame(name).unwrap();
        let mut stood = None;
        let mut standing = 0;
        for (q, contacts) in found
            .q
            .chunks(found.nq)
            .zip(found.report.contacts.chunks(2))
        {
            let at = kinematics.place(q).unwrap()[frame.index()].translation;
            stood = contacts[k].then(|| stood.unwrap_or(at));
            standing += usize::from(contacts[k]);
            assert!(stood.is_none_or(|stood| (at - stood).norm() < 1e-3));
        }
        assert!(standing > FRAMES / 2, "{name} stands in {standing} frames");
    }
}

/// An ankle frame that is on the foot already is the model's own. It is in contact and reported by its name, as the toe
/// is.
#[test]
fn ankle_frame_on_the_foot_is_in_contact() {
    let robot = legs("");
    let mut map = BodyMap::from_json(MAP, "legs").unwrap();
    for drive in &mut map.drives {
        drive.frame = drive.frame.replace("_heel_string", "_foot");
    }
    let capture = Capture::new(map.joints.clone(), &person(), RATE).unwrap();
    let retargeting = Retargeting::new(&robot, &map, &capture, RetargetOptions::default()).unwrap();
    let names = |frames: Vec<kinopt::model::FrameId>| -> Vec<String> {
        let mut names: Vec<String> = (frames.iter())
            .map(|frame| robot.model().frames()[frame.index()].name.clone())
            .filter(|name| name.ends_with("_foot") || name.ends_with("_toe"))
            .collect();
        names.sort();
        names
    };
    let feet = ["left_foot", "left_toe", "right_foot", "right_toe"];
    assert_eq!(names(retargeting.driven()), feet);
    let found = retargeting.per_frame().unwrap();
    let mut standing = found.report.contact_frames.clone();
    standing.sort();
    assert_eq!(standing, feet);
    for (k, name) in found.report.contact_frames.iter().enumerate() {
        let in_contact = found
            .report
            .contacts
            .chunks(4)
            .filter(|contacts| contacts[k]);
        assert!(in_contact.count() > FRAMES / 2, "{name}");
    }
    assert!(found.report.slip < 1e-3, "{} m", found.report.slip);
}

#[test]
fn target_limbs_have_the_model_lengths() {
    let robot = legs("");
    let map = BodyMap::from_json(MAP, "legs").unwrap();
    let capture = Capture::new(map.joints.clone(), &person(), RATE).unwrap();
    let retargeting = Retargeting::new(&robot, &map, &capture, RetargetOptions::default()).unwrap();
    let driven = retargeting.driven();
    let index = |name: &str| {
        let frame = robot.model().frame(name).unwrap();
        driven
            .iter()
            .position(|driven_frame| *driven_frame == frame)
            .unwrap()
    };
    // Legs of 0.6 m instead of 0.87 m; feet do not count.
    assert!(
        (retargeting.stride() - 0.58 / 0.87).abs() < 0.03,
        "{}",
        retargeting.stride()
    );
    for frame in [0, 60, 200] {
        let targets = retargeting.targets(frame).unwrap();
        let length = |from: &str, to: &str| (targets[index(from)] - targets[index(to)]).norm();
        for side in ["left", "right"] {
            let [thigh, shank] = ["thigh", "shank"].map(|name| format!("{side}_{name}"));
            assert!(
                (length(&thigh, &shank) - 0.3).abs() < 0.02,
                "{}",
                length(&thigh, &shank)
            );
            // However far the chest is above the hips, they are no higher than the legs reach.
            let over_ground = targets[index(&thigh)].z;
            assert!(over_ground < 0.66, "{over_ground}");
        }
        assert!(length("pelvis", "left_thigh") < 0.2);
    }
}

/// A foot that was locked while its target moved on returns to the target smoothly, without a jump.
#[test]
fn released_foot_returns_smoothly() {
    let robot = legs("");
    let map = BodyMap::from_json(MAP, "legs").unwrap();
    let capture = Capture::new(map.joints.clone(), &person(), RATE).unwrap();
    let fitted = Retargeting::new(&robot, &map, &capture, RetargetOptions::default()).unwrap();
    let (stood, driven, model) = (fitted.targets(0).unwrap(), fitted.driven(), robot.model());
    // The heel is a point of the foot.
    let is_foot = |k: usize| {
        let name = &model.frames()[driven[k].index()].name;
        ["left_foot", "left_heel_string", "left_toe"].contains(&name.as_str())
    };
    let toe = model.frame("left_toe").unwrap();
    // Forward position of the toe, frame by frame. The foot is locked for half a second while its target moves forward.
    let course = |distance: f64| -> Vec<f64> {
        let mut follower = fitted.follower().unwrap();
        let mut kinematics = ForwardKinematics::new(model);
        let mut course = Vec::new();
        for frame in 0..120 {
            let ahead = distance * (f64::from(frame) / 50.0).min(1.0);
            let places = stood.iter().enumerate().map(|(k, at)| match is_foot(k) {
                true => *at + Vector3::new(ahead, 0.0, 0.0),
                false => *at,
            });
            let places: Vec<_> = places.collect();
            let held = |k: usize| f64::from(is_foot(k) && (10..60).contains(&frame));
            let in_contact: Vec<f64> = (0..places.len()).map(held).collect();
            let q = follower.advance(&places, &in_contact).unwrap();
            course.push(kinematics.place(q).unwrap()[toe.index()].translation.x);
        }
        course
    };
    // Motions at the release that happen for a motionless target as well are subtracted.
    let (gone, stayed) = (course(0.04), course(0.0));
    let apart: Vec<f64> = gone.iter().zip(&stayed).map(|(a, b)| a - b).collect();
    assert!(apart[59] < 0.01 && apart[119] > 0.03, "{apart:?}");
    let changes = apart[59..].windows(2).map(|pair| pair[1] - pair[0]);
    let largest = changes.fold(0.0, f64::max);
    // At most 1.7 times the mean over the 16 frames of a release.
    assert!(largest < 1.7 * 0.04 / 16.0, "{largest} m in a frame");
}
