//! Promise: a character in centimetres or inches rotates as it does in metres, for every solver.

use glam::Vec3A;
use kinopt::animation::{Armature, Clip, Limb, LimbGoal, Pose};
use kinopt::ik::Drag;
use kinopt::model::Model;
use kinopt::motion::Trajectory;
use kinopt::motion::clip_ik::Reach;
use kinopt::motion::retarget::{
    BodyMap, Capture, FigureTarget, RetargetOptions, RetargetReport, Retargeting, UpAxis,
};
use kinopt::problem::Problem;
use kinopt::skeleton::{BallSkeleton, Bone, BoneId, Cones, Skeleton, SkeletonRoot};
use kinopt::spatial::Vector3;
use kinopt::task::Point;
use support::bones::humanoid;
use support::retargeted::mean_target_error;

use crate::clip_ik::{figure, planted, walk};

/// Centimetres and inches per metre.
const UNITS: [f64; 2] = [100.0, 39.37007874015748];
/// Largest difference of an angle in radians, or of a component of a unit quaternion.
const ANGLE_TOLERANCE: f64 = 1e-6;

fn scaled(skeleton: &Skeleton, unit: f64) -> Skeleton {
    let bones = skeleton.bones().iter().map(|bone| {
        let mut bone: Bone = bone.clone();
        bone.length *= unit;
        bone.model_from_rest.translation = bone.model_from_rest.translation * unit;
        bone
    });
    Skeleton::new("scaled", bones.collect()).unwrap()
}

/// Configurations with the first `lengths` values of each in metres.
fn in_metres(q: &[f64], width: usize, lengths: usize, unit: f64) -> Vec<f64> {
    let numbers = q.iter().enumerate();
    let numbers = numbers.map(|(k, x)| if k % width < lengths { x / unit } else { *x });
    numbers.collect()
}

fn assert_alike(expected: &[f64], found: &[f64], what: &str) {
    assert_eq!(expected.len(), found.len(), "{what}");
    let pairs = expected.iter().zip(found);
    let deviation = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(deviation < ANGLE_TOLERANCE, "{what}: {deviation}");
}

/// Captured steps, retargeted to the humanoid in a unit.
fn retargeted(
    unit: f64,
    rate: f64,
    solve: impl Fn(&Retargeting<'_>) -> Trajectory<RetargetReport>,
) -> Vec<f64> {
    let read = kinopt::io::bvh::read("../models/captures/steps.bvh").unwrap();
    let capture = Capture::of_clip(&read.armature, &read.clip, rate).unwrap();
    let rig = humanoid();
    let figure = FigureTarget::new(&scaled(&rig.skeleton, unit), UpAxis::Z).unwrap();
    let model = figure.robot().model();
    let map = BodyMap::guess(&capture, model).unwrap().map;
    let options = RetargetOptions::default().with_up(UpAxis::Y);
    let fitted = Retargeting::new(figure.robot(), &map, &capture, options).unwrap();
    let found = solve(&fitted);
    // Errors refer to the positions of the capture, in the figure's unit.
    let mean = mean_target_error(&fitted, &found) / unit;
    assert!((1e-4..0.1).contains(&mean), "{mean} m");
    in_metres(&found.q, model.configuration_len(), 3, unit)
}

#[test]
fn retargeted_frames_are_alike_in_all_units() {
    let per_frame = |fitted: &Retargeting<'_>| fitted.per_frame().unwrap();
    let metres = retargeted(1.0, 30.0, per_frame);
    for unit in UNITS {
        assert_alike(
            &metres,
            &retargeted(unit, 30.0, per_frame),
            &format!("{unit}"),
        );
    }
}

#[test]
fn retargeted_movement_is_alike_in_all_units() {
    let whole = |fitted: &Retargeting<'_>| fitted.whole().unwrap();
    let metres = retargeted(1.0, 6.0, whole);
    for unit in UNITS {
        assert_alike(&metres, &retargeted(unit, 6.0, whole), &format!("{unit}"));
    }
}

/// Frames of a drag of two tips out of reach, on revolute joints.
fn dragged(unit: f64) -> Vec<f64> {
    let rig = humanoid();
    let skeleton = scaled(&rig.skeleton, unit);
    frames_of_drag(skeleton.model(), &skeleton, unit)
}

/// Frames of a drag of two tips out of reach, on ball joints and a free root.
fn dragged_freely(unit: f64) -> Vec<f64> {
    let rig = humanoid();
    let skeleton = scaled(&rig.skeleton, unit);
    let figure = BallSkeleton::new(skeleton, &Cones::new(), SkeletonRoot::FREE).unwrap();
    let frames = frames_of_drag(figure.model(), figure.skeleton(), unit);
    in_metres(&frames, figure.model().configuration_len(), 3, unit)
}

fn frames_of_drag(model: &Model, skeleton: &Skeleton, unit: f64) -> Vec<f64> {
    let bones = skeleton.bones();
    let leaf = |bone: &BoneId| bones.iter().all(|other| other.parent != Some(*bone));
    let leaves: Vec<BoneId> = skeleton.bone_ids().filter(leaf).collect();
    let mut problem = Problem::builder(model);
    let point = |leaf: &BoneId| Point::new(skeleton.tip(*leaf), [0.0; 3]);
    let tasks = leaves[..2].iter().map(|leaf| problem.add(point(leaf)));
    let tasks: Vec<_> = tasks.collect();
    let mut drag = Drag::new(problem.build().unwrap(), &model.neutral()).unwrap();
    let mut frames = Vec::new();
    for frame in 0..20 {
        for (k, (task, leaf)) in tasks.iter().zip(&leaves).enumerate() {
            let tip = bones[leaf.index()].rest_tip();
            let displacement = Vector3::new(0.3, -0.1, 0.2) * (unit * f64::from(frame) / 10.0);
            let side = if k == 0 { 1.0 } else { -1.0 };
            let target = tip + displacement * side;
            drag.target_mut(*task).unwrap().set_target(target);
        }
        frames.extend_from_slice(&drag.advance().q);
    }
    frames
}

#[test]
fn drag_is_alike_in_all_units() {
    let metres = dragged(1.0);
    for unit in UNITS {
        assert_alike(&metres, &dragged(unit), &format!("{unit}"));
    }
}

#[test]
fn drag_of_a_free_root_is_alike_in_all_units() {
    let metres = dragged_freely(1.0);
    for unit in UNITS {
        assert_alike(&metres, &dragged_freely(unit), &format!("{unit}"));
    }
}

/// The figure and its walk in a unit.
fn walking(unit: f64) -> (Armature, Clip) {
    let metres = figure();
    let scale = |pose: &Pose, armature: &Armature| {
        let mut pose = pose.clone();
        for bone in armature.bone_ids() {
            let at = pose.local(bone).unwrap().translation.as_dvec3() * unit;
            pose.set_translation(bone, at.as_vec3a()).unwrap();
        }
        pose
    };
    let armature = metres.clone().at_rest_in(&scale(metres.rest(), &metres));
    let armature = armature.unwrap();
    let walk = walk(&metres, true);
    let times: Vec<f32> = (0..=60).map(|k| k as f32 / 30.0).collect();
    let poses = times.iter().map(|time| {
        let scaled_pose = crate::clip_ik::pose(&metres, &walk, f64::from(*time));
        scale(&scaled_pose, &metres)
    });
    let poses: Vec<Pose> = poses.collect();
    let clip = Clip::through_poses("walk", &armature, &times, &poses).unwrap();
    (armature, clip)
}

fn rotations(pose: &Pose) -> impl Iterator<Item = f64> + '_ {
    let rotations = pose.rotations().iter();
    rotations.flat_map(|q| q.to_array().map(f64::from))
}

