//! Trajectory optimisation, clip IK, keyframe IK and retargeting.

use kinopt::animation::{Clip, Cursor, Playback};
use kinopt::io::bvh;
use kinopt::motion::ContactDetection;
use kinopt::motion::clip_ik::{ClipIk, KeyframeIk, Reach};
use kinopt::motion::retarget::{BodyMap, Capture, RetargetOptions, Retargeting, UpAxis};
use kinopt::motion::trajectory::{Contact, MotionProblem, MotionSolver, RateCost, Windows};
use kinopt::task::Point;
use support::arms::{floating_nao, robot};
use support::bones::humanoid;
use support::retargeted::mean_target_error;

use super::record::{Case, Record};

pub(crate) const CASES: &[Case] = &[
    Case::double("motion_trajectory", trajectory),
    Case::single("motion_clip_ik", clip_ik),
    Case::double("motion_keyframe_ik", keyframe_ik),
    Case::single("motion_retargeting", retargeting),
];

/// Joints too slow for the step of the target, with a contact and a fixed first frame.
fn trajectory(record: &mut Record) {
    let robot = robot("universal_ur5e");
    let model = robot.model();
    let tip = model.frame("flange").unwrap();
    let mut motion = MotionProblem::builder(model, 24, 1.0 / 30.0);
    motion.parameters(robot.map().clone());
    let hand = motion.add(Point::new(tip, [0.4, 0.2, 0.4]));
    motion.follow(hand, |frame, point| {
        point.set_target([0.4, 0.2, if frame < 12 { 0.3 } else { 0.6 }]);
    });
    motion.rate_cost(RateCost::acceleration(1e-4));
    motion.rate_cost(RateCost::jerk(1e-6));
    for joint in ["joint1", "joint2", "joint3"] {
        motion.max_speed(joint, 1.0);
    }
    motion.contact(Contact::new(tip, 16..20));
    let rest = [0.0, -1.2, 1.5, -1.0, -1.5, 0.1];
    motion.first(&rest);
    let motion = motion.build().unwrap();
    for (field, windows) in [("whole", None), ("windows", Some(Windows::new(10, 6)))] {
        let solver = MotionSolver::default().with_windows(windows);
        let solved = solver.solve(&motion, &rest).unwrap();
        record.numbers(&format!("{field}.q"), solved.q.iter().copied());
        let costs = [
            solved.report.cost(),
            solved.report.cost_of_rates(),
            solved.report.slip(),
        ];
        record.numbers(&format!("{field}.cost"), costs);
        record.counts(&format!("{field}.iterations"), [solved.report.iterations()]);
    }
}

/// Poses of a clip at even times.
fn sampled(record: &mut Record, field: &str, clip: &Clip, rest: &kinopt::animation::Pose) {
    let (mut pose, mut cursor, mut poses) = (rest.clone(), Cursor::new(), Vec::new());
    for k in 0..12 {
        let time = clip.start() + clip.duration() * f64::from(k) / 11.0;
        clip.sample(time, Playback::Hold, &mut cursor, &mut pose)
            .unwrap();
        poses.push(pose.clone());
    }
    record.poses(field, &poses);
}

/// Feet that stay planted, and a hand that reaches, during the shipped capture.
fn clip_ik(record: &mut Record) {
    let capture = bvh::read("../models/captures/steps.bvh").unwrap();
    let (armature, clip) = (&capture.armature, &capture.clip);
    let bone = |name: &str| armature.bone(name).unwrap();
    let ik = || ClipIk::new(armature).with_keys_per_second(15.0);
    let planted = ik()
        .with_planted(bone("LeftFoot"))
        .with_planted(bone("RightFoot"));
    let edited = planted.solve(clip).unwrap();
    sampled(record, "planted feet", &edited.clip, armature.rest());
    let drift = edited
        .report
        .stances
        .iter()
        .flat_map(|plant| [plant.slide, plant.stray]);
    record.numbers("drift", drift);
    let at = armature
        .model_from_bone(armature.rest(), bone("LeftHand"))
        .unwrap();
    let target = (at.translation * 0.9).as_dvec3();
    let reach = Reach::to(bone("LeftHand"), target.to_array()).unwrap();
    let reach = reach.with_span(0.4..=1.2).with_fade(0.1);
    let edited = ik().with_reach(reach).solve(clip).unwrap();
    sampled(record, "reaching hand", &edited.clip, armature.rest());
    record.numbers("misses", edited.report.led.iter().map(|result| result.miss));
}

fn keyframe_ik(record: &mut Record) {
    let rig = humanoid();
    let hand = rig.skeleton.bone("right_hand").unwrap();
    let reach = Reach::to(hand, [-0.4, 1.2, 0.3]).unwrap();
    let ik = KeyframeIk::new(&rig.skeleton).with_moments_per_second(20.0);
    let edited = ik.with_reach(reach.with_span(0.5..=1.5)).solve(&rig.clip);
    let tracks = edited.unwrap().clip;
    let keys = tracks.tracks().iter().flat_map(|track| &track.keys);
    record.numbers(
        "keys",
        keys.flat_map(|key| [key.time].into_iter().chain(key.angles)),
    );
}

fn retargeting(record: &mut Record) {
    let nao = floating_nao();
    let read = bvh::read("../models/captures/steps.bvh").unwrap();
    let capture = Capture::of_clip(&read.armature, &read.clip, 30.0).unwrap();
    let guess = BodyMap::guess(&capture, nao.model()).unwrap();
    let contacts = ContactDetection::default().with_speed(0.06);
    let mut options = RetargetOptions::default();
    (options.up, options.contacts) = (UpAxis::Y, contacts);
    let retargeting = Retargeting::new(&nao, &guess.map, &capture, options).unwrap();
    for (field, found) in [
        ("frames", retargeting.per_frame()),
        ("whole", retargeting.whole()),
    ] {
        let found = found.unwrap();
        record.numbers(&format!("{field}.q"), found.q.iter().copied());
        let errors = [
            mean_target_error(&retargeting, &found),
            found.report.slip,
            found.report.ground_penetration,
        ];
        record.numbers(&format!("{field}.errors"), errors);
        record.counts(
            &format!("{field}.contacts"),
            found.report.contacts.into_iter().map(usize::from),
        );
    }
}
