//! Promise: so it is for poses: blended, layered, placed in the model, and as files.
#![allow(clippy::unwrap_used)]

use glam::{Affine3A, Quat, Vec3A};
use kinopt::animation::{
    Armature, ArmatureBone, BoneMask, Layer, LayerMode, LocalTransform, Pose, blend_poses,
};
use support::random::Random;

use crate::animated::{armature, bone, check_single, local, pose, rotation, vector};
use crate::digest::{Digest, Value};

fn faded() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(111));
    let (body, small) = (armature(19, &mut random), armature(2, &mut random));
    let mask = BoneMask::all(&body).with_bone(bone(&body, 3), 0.4).unwrap();
    let mask = mask.with_subtree(&body, bone(&body, 1), 0.25).unwrap();
    let mask = mask.with_bone(bone(&body, 17), 0.0).unwrap();
    let mask = mask.with_morph_target(1, 0.5).unwrap();
    let part = BoneMask::none(&body).with_subtree(&body, bone(&body, 0), 0.75);
    let part = part.unwrap().with_bone(bone(&body, 9), 1.0).unwrap();
    let masks = [mask, part, BoneMask::all(&body), BoneMask::none(&body)];
    for mask in &masks {
        digest.singles(mask.bones().iter().chain(mask.morph_targets()).copied());
    }
    let (from, to) = (pose(&body, &mut random), pose(&body, &mut random));
    let mut flat = pose(&body, &mut random);
    flat.set_scale(bone(&body, 2), Vec3A::new(0.0, 1.0, 2.0))
        .unwrap();
    for share in [0.0, 0.3, 0.8, 1.0, 1.5, -0.5, f32::NAN] {
        let mut own = from.clone();
        own.cross_fade(&to, share).unwrap();
        digest.pose(&own);
        for mask in &masks {
            let mut own = from.clone();
            own.cross_fade_masked(&to, share, mask).unwrap();
            digest.pose(&own);
            for mode in [
                LayerMode::Override,
                LayerMode::Additive {
                    reference: body.rest().clone(),
                },
                LayerMode::Additive {
                    reference: flat.clone(),
                },
            ] {
                let (mut own, mask) = (from.clone(), mask.clone());
                let layer = Layer {
                    mode,
                    weight: share,
                    mask,
                };
                layer.apply(&mut own, &to).unwrap();
                digest.pose(&own);
            }
        }
    }
    let mut own = from.clone();
    let (none, other) = (BoneMask::none(&small), small.rest());
    digest.refused(own.cross_fade(other, 0.5));
    let fewer = body.clone().with_morph_targets(vec!["a".into()]).unwrap();
    digest.refused(own.cross_fade(fewer.rest(), 0.5));
    digest.refused(own.cross_fade_masked(&to, 0.5, &BoneMask::all(&fewer)));
    digest.refused(own.cross_fade_masked(&to, 0.5, &none));
    digest.refused(own.cross_fade_masked(other, 0.5, &masks[0]));
    let layer = |reference: &Pose, mask: &BoneMask| Layer {
        mode: LayerMode::Additive {
            reference: reference.clone(),
        },
        weight: 1.0,
        mask: mask.clone(),
    };
    digest.refused(layer(other, &masks[0]).apply(&mut own, &to));
    digest.refused(layer(&from, &masks[0]).apply(&mut own, other));
    digest.refused(layer(&from, &none).apply(&mut own, &to));
    let far = bone(&body, 12);
    digest.refused(BoneMask::none(&small).with_bone(far, 0.5));
    digest.refused(BoneMask::none(&small).with_bone(bone(&small, 1), 1.5));
    digest.refused(BoneMask::none(&small).with_bone(bone(&small, 1), f32::NAN));
    digest.refused(BoneMask::none(&small).with_morph_target(2, 0.5));
    digest.refused(BoneMask::none(&small).with_morph_target(0, -0.5));
    digest.refused(BoneMask::none(&small).with_subtree(&body, bone(&small, 1), 0.5));
    digest.refused(BoneMask::none(&small).with_subtree(&body, far, 0.5));
    digest.value()
}

