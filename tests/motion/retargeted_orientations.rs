//! Promise: limbs of a robot have the directions of the subject's, and its feet are flat while the subject's are.

use kinopt::kinematics::ForwardKinematics;
use kinopt::motion::Trajectory;
use kinopt::motion::retarget::{
    BodyMap, Capture, RetargetOptions, RetargetReport, Retargeting, UpAxis,
};
use kinopt::spatial::Vector3;
use support::arms::floating_nao;

const LIMBS: [[&str; 2]; 4] = [
    ["LeftArm", "LeftForeArm"],
    ["RightArm", "RightForeArm"],
    ["LeftUpLeg", "LeftLeg"],
    ["RightUpLeg", "RightLeg"],
];
/// Largest mean angle of these limbs. The NAO's shoulder has two joints, so its elbow cannot follow all directions.
const MAX_MEAN_ANGLE: f64 = 0.2;
/// Largest slope of a sole in contact, at rest.
const MAX_CONTACT_TILT: f64 = 0.04;

/// Largest slope of a sole in the air, if the subject's foot is level.
const MAX_SWING_TILT: f64 = 0.3;

#[test]
fn limbs_point_as_the_subject_s() {
    let robot = floating_nao();
    let read = kinopt::io::bvh::read("../models/captures/steps.bvh").unwrap();
    let capture = Capture::of_clip(&read.armature, &read.clip, 30.0).unwrap();
    let map = BodyMap::guess(&capture, robot.model()).unwrap().map;
    let options = RetargetOptions::default().with_up(UpAxis::Y);
    let retargeting = Retargeting::new(&robot, &map, &capture, options).unwrap();
    for found in [
        retargeting.per_frame().unwrap(),
        retargeting.whole().unwrap(),
    ] {
        for limb in LIMBS {
            let angle = mean_angle(&robot, &map, &capture, &found, limb);
            assert!(angle < MAX_MEAN_ANGLE, "{limb:?}: {angle} rad");
        }
        assert!(found.report.slip < 1e-3, "{} m", found.report.slip);
        check_tilt(&robot, &found);
    }
}

/// The subject moves a level foot backward and turns it outward by 120°, which the NAO's hip does not reach.
#[test]
fn foot_turned_beyond_the_hip_stays_level() {
    let robot = floating_nao();
    let read = kinopt::io::bvh::read("../models/captures/steps.bvh").unwrap();
    let steps = Capture::of_clip(&read.armature, &read.clip, 30.0).unwrap();
    let stance = steps.frame(0).unwrap();
    let joint = |name: &str| steps.joint(name).unwrap();
    let ankle = stance[joint("LeftFoot")];
    let leg = (stance[joint("LeftLeg")] - ankle).norm() * 2.0;
    let foot = ["LeftFoot", "LeftToeBase", "LeftToeBase/tip"].map(joint);
    let positions = (0..90).flat_map(|frame| {
        let phase = ((frame as f64 - 20.0) / 30.0).clamp(0.0, 1.0);
        let (sine, cosine) = (120.0_f64.to_radians() * phase).sin_cos();
        let height = 0.2 * leg * (std::f64::consts::PI * phase).sin();
        let mut pose = stance.to_vec();
        for joint in foot {
            let v = pose[joint] - ankle;
            let turned = Vector3::new(cosine * v.x + sine * v.z, v.y, cosine * v.z - sine * v.x);
            pose[joint] = ankle + turned + Vector3::new(0.0, height, -0.3 * leg * phase);
        }
        pose.into_iter().flat_map(|position| position.to_array())
    });
    let numbers: Vec<f64> = positions.collect();
    let capture = Capture::new(steps.names().to_vec(), &numbers, 30.0).unwrap();
    let map = BodyMap::guess(&capture, robot.model()).unwrap().map;
    let options = RetargetOptions::default().with_up(UpAxis::Y);
    let retargeting = Retargeting::new(&robot, &map, &capture, options).unwrap();
    for found in [
        retargeting.per_frame().unwrap(),
        retargeting.whole().unwrap(),
    ] {
        assert_eq!(found.report.lost_contacts, []);
        check_tilt(&robot, &found);
        let foot = robot.model().frame("left_foot").unwrap();
        let mut kinematics = ForwardKinematics::of_frames(robot.model(), &[foot]).unwrap();
        for (frame, q) in found.rows().enumerate() {
            let up = kinematics.place(q).unwrap()[0].rotation.z;
            let tilt = up.x.hypot(up.y);
            assert!(tilt < MAX_SWING_TILT, "frame {frame}: {tilt}");
        }
    }
}

/// Angle between a limb and that of the subject, mean over all frames, radians.
fn mean_angle(
    robot: &kinopt::robot::Robot,
    map: &BodyMap,
    capture: &Capture,
    found: &Trajectory<RetargetReport>,
    limb: [&str; 2],
) -> f64 {
    let model = robot.model();
    let mut kinematics = ForwardKinematics::new(model);
    let drives = limb.map(|joint| {
        map.drives
            .iter()
            .find(|drive| drive.joint == joint)
            .unwrap()
    });
    let joints = limb.map(|joint| capture.joint(joint).unwrap());
    let angles = found.rows().enumerate().map(|(frame, q)| {
        let placed = kinematics.place(q).unwrap();
        let ends = drives.map(|drive| {
            let frame = model.frame(&drive.frame).unwrap();
            placed[frame.index()].apply(drive.offset)
        });
        let captured = capture.frame(frame).unwrap();
        let subject = captured[joints[1]] - captured[joints[0]];
        // From y up to z up.
        let subject = Vector3::new(subject.x, -subject.z, subject.y);
        let own = ends[1] - ends[0];
        own.cross(subject).norm().atan2(own.dot(subject))
    });
    let angles: Vec<f64> = angles.collect();
    angles.iter().sum::<f64>() / angles.len() as f64
}

fn check_tilt(robot: &kinopt::robot::Robot, found: &Trajectory<RetargetReport>) {
    let model = robot.model();
    let feet = ["left_foot", "right_foot"].map(|foot| model.frame(foot).unwrap());
    let mut kinematics = ForwardKinematics::of_frames(model, &feet).unwrap();
    // At rest at the end.
    let q = found.rows().last().unwrap();
    for placed in kinematics.place(q).unwrap() {
        let tilt = placed.rotation.z;
        assert!(tilt.x.hypot(tilt.y) < MAX_CONTACT_TILT, "{tilt:?}");
    }
}
