//! Promise: a skeleton's pose is the recursion T_i = T_parent T̂_i R_x(θ₃) R_z(θ₂) R_x(θ₁) T̂_i⁻¹ of the source
//! documents, to 1e-12 of its size. Tails coincide with their parents' tips.

use kinopt::kinematics::ForwardKinematics;
use kinopt::model::FrameId;
use kinopt::skeleton::Posing;
use nalgebra as na;
use support::bones::RandomRig;
use support::random::Random;
use support::{apart, rigid};

const SEEDS: u64 = 20;

/// Angles also far beyond the limits, which the formula ignores.
fn angles(rig: &RandomRig, random: &mut Random) -> Vec<f64> {
    let count = rig.skeleton.angles();
    (0..count).map(|_| random.within(-7.0, 7.0)).collect()
}

#[test]
fn skinning_transforms_follow_the_recursion() {
    for seed in 0..SEEDS {
        let rig = RandomRig::new(seed);
        let mut random = Random::new(seed);
        let mut posing = Posing::new(&rig.skeleton);
        for _ in 0..3 {
            let q = angles(&rig, &mut random);
            let expected = rig.transforms(&q);
            let pose = posing.pose(&q).unwrap();
            let ours: Vec<_> = pose.skinning_transforms(&rig.skeleton).collect();
            assert_eq!(ours.len(), expected.len());
            for (ours, theirs) in ours.iter().zip(&expected) {
                assert!(apart(ours, theirs) < 1e-12 * rig.skeleton.size());
            }
            assert_eq!(*pose, rig.skeleton.pose(&q).unwrap());
        }
    }
}

#[test]
fn at_rest_nothing_moves() {
    for seed in 0..SEEDS {
        let rig = RandomRig::new(seed);
        let pose = rig
            .skeleton
            .pose(&vec![0.0; rig.skeleton.angles()])
            .unwrap();
        for transform in pose.skinning_transforms(&rig.skeleton) {
            assert!(apart(&transform, &rigid(na::Rotation3::identity(), na::zero())) < 1e-13);
        }
    }
}

#[test]
fn tails_coincide_with_parent_tips() {
    for seed in 0..SEEDS {
        let rig = RandomRig::new(seed);
        let mut random = Random::new(seed);
        let q = angles(&rig, &mut random);
        let expected = rig.transforms(&q);
        let pose = rig.skeleton.pose(&q).unwrap();
        let within = 1e-12 * rig.skeleton.size();
        for bone in rig.skeleton.bone_ids() {
            let tail: na::Vector3<f64> = pose.tail(bone).unwrap().into();
            let tip: na::Vector3<f64> = pose.tip(&rig.skeleton, bone).unwrap().into();
            assert!((tail - rig.tail(&expected, bone)).amax() < within);
            assert!((tip - rig.tip(&expected, bone)).amax() < within);
            assert!(((tip - tail).norm() - rig.lengths[bone.index()]).abs() < within);
            if let Some(parent) = rig.skeleton.bones()[bone.index()].parent {
                let joint: na::Vector3<f64> = pose.tip(&rig.skeleton, parent).unwrap().into();
                assert!((tail - joint).amax() < within, "tail off its parent's tip");
            }
        }
    }
}

#[test]
fn model_frames_are_named_tails_and_tips() {
    let rig = RandomRig::new(1);
    let model = rig.skeleton.model();
    let q = angles(&rig, &mut Random::new(1));
    let expected = rig.transforms(&q);
    for bone in rig.skeleton.bone_ids() {
        let name = &rig.skeleton.bones()[bone.index()].name;
        let frames: [FrameId; 2] = [
            model.frame(name).unwrap(),
            model.frame(&format!("{name}/tip")).unwrap(),
        ];
        assert_eq!(frames, [rig.skeleton.tail(bone), rig.skeleton.tip(bone)]);
        assert_eq!(rig.skeleton.bone_of_frame(frames[1]), Some((bone, true)));
        let mut kinematics = ForwardKinematics::of_frames(model, &frames).unwrap();
        let placed = kinematics.place(&q).unwrap();
        let at = |k: usize| na::Vector3::from(placed[k].translation);
        assert!((at(0) - rig.tail(&expected, bone)).amax() < 1e-12);
        assert!((at(1) - rig.tip(&expected, bone)).amax() < 1e-12);
    }
}

#[test]
fn angles_are_in_the_documented_order() {
    // One angle at a time, bone by bone: first twist, bend, second twist.
    let rig = RandomRig::new(2);
    let model = rig.skeleton.model();
    for bone in rig.skeleton.bone_ids() {
        let joints = rig.skeleton.joints(bone);
        for (k, part) in ["twist1", "bend", "twist2"].into_iter().enumerate() {
            assert_eq!(model.coordinate(joints[k]), Some(3 * bone.index() + k));
            let name = format!("bone/{}/{part}", bone.index());
            assert_eq!(model.joint(&name).unwrap(), joints[k]);
        }
    }
}

#[test]
fn rests_with_seven_digits_are_accepted() {
    // As in a rig file: accepted, so the promises apply.
    let exact = RandomRig::new(3);
    let mut bones = exact.skeleton.bones().to_vec();
    let rounded = |v: f64| (v * 1e7).round() / 1e7;
    for bone in &mut bones {
        let columns = &mut bone.model_from_rest.rotation;
        for column in [&mut columns.x, &mut columns.y, &mut columns.z] {
            *column = column.to_array().map(rounded).into();
        }
    }
    let skeleton = kinopt::Skeleton::new("rounded", bones).unwrap();
    let pose = skeleton.pose(&vec![0.0; skeleton.angles()]).unwrap();
    for transform in pose.skinning_transforms(&skeleton) {
        let error = apart(&transform, &rigid(na::Rotation3::identity(), na::zero()));
        assert!(error < 1e-12 * skeleton.size(), "{error:e} at rest");
    }
}

/// A bone's tail frame is at its start and its tip frame at its end.
#[test]
fn frames_belong_to_their_bones() {
    let rig = RandomRig::new(3);
    let skeleton = &rig.skeleton;
    for bone in skeleton.bone_ids() {
        let [tail, tip] = [skeleton.tail(bone), skeleton.tip(bone)];
        assert_eq!(skeleton.bone_of_frame(tail), Some((bone, false)));
        assert_eq!(skeleton.bone_of_frame(tip), Some((bone, true)));
    }
    let frames = skeleton
        .model()
        .frame_ids()
        .map(|frame| skeleton.bone_of_frame(frame));
    let tips = frames.filter(|frame| frame.is_some_and(|(_, is_tip)| is_tip));
    assert_eq!(tips.count(), skeleton.bones().len());
}