fn weighted() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(112));
    let body = armature(5, &mut random);
    let mut poses = [(); 3].map(|()| pose(&body, &mut random));
    let opposite = poses[0].rotations()[1] * Quat::from_xyzw(1.0, 0.0, 0.0, 0.0);
    poses[1].set_rotation(bone(&body, 1), -opposite).unwrap();
    let mut out = poses[2].clone();
    for weights in [
        [0.2, 0.5, 0.3],
        [2.0, 2.0, 1.0],
        [0.0, 1.0, 1.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [1e-3, 7.0, 7.5],
    ] {
        let parts: Vec<(&Pose, f32)> = poses.iter().zip(weights).collect();
        blend_poses(&parts, &mut out).unwrap();
        digest.pose(&out);
    }
    let flipped = |q: Quat| Quat::from_xyzw(-q.x, -q.y, -q.z, q.w);
    let mut against = poses[0].clone();
    let turned = poses[0].rotations()[0];
    against
        .set_rotation(bone(&body, 0), flipped(turned))
        .unwrap();
    blend_poses(&[(&poses[0], 1.0), (&against, 1.0)], &mut out).unwrap();
    digest.pose(&out);
    let small = armature(2, &mut random);
    digest.refused(blend_poses(&[], &mut out));
    digest.refused(blend_poses(&[(&poses[0], 0.0)], &mut out));
    digest.refused(blend_poses(
        &[(&poses[0], 1.0), (&poses[1], -1.0)],
        &mut out,
    ));
    digest.refused(blend_poses(&[(&poses[0], f32::INFINITY)], &mut out));
    digest.refused(blend_poses(
        &[(&poses[0], 1.0), (small.rest(), 1.0)],
        &mut out,
    ));
    digest.value()
}

fn placed() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(113));
    let body = armature(9, &mut random);
    let mut own = pose(&body, &mut random);
    let mut even = own.clone();
    for bone in body.bone_ids() {
        even.set_scale(bone, Vec3A::splat(0.8)).unwrap();
    }
    let (mut model, mut skin) = (Vec::new(), Vec::new());
    body.local_to_model(&own, &mut model).unwrap();
    body.skinning_transforms(&model, &mut skin).unwrap();
    digest.affines(&model);
    digest.affines(&skin);
    digest.affines(body.rest_from_model());
    for index in [0, 4, 8] {
        let id = bone(&body, index);
        digest.affine(&body.model_from_bone(&own, id).unwrap());
        digest.quaternion(body.model_rotation(&own, id).unwrap());
        digest.debug(body.parent(id));
        body.set_model_rotation(&mut own, id, rotation(&mut random) * 2.0)
            .unwrap();
        body.set_model_translation(&mut own, id, vector(&mut random, 2.0))
            .unwrap();
        digest.pose(&own);
        for scale in [1.5, -0.5] {
            let mut to = local(&mut random);
            to.scale = Vec3A::new(scale, 0.7, 1.2);
            body.set_model_from_bone(&mut even, id, to.to_affine())
                .unwrap();
            digest.pose(&even);
            even.set_scale(id, Vec3A::splat(1.1)).unwrap();
        }
        own.set_rotation(id, Quat::from_xyzw(0.0, 3.0, 0.0, 4.0))
            .unwrap();
        own.set_translation(id, Vec3A::X).unwrap();
        digest.debug(own.local(id).unwrap().is_valid());
    }
    digest.pose(&own);
    for transform in [local(&mut random), LocalTransform::IDENTITY] {
        let affine = transform.to_affine();
        digest.affine(&affine);
        digest.debug(LocalTransform::of_affine(&affine));
        let mut sheared = affine;
        sheared.matrix3.x_axis += sheared.matrix3.y_axis * 0.01;
        digest.debug(LocalTransform::of_affine(&sheared));
        sheared.matrix3.x_axis = Vec3A::ZERO;
        digest.debug(LocalTransform::of_affine(&sheared));
    }
    let (small, far) = (armature(2, &mut random), bone(&body, 7));
    let mut little = small.rest().clone();
    digest.refused(small.model_from_bone(&little, far));
    digest.refused(body.model_from_bone(&little, far));
    digest.refused(body.model_rotation(&little, far));
    digest.refused(little.local(far));
    digest.refused(little.set_rotation(far, Quat::IDENTITY));
    let first = bone(&small, 0);
    let second = bone(&small, 1);
    digest.refused(little.set_rotation(first, Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)));
    digest.refused(little.set_scale(second, Vec3A::NAN));
    digest.refused(little.set_translation(second, Vec3A::INFINITY));
    digest.refused(small.set_model_rotation(&mut little, second, Quat::NAN));
    digest.refused(small.set_model_from_bone(&mut little, second, Affine3A::NAN));
    digest.refused(small.set_model_from_bone(&mut little, second, Affine3A::ZERO));
    little.set_scale(first, Vec3A::new(1.0, 1.0, 1e-9)).unwrap();
    digest.refused(small.set_model_translation(&mut little, second, Vec3A::X));
    let thin = 1e-4;
    for scale in [[1.0, thin, thin], [thin, 1.0, thin], [thin, thin, 1.0]] {
        little.set_scale(first, scale.into()).unwrap();
        digest.refused(small.set_model_translation(&mut little, second, Vec3A::X));
    }
    digest.refused(body.local_to_model(&little, &mut model));
    digest.refused(body.local_to_model(&own, &mut model[..3]));
    digest.refused(body.skinning_transforms(&model[..2], &mut skin));
    digest.refused(body.skinning_transforms(&model, &mut skin[..4]));
    digest.value()
}

