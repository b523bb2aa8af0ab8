//! Promise: poses blend by their rotations (slerp, shortest arc), masks exclude bones, and additive layers add exactly
//! their difference.

use glam::Quat;
use kinopt::animation::rotation::slerp;
use kinopt::animation::{Armature, BoneMask, Layer, LayerError, LayerMode, Pose, blend_poses};
use support::armatures::{apart, armature, difference, pose};
use support::fault_tables::ExpectedError;
use support::random::Random;

/// Armature of more than two groups of eight bones, and poses of it.
fn poses<const N: usize>(random: &mut Random) -> (Armature, [Pose; N]) {
    let armature = armature(21, random);
    let poses = std::array::from_fn(|_| pose(&armature, random));
    (armature, poses)
}

#[test]
fn cross_fade_is_slerp_of_each_bone() {
    let mut random = Random::new(81);
    for _ in 0..60 {
        let (armature, [from, mut to]) = poses::<2>(&mut random);
        // The same rotation with the opposite sign.
        let bone = armature.bone_at(9).unwrap();
        let mut local = to.local(bone).unwrap();
        local.rotation = -local.rotation;
        to.set_local(bone, local).unwrap();
        for share in [0.0, 0.2, 0.5, 0.8, 1.0] {
            let mut blended = from.clone();
            blended.cross_fade(&to, share).unwrap();
            let rotations = from.rotations().iter().zip(to.rotations());
            for ((a, b), actual) in rotations.zip(blended.rotations()) {
                assert!(apart(*actual, slerp(*a, *b, share)) < 5e-5);
                assert!((actual.length() - 1.0).abs() < 1e-6);
            }
            let moved = from.translations().iter().zip(to.translations());
            for ((a, b), actual) in moved.zip(blended.translations()) {
                assert!((*actual - (*a + (*b - *a) * share)).length() < 1e-6);
            }
        }
        let mut end = from.clone();
        end.cross_fade(&to, 7.0).unwrap();
        assert!(difference(&end, &to) < 2e-6);
        end = from.clone();
        end.cross_fade(&to, f32::NAN).unwrap();
        assert!(difference(&end, &from) < 2e-6);
    }
}

#[test]
fn masked_bones_are_unchanged() {
    let mut random = Random::new(82);
    let (armature, [from, to]) = poses::<2>(&mut random);
    let root = armature.bone("bone 3").unwrap();
    let single = armature.bone("bone 0").unwrap();
    let mask = BoneMask::none(&armature)
        .with_subtree(&armature, root, 1.0)
        .unwrap()
        .with_bone(single, 0.5)
        .unwrap()
        .with_morph_target(armature.morph_target("frown").unwrap(), 1.0)
        .unwrap();
    let under = |index: usize| {
        let mut next = armature.bone_at(index);
        while let Some(bone) = next {
            if bone == root {
                return true;
            }
            next = armature.parent(bone);
        }
        false
    };
    let mut blended = from.clone();
    blended.cross_fade_masked(&to, 1.0, &mask).unwrap();
    let mut half = from.clone();
    half.cross_fade(&to, 0.5).unwrap();
    for index in 0..armature.bones() {
        let bone = armature.bone_at(index).unwrap();
        let expected = match index {
            0 => &half,
            _ if under(index) => &to,
            _ => &from,
        };
        let (actual, expected) = (blended.local(bone).unwrap(), expected.local(bone).unwrap());
        assert!(apart(actual.rotation, expected.rotation) < 1e-5, "{index}");
        assert!((actual.translation - expected.translation).length() < 1e-6);
        assert!((actual.scale - expected.scale).length() < 1e-6);
    }
    assert_eq!(blended.morph_weights()[0], from.morph_weights()[0]);
    assert!((blended.morph_weights()[1] - to.morph_weights()[1]).abs() < 1e-6);
}

