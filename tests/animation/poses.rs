//! Promise: placements of a pose follow from its matrices, and skeletons animated by local transforms have the
//! placements of their angles.

use glam::{Affine3A, Quat, Vec3A};
use kinopt::animation::curve::KeyedCurve;
use kinopt::animation::{
    Armature, ArmatureBone, Clip, ClipError, Cursor, LocalTransform, Playback,
};
use support::armatures::{armature, model_by_ancestors, pose};
use support::bones::RandomRig;
use support::fault_tables::ExpectedError;
use support::random::Random;

#[test]
fn model_transforms_multiply_along_ancestors() {
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
fn rest_pose_does_not_move_the_skin() {
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

/// Arm of the sources: shoulder without length, then 2.0, 1.5 and 1.0, rotated by 45°, −30° and 10°.
#[test]
fn documented_planar_arm_is_reproduced() {
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
            ..pose.local(bone).unwrap()
        };
        pose.set_local(bone, local).unwrap();
    }
    let mut model = vec![Affine3A::IDENTITY; 4];
    armature.local_to_model(&pose, &mut model).unwrap();
    // Computed by hand: 2 (cos 45°, sin 45°), + 1.5 (cos 15°, sin 15°), + 1 (cos 25°, sin 25°).
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

/// Four bones whose joints swing at different frequencies. The hand follows the sums of the angles, Σ Lᵢ (cos, sin)(θ₀
/// + … + θᵢ), along its whole curve, which closes after a period.
#[test]
fn hand_of_a_swinging_arm_follows_its_formula() {
    let lengths = [2.0, 1.5, 1.0, 0.5_f64];
    let swings = [(1.0, 0.8), (2.0, 0.9), (3.0, 0.7), (5.0, 0.5_f64)];
    let bone = |k: usize| ArmatureBone {
        name: format!("bone {k}"),
        parent: k.checked_sub(1),
        rest: LocalTransform {
            translation: Vec3A::X
                * k.checked_sub(1)
                    .map_or(0.0, |parent| lengths[parent] as f32),
            ..LocalTransform::IDENTITY
        },
    };
    let armature = Armature::new((0..4).map(bone).collect(), Vec::new()).unwrap();
    let (mut pose, mut model) = (armature.rest().clone(), vec![Affine3A::IDENTITY; 4]);
    let mut path = Vec::new();
    for frame in 0..=200 {
        let phase = std::f64::consts::TAU * f64::from(frame) / 200.0;
        let (mut heading, mut expected) = (0.0, glam::DVec2::ZERO);
        for (k, (frequency, swing)) in swings.into_iter().enumerate() {
            let angle = swing * (frequency * phase).sin();
            heading += angle;
            expected += glam::DVec2::from_angle(heading) * lengths[k];
            let bone = armature.bone_at(k).unwrap();
            let mut local = pose.local(bone).unwrap();
            local.rotation = Quat::from_rotation_z(angle as f32);
            pose.set_local(bone, local).unwrap();
        }
        armature.local_to_model(&pose, &mut model).unwrap();
        let hand = model[3].transform_point3a(Vec3A::X * lengths[3] as f32);
        assert!((hand.truncate().as_dvec2() - expected).length() < 5e-6);
        assert!(hand.z == 0.0 && hand.length() <= 5.0 + 1e-5);
        path.push(hand);
    }
    assert!((path[0] - path[200]).length() < 1e-5);
    // Sines are odd: the second half of the period is the first one mirrored and reversed.
    for k in 0..=100 {
        let mirrored = path[200 - k] * Vec3A::new(1.0, -1.0, 1.0);
        assert!((path[k] - mirrored).length() < 1e-5);
    }
}

#[test]
fn armature_of_a_skeleton_keeps_its_rest() {
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

/// A rig's keyframes rotate its bones while morph targets change its face.
#[test]
fn armature_of_a_skeleton_accepts_morph_targets() {
    let skeleton = RandomRig::new(61).skeleton;
    let bare = Armature::of_skeleton(&skeleton);
    let names = || vec!["smile".to_owned(), "frown".to_owned()];
    let armature = bare.clone().with_morph_targets(names()).unwrap();
    assert_eq!(armature.morph_targets(), names());
    assert_eq!(armature.rest().rotations(), bare.rest().rotations());
    let mut builder = Clip::builder("face", &armature);
    let weights = KeyedCurve::linear(vec![0.0, 2.0], vec![0.0, 1.0]).unwrap();
    let frown = armature.morph_target("frown").unwrap();
    builder.morph_weight(frown, weights).unwrap();
    let mut pose = armature.rest().clone();
    assert_eq!(pose.morph_weights(), [0.0, 0.0]);
    let clip = builder.build();
    clip.sample(0.5, Playback::Hold, &mut Cursor::new(), &mut pose)
        .unwrap();
    assert_eq!(pose.morph_weights(), [0.0, 0.25]);
    // Poses of the armature without morph targets have another size.
    assert!(pose.cross_fade(bare.rest(), 0.5).is_err());
    // Not without weights again, and no two of one name.
    assert_eq!(
        armature.clone().with_morph_targets(Vec::new()).unwrap(),
        bare
    );
    // Other targets rest at zero, independent of earlier rest weights.
    let smiling = armature.with_rest_morph_weights(&[0.7, 0.2]).unwrap();
    let others = smiling.with_morph_targets(names()).unwrap();
    assert_eq!(others.rest().morph_weights(), [0.0, 0.0]);
    let twice = bare.with_morph_targets(vec!["smile".to_owned(); 2]);
    twice.says("`smile`");
}

/// B_j⁻¹ maps a point of the skin at rest to its bone, and W_j maps it from there to its current position.
#[test]
fn points_fixed_to_a_bone_move_with_it() {
    let mut random = Random::new(54);
    let armature = armature(30, &mut random);
    let pose = pose(&armature, &mut random);
    let mut model = vec![Affine3A::IDENTITY; 30];
    let mut skin = model.clone();
    armature.local_to_model(&pose, &mut model).unwrap();
    armature.skinning_transforms(&model, &mut skin).unwrap();
    let rest = model_by_ancestors(&armature, armature.rest());
    let posed = model_by_ancestors(&armature, &pose);
    for bone in 0..30 {
        let point = support::armatures::vector(&mut random, 0.5);
        let expected = posed[bone].transform_point3a(point);
        let at_rest = rest[bone].transform_point3a(point);
        let deviation = (skin[bone].transform_point3a(at_rest) - expected).length();
        assert!(
            deviation < 1e-4 * (1.0 + expected.length()),
            "{bone}: {deviation}"
        );
    }
}

#[test]
fn invalid_local_transforms_fail_or_are_repaired() {
    let mut random = Random::new(55);
    let armature = armature(3, &mut random);
    let bone = armature.bone_at(1).unwrap();
    let mut pose = armature.rest().clone();
    let good = pose.local(bone).unwrap();
    let with = |rotation| LocalTransform { rotation, ..good };
    let zero = with(Quat::from_xyzw(0.0, 0.0, 0.0, 0.0));
    let refused = pose.set_local(bone, zero).unwrap_err();
    assert_eq!(refused, ClipError::ZeroRotation { bone: 1 });
    for invalid in [
        with(Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0)),
        LocalTransform {
            translation: Vec3A::INFINITY,
            ..good
        },
        LocalTransform {
            scale: Vec3A::NAN,
            ..good
        },
    ] {
        let refused = pose.set_local(bone, invalid).unwrap_err();
        assert_eq!(refused, ClipError::NonFiniteTransform { bone: 1 });
    }
    let big = support::armatures::armature(9, &mut random);
    let stranger = big.bone_at(8).unwrap();
    let refused = pose.set_local(stranger, good).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "bone 8 does not exist; the pose has 3 bones"
    );
    assert_eq!(&pose, armature.rest());
    for length in [1e-30, 0.5, 3.0, 1e30] {
        pose.set_local(bone, with(good.rotation * length)).unwrap();
        let apart = support::armatures::apart(pose.rotations()[1], good.rotation);
        assert!(pose.rotations()[1].is_normalized() && apart < 1e-6);
    }
}