fn armatures() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(114));
    let body = armature(4, &mut random);
    let weighed = body.clone().with_rest_morph_weights(&[0.25, 0.5]).unwrap();
    let other = pose(&body, &mut random);
    let moved = weighed.clone().at_rest_in(&other).unwrap();
    let renamed = body.clone().with_morph_targets(vec!["a".into()]).unwrap();
    for armature in [&weighed, &moved, &renamed] {
        digest.json(armature);
        let text = serde_json::to_string(armature).unwrap();
        let again: Armature = serde_json::from_str(&text).unwrap();
        digest.debug((again.names(), again.morph_targets(), again.bones()));
        digest.pose(again.rest());
        digest.affines(again.rest_from_model());
        digest.debug(
            again
                .bone_ids()
                .map(|b| again.parent(b))
                .collect::<Vec<_>>(),
        );
        digest.debug((again.bone("bone 2").unwrap(), again.bone_at(4)));
        digest.debug(again.morph_target("frown").ok());
        digest.refused(again.bone("bome 2"));
        digest.refused(again.morph_target("grin"));
    }
    let text = serde_json::to_string(&weighed).unwrap();
    for (from, to) in [
        ("[\"bone 0\",", "["),
        ("\"bone 1\"", "\"bone 0\""),
        ("[0.25,0.5]", "[0.25]"),
        ("\"parents\":[null", "\"parents\":[3"),
        (
            "\"rest_from_model\":[[",
            "\"rest_from_model\":[[1,0,0,0,1,0,0,0,1,0,0,0],[",
        ),
        ("\"rotations\":[[", "\"rotations\":[[1e20,"),
        ("\"scales\":[[", "\"scales\":[[1,1,1],["),
    ] {
        let text = text.replacen(from, to, 1);
        let read = serde_json::from_str::<Armature>(&text);
        digest.text(read.map_or_else(|error| error.to_string(), |_| "read".to_owned()));
    }
    let bone = |name: &str, parent, rest| ArmatureBone {
        name: name.into(),
        parent,
        rest,
    };
    let (at, mut bad) = (LocalTransform::IDENTITY, LocalTransform::IDENTITY);
    bad.rotation = Quat::from_xyzw(0.0, 0.0, 0.0, 2.0);
    for bones in [
        vec![bone("a", Some(0), at)],
        vec![bone("a", None, at), bone("a", Some(0), at)],
        vec![bone("a", None, at), bone("b", Some(0), bad)],
        vec![bone("a", None, at), bone("b", Some(2), at)],
    ] {
        digest.refused(Armature::new(bones, Vec::new()));
    }
    let twice = vec!["smile".to_owned(), "smile".to_owned()];
    digest.refused(Armature::new(vec![bone("a", None, at)], twice.clone()));
    digest.refused(body.clone().with_morph_targets(twice));
    digest.refused(body.clone().with_rest_morph_weights(&[0.0]));
    digest.refused(body.clone().at_rest_in(armature(2, &mut random).rest()));
    digest.value()
}

#[test]
fn of_poses() {
    check_single(&[
        ("poses, faded and layered", faded()),
        ("poses, weighed", weighted()),
        ("poses in the model", placed()),
        ("armatures", armatures()),
    ]);
}