#[test]
fn mean_ignores_order_signs_and_scale() {
    let mut random = Random::new(83);
    for _ in 0..30 {
        let (_, [a, b, c]) = poses::<3>(&mut random);
        let mut out = a.clone();
        blend_poses(&[(&a, 0.5), (&b, 0.2), (&c, 0.3)], &mut out).unwrap();
        let mut other = b.clone();
        blend_poses(&[(&c, 3.0), (&b, 2.0), (&a, 5.0)], &mut other).unwrap();
        assert!(difference(&out, &other) < 2e-6);
        blend_poses(&[(&a, 0.0), (&b, 4.0), (&c, 0.0)], &mut out).unwrap();
        assert!(difference(&out, &b) < 2e-6);
        // Half of each of two poses is the middle of the arc.
        blend_poses(&[(&a, 1.0), (&b, 1.0)], &mut out).unwrap();
        let mut middle = a.clone();
        middle.cross_fade(&b, 0.5).unwrap();
        assert!(difference(&out, &middle) < 1e-4);
    }
}

/// Three rotations about one axis, two of which are more than half a turn apart. Each takes the shorter arc to that of
/// the largest weight.
#[test]
fn mean_is_in_the_hemisphere_of_the_heaviest() {
    let mut random = Random::new(85);
    let (armature, [mut a, mut b, mut c]) = poses::<3>(&mut random);
    for (pose, degrees) in [(&mut a, 0.0_f32), (&mut b, 150.0), (&mut c, -150.0)] {
        for index in 0..armature.bones() {
            let bone = armature.bone_at(index).unwrap();
            let turn = Quat::from_rotation_z(degrees.to_radians());
            pose.set_rotation(bone, turn).unwrap();
        }
    }
    let mut out = a.clone();
    blend_poses(&[(&b, 0.2), (&a, 0.5), (&c, 0.3)], &mut out).unwrap();
    let half = 75_f32.to_radians();
    let (sin, cos) = (-0.1 * half.sin(), 0.5 + 0.5 * half.cos());
    let expected = Quat::from_rotation_z(2.0 * sin.atan2(cos));
    for rotation in out.rotations() {
        assert!(rotation.dot(expected).abs() > 1.0 - 1e-5, "{rotation}");
    }
}

#[test]
fn invalid_weights_are_errors() {
    let mut random = Random::new(84);
    let (_, [a, b]) = poses::<2>(&mut random);
    let mut out = a.clone();
    for weight in [-0.1, f32::NAN, f32::INFINITY] {
        let error = blend_poses(&[(&a, 1.0), (&b, weight)], &mut out).unwrap_err();
        assert!(
            matches!(error, LayerError::BadWeight { pose: 1, .. }),
            "{error}"
        );
    }
    assert_eq!(
        blend_poses(&[(&a, 0.0)], &mut out),
        Err(LayerError::NoWeight)
    );
    assert_eq!(blend_poses(&[], &mut out), Err(LayerError::NoWeight));
    assert_eq!(out, a);
    let small = armature(3, &mut random);
    blend_poses(&[(&a, 1.0), (small.rest(), 1.0)], &mut out).says("3 bones");
    assert!(out.cross_fade(small.rest(), 0.5).is_err());
    let mask = BoneMask::all(&small);
    assert!(out.cross_fade_masked(&b, 0.5, &mask).is_err());
}

#[test]
fn additive_layer_adds_its_difference() {
    let mut random = Random::new(85);
    for _ in 0..30 {
        let (armature, [base, layer, reference]) = poses::<3>(&mut random);
        let additive = |weight: f32, mask: BoneMask| Layer {
            mode: LayerMode::Additive {
                reference: reference.clone(),
            },
            weight,
            mask,
        };
        let all = || BoneMask::all(&armature);
        // On its own reference, the full difference is the layer itself.
        let mut onto = reference.clone();
        additive(1.0, all()).apply(&mut onto, &layer).unwrap();
        assert!(difference(&onto, &layer) < 1e-5);
        // With weight zero, or with the reference itself, nothing changes.
        for (weight, pose) in [(0.0, &layer), (f32::NAN, &layer), (1.0, &reference)] {
            let mut onto = base.clone();
            additive(weight, all()).apply(&mut onto, pose).unwrap();
            assert!(difference(&onto, &base) < 2e-6);
        }
        // Two halves are a whole.
        let mut halves = base.clone();
        for _ in 0..2 {
            additive(0.5, all()).apply(&mut halves, &layer).unwrap();
        }
        let mut whole = base.clone();
        additive(1.0, all()).apply(&mut whole, &layer).unwrap();
        let turned = halves.rotations().iter().zip(whole.rotations());
        assert!(turned.map(|(a, b)| apart(*a, *b)).fold(0.0, f32::max) < 1e-5);
        // A layer with a mask of zero has no effect.
        let mut masked = base.clone();
        additive(1.0, BoneMask::none(&armature))
            .apply(&mut masked, &layer)
            .unwrap();
        assert!(difference(&masked, &base) < 2e-6);
        // In place of the base it is a masked cross-fade.
        let over = Layer {
            mode: LayerMode::Override,
            weight: 1.0,
            mask: all(),
        };
        let mut replaced = base.clone();
        over.apply(&mut replaced, &layer).unwrap();
        assert!(difference(&replaced, &layer) < 2e-6);
    }
}