#[test]
fn invalid_armatures_and_sizes_are_named() {
    let bone = |name: &str, parent| ArmatureBone {
        name: name.into(),
        parent,
        rest: LocalTransform::IDENTITY,
    };
    let build = |bones: Vec<ArmatureBone>| Armature::new(bones, Vec::new());
    let ring = build(vec![bone("a", Some(0))]).unwrap_err();
    assert_eq!(ring, ClipError::ParentNotBefore { bone: "a".into() });
    let twice = build(vec![bone("a", None), bone("a", Some(0))]).unwrap_err();
    assert!(twice.to_string().contains("`a` is used twice"));
    let rest = LocalTransform::IDENTITY;
    let turned = |rotation| LocalTransform { rotation, ..rest };
    for rest in [
        turned(Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)),
        turned(Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0)),
        LocalTransform {
            translation: Vec3A::new(0.0, f32::NAN, 0.0),
            ..rest
        },
        LocalTransform {
            scale: Vec3A::new(1.0, 1.0, f32::INFINITY),
            ..rest
        },
    ] {
        let mut odd = bone("odd", None);
        odd.rest = rest;
        let error = build(vec![odd]).unwrap_err();
        assert_eq!(error, ClipError::BadRest { bone: "odd".into() });
    }
    let targets = vec!["smile".to_owned(), "smile".to_owned()];
    assert!(Armature::new(vec![bone("a", None)], targets).is_err());

    let armature = build(vec![bone("a", None), bone("b", Some(0))]).unwrap();
    let unknown = armature.bone("c").unwrap_err();
    assert_eq!(unknown.valid, ["a", "b"]);
    let mut model = vec![Affine3A::IDENTITY; 3];
    let error = armature
        .local_to_model(armature.rest(), model.as_mut_slice())
        .unwrap_err();
    assert_eq!((error.given, error.expected), (3, 2));
    // A vector is resized as needed, and keeps its memory.
    let memory = model.as_ptr();
    armature
        .local_to_model(armature.rest(), &mut model)
        .unwrap();
    assert_eq!((model.len(), model.as_ptr()), (2, memory));
    let mut posed = Vec::new();
    armature.skinning_transforms(&model, &mut posed).unwrap();
    assert_eq!(posed.len(), 2);
    model.push(Affine3A::IDENTITY);
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

/// A copied pose equals its source and reuses existing memory.
#[test]
fn copied_pose_equals_its_source() {
    let bones = ["a", "b"].map(|name| kinopt::animation::ArmatureBone {
        name: name.into(),
        parent: None,
        rest: LocalTransform::IDENTITY,
    });
    let targets = vec!["smile".to_owned(), "frown".to_owned()];
    let armature = Armature::new(bones.into(), targets).unwrap();
    let mut from = armature.rest().clone();
    let local = LocalTransform {
        translation: Vec3A::new(1.0, 2.0, 3.0),
        rotation: Quat::from_rotation_z(0.3),
        scale: Vec3A::splat(2.0),
    };
    from.set_local(armature.bone("b").unwrap(), local).unwrap();
    from.morph_weights_mut().copy_from_slice(&[0.25, 0.75]);
    let mut to = armature.rest().clone();
    assert_ne!(to, from);
    to.copy_from(&from);
    assert_eq!(to, from);
}