/// Clip with planted feet, and a hand that reaches a target.
fn edited(position: Vec3A, unit: f64) -> Vec<f64> {
    let (armature, clip) = walking(unit);
    let hand = armature.bone("hand").unwrap();
    let target = position.as_dvec3() * unit;
    let reach = Reach::to(hand, target).unwrap().with_span(0.8..=1.6);
    let edited = planted(&armature)
        .with_reach(reach.with_fade(0.3))
        .solve(&clip)
        .unwrap();
    let times = (0..=30).map(|k| f64::from(k) / 15.0);
    let poses = times.map(|time| crate::clip_ik::pose(&armature, &edited.clip, time));
    poses
        .flat_map(|pose| rotations(&pose).collect::<Vec<_>>())
        .collect()
}

#[test]
fn clip_ik_is_alike_in_all_units() {
    let target = Vec3A::new(0.5, 1.3, 1.5);
    let metres = edited(target, 1.0);
    for unit in UNITS {
        assert_alike(&metres, &edited(target, unit), &format!("{unit}"));
    }
    // Too far for the arm, so that the root moves. Translations in this unit have the digits of those in metres. A
    // stretched arm rotates by the square root of the rounding error of single precision.
    let target = Vec3A::new(1.2, 1.5, 1.5);
    let [metres, other] = [1.0, 64.0].map(|unit| edited(target, unit));
    assert_alike(&metres, &other, "far");
}

/// Frames at which feet are in contact.
fn stances(unit: f64) -> Vec<f64> {
    let (armature, clip) = walking(unit);
    let edited = planted(&armature).solve(&clip).unwrap();
    let stances = edited.report.stances.iter();
    stances
        .flat_map(|stance| {
            let position = stance.place / unit;
            [stance.span[0], stance.span[1], position.x, position.z]
        })
        .collect()
}

#[test]
fn planted_feet_are_alike_in_all_units() {
    let metres = stances(1.0);
    assert!(metres.len() >= 4 * 4);
    for unit in UNITS {
        assert_alike(&metres, &stances(unit), &format!("{unit}"));
    }
}

/// Leg whose foot moves to a target, with a softened knee.
fn stepped(unit: f64) -> Vec<f64> {
    let (armature, clip) = walking(unit);
    let bones = ["thigh.l", "shin.l", "foot.l"].map(|name| armature.bone(name).unwrap());
    let limb = Limb::to_bone(&armature, bones[0], bones[1], bones[2]).unwrap();
    let limb = limb.with_softening(0.96).unwrap();
    let mut found = Vec::new();
    for step in 0..10 {
        let mut pose = crate::clip_ik::pose(&armature, &clip, f64::from(step) / 5.0);
        let foot = armature.model_from_bone(&pose, bones[2]).unwrap();
        let offset = Vec3A::new(0.02, 0.1, 0.03 * step as f32).as_dvec3() * unit;
        let target = foot.translation + offset.as_vec3a();
        let goal = LimbGoal::at(target);
        limb.reach(&armature, &mut pose, &goal).unwrap();
        found.extend(rotations(&pose));
    }
    found
}

#[test]
fn limb_is_alike_in_all_units() {
    let metres = stepped(1.0);
    for unit in UNITS {
        assert_alike(&metres, &stepped(unit), &format!("{unit}"));
    }
}