#[test]
fn lean_is_added_to_a_walk() {
    let mut random = Random::new(86);
    let (armature, [walk]) = poses::<1>(&mut random);
    let spine = armature.bone("bone 2").unwrap();
    let mut lean = armature.rest().clone();
    let mut local = lean.local(spine).unwrap();
    local.rotation *= Quat::from_rotation_x(0.4);
    lean.set_local(spine, local).unwrap();
    let layer = Layer {
        mode: LayerMode::Additive {
            reference: armature.rest().clone(),
        },
        weight: 0.5,
        mask: BoneMask::all(&armature),
    };
    let mut leaning = walk.clone();
    layer.apply(&mut leaning, &lean).unwrap();
    let expected = walk.local(spine).unwrap().rotation * Quat::from_rotation_x(0.2);
    assert!(apart(leaning.local(spine).unwrap().rotation, expected) < 1e-5);
    let other = armature.bone("bone 7").unwrap();
    assert!(
        apart(
            leaning.local(other).unwrap().rotation,
            walk.local(other).unwrap().rotation
        ) < 1e-6
    );
}

/// A scale of zero has no ratio to another: the layer leaves such an axis unchanged.
#[test]
fn zero_scale_reference_leaves_the_base() {
    let mut random = Random::new(87);
    let (armature, [base, layer, mut reference]) = poses::<3>(&mut random);
    let bone = armature.bone("bone 2").unwrap();
    let mut local = reference.local(bone).unwrap();
    local.scale.y = 0.0;
    reference.set_local(bone, local).unwrap();
    for scale in [0.0, 0.7] {
        let mut layer = layer.clone();
        let mut local = layer.local(bone).unwrap();
        local.scale.y = scale;
        layer.set_local(bone, local).unwrap();
        let additive = Layer {
            mode: LayerMode::Additive {
                reference: reference.clone(),
            },
            weight: 1.0,
            mask: BoneMask::all(&armature),
        };
        let mut onto = base.clone();
        additive.apply(&mut onto, &layer).unwrap();
        let [scaled, was] = [&onto, &base].map(|pose| pose.local(bone).unwrap().scale);
        assert!(scaled.is_finite() && scaled.y == was.y, "{scaled} {was}");
        assert!((scaled.x - was.x).abs() > 1e-6, "the other axes are scaled");
    }
}

/// A weight is within 0 and 1, for a bone, a subtree and a morph target.
#[test]
fn mask_rejects_weights_outside_0_to_1() {
    let armature = armature(5, &mut Random::new(86));
    let bone = armature.bone_at(2).unwrap();
    let mask = || BoneMask::all(&armature);
    for share in [-0.1, 1.1, f32::NAN, f32::INFINITY] {
        let results = [
            mask().with_bone(bone, share),
            mask().with_subtree(&armature, bone, share),
            mask().with_morph_target(0, share),
        ];
        for result in results {
            assert!(
                matches!(result, Err(LayerError::BadShare { .. })),
                "{result:?}"
            );
        }
    }
    for share in [0.0, 1.0] {
        assert!(mask().with_subtree(&armature, bone, share).is_ok());
    }
}
