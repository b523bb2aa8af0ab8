//! Promise: a pose is carried from bone to bone as its matrices say, and skeletons animated by
//! local transforms stand where their angles put them.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use glam::{Affine3A, Quat, Vec3A};
use kinopt::animation::{Armature, ArmatureBone, ArmatureError, LocalTransform};
use support::armatures::{armature, model_by_ancestors, pose};
use support::bones::RandomRig;
use support::random::Random;

#[test]
fn model_transforms_are_products_along_the_ancestors() {
    let mut random = Random::new(51);
    for bones in [1, 2, 7, 67] {
        let armature = armature(bones, &mut random);
        let pose = pose(&armature, &mut random);
        let mut model = vec![Affine3A::from_scale(glam::Vec3::splat(f32::NAN)); bones];
        armature.local_to_model(&pose, &mut model).unwrap();
        for (ours, expected) in model.iter().zip(model_by_ancestors(&armature, &pose)) {
            let size = 1.0 + expected.translation.length();
            assert!(ours.abs_diff_eq(expected, 2e-6 * size * bones as f32));
        }
    }
}

#[test]
fn the_rest_pose_does_not_move_skin() {
    let mut random = Random::new(52);
    let armature = armature(40, &mut random);
    let mut model = vec![Affine3A::IDENTITY; 40];
    let mut skin = model.clone();
    armature
        .local_to_model(armature.rest(), &mut model)
        .unwrap();
    armature.skinning_transforms(&model, &mut skin).unwrap();
    for transform in skin {
        assert!(transform.abs_diff_eq(Affine3A::IDENTITY, 1e-4));
    }
}

/// The sources' arm: shoulder without length, then 2.0, 1.5 and 1.0, turned by 45°, −30° and 10°.
#[test]
fn the_planar_arm_of_the_sources() {
    let turns = [0.0, 45.0, -30.0, 10.0_f32].map(f32::to_radians);
    let lengths = [0.0, 2.0, 1.5, 1.0];
    let names = ["shoulder", "upper arm", "forearm", "hand"];
    let bone = |k: usize| ArmatureBone {
        name: names[k].into(),
        parent: k.checked_sub(1),
        rest: LocalTransform {
            translation: Vec3A::X * k.checked_sub(1).map_or(0.0, |parent| lengths[parent]),
            ..LocalTransform::IDENTITY
        },
    };
    let armature = Armature::new((0..4).map(bone).collect(), Vec::new()).unwrap();
    let mut pose = armature.rest().clone();
    for (k, turn) in turns.into_iter().enumerate() {
        let bone = armature.bone(names[k]).unwrap();
        let rotation = Quat::from_rotation_z(turn);
        let local = LocalTransform {
            rotation,
            ..pose.local(bone)
        };
        pose.set_local(bone, local);
    }
    let mut model = vec![Affine3A::IDENTITY; 4];
    armature.local_to_model(&pose, &mut model).unwrap();
    // By hand: 2 (cos 45°, sin 45°), + 1.5 (cos 15°, sin 15°), + 1 (cos 25°, sin 25°).
    let ends = [
        (0.0, 0.0),
        (2_f32.sqrt(), 2_f32.sqrt()),
        (2.86310, 1.80244),
        (3.76941, 2.22506),
    ];
    for k in 0..4 {
        let end = model[k].transform_point3a(Vec3A::X * lengths[k]);
        let expected = Vec3A::new(ends[k].0, ends[k].1, 0.0);
        assert!((end - expected).length() < 2e-5, "{}: {end}", names[k]);
        let start = if k == 0 {
            Vec3A::ZERO
        } else {
            Vec3A::new(ends[k - 1].0, ends[k - 1].1, 0.0)
        };
        assert!(
            (model[k].translation - start).length() < 2e-5,
            "{}",
            names[k]
        );
    }
}

#[test]
fn a_skeleton_s_bones_rest_where_they_rest() {
    let skeleton = RandomRig::new(53).skeleton;
    let bones = skeleton.bones().len();
    let armature = Armature::of_skeleton(&skeleton);
    let mut model = vec![Affine3A::IDENTITY; bones];
    armature
        .local_to_model(armature.rest(), &mut model)
        .unwrap();
    for (bone, posed) in skeleton.bones().iter().zip(&model) {
        let tail: Vec3A = bone.rest_tail().to_array().map(|x| x as f32).into();
        let tip: Vec3A = bone.rest_tip().to_array().map(|x| x as f32).into();
        let along = Vec3A::X * bone.length as f32;
        assert!((posed.translation - tail).length() < 1e-4);
        assert!((posed.transform_point3a(along) - tip).length() < 1e-4);
    }
    for id in skeleton.bone_ids() {
        let bone = &skeleton.bones()[id.index()];
        assert_eq!(armature.parent(id), bone.parent);
        assert_eq!(armature.bone(&bone.name).unwrap(), id);
    }
}

#[test]
fn bad_armatures_and_sizes_are_named_errors() {
    let bone = |name: &str, parent| ArmatureBone {
        name: name.into(),
        parent,
        rest: LocalTransform::IDENTITY,
    };
    let build = |bones: Vec<ArmatureBone>| Armature::new(bones, Vec::new());
    let ring = build(vec![bone("a", Some(0))]).unwrap_err();
    assert_eq!(ring, ArmatureError::ParentNotBefore { bone: "a".into() });
    let twice = build(vec![bone("a", None), bone("a", Some(0))]).unwrap_err();
    assert!(twice.to_string().contains("`a` is used twice"));
    for rotation in [
        Quat::from_xyzw(0.0, 0.0, 0.0, 0.0),
        Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0),
    ] {
        let mut odd = bone("odd", None);
        odd.rest.rotation = rotation;
        let error = build(vec![odd]).unwrap_err();
        assert_eq!(error, ArmatureError::BadRest { bone: "odd".into() });
    }
    let targets = vec!["smile".to_owned(), "smile".to_owned()];
    assert!(Armature::new(vec![bone("a", None)], targets).is_err());

    let armature = build(vec![bone("a", None), bone("b", Some(0))]).unwrap();
    let unknown = armature.bone("c").unwrap_err();
    assert_eq!(unknown.valid, ["a", "b"]);
    let mut model = vec![Affine3A::IDENTITY; 3];
    let error = armature
        .local_to_model(armature.rest(), &mut model)
        .unwrap_err();
    assert_eq!((error.given, error.expected), (3, 2));
    let other = build(vec![bone("a", None)]).unwrap();
    assert!(
        armature
            .local_to_model(other.rest(), &mut model[..2])
            .is_err()
    );
    assert!(
        armature
            .skinning_transforms(&model, &mut [Affine3A::IDENTITY; 2])
            .is_err()
    );
}
