//! Promise: a clip with fewer keys is within the stated error of the original clip at all its key times. It has no
//! redundant keys on straight lines.

use glam::{Quat, Vec3A};
use kinopt::animation::curve::KeyedCurve;
use kinopt::animation::rotation::RotationCurve;
use kinopt::animation::{Armature, Channel, Clip, KeyTolerance, Pose};
use support::armatures::{apart, armature};
use support::random::Random;

use super::baked_clips::at;

const KEYS: usize = 200;

/// Smooth motion of all bones with many keys.
fn wavy(armature: &Armature, random: &mut Random) -> Clip {
    let times: Vec<f32> = (0..KEYS).map(|key| key as f32 / 60.0).collect();
    let mut poses: Vec<Pose> = vec![armature.rest().clone(); KEYS];
    for bone in armature.bone_ids() {
        let (pace, axis) = (
            random.within(0.5, 6.0) as f32,
            support::armatures::vector(random, 1.0),
        );
        for (time, pose) in times.iter().zip(&mut poses) {
            let mut local = pose.local(bone).unwrap();
            let wave = (pace * time).sin();
            local.translation += axis * wave;
            local.rotation *= Quat::from_scaled_axis((axis * wave).into());
            local.scale += axis.abs() * (0.1 * wave);
            pose.set_local(bone, local).unwrap();
        }
    }
    Clip::through_poses("wavy", armature, &times, &poses).unwrap()
}

fn keys(clip: &Clip, armature: &Armature) -> usize {
    let key_count = |channel: &Channel| match channel {
        Channel::Translation(curve) | Channel::Scale(curve) => curve.times().len(),
        Channel::Rotation(curve) => curve.times().len(),
        _ => unreachable!(),
    };
    let channels = clip.channels(armature).unwrap();
    channels.iter().map(|(_, channel)| key_count(channel)).sum()
}

#[test]
fn reduced_clip_stays_within_the_error() {
    let random = &mut Random::new(41);
    let armature = armature(8, random);
    let clip = wavy(&armature, random);
    let mut before = keys(&clip, &armature);
    for size in [1e-4, 1e-3, 1e-2, 0.1] {
        let tolerance = KeyTolerance::EXACT
            .with_translation(size)
            .with_rotation(2.0 * size)
            .with_scale(0.5 * size);
        let fewer = clip.with_fewer_keys(&armature, &tolerance).unwrap();
        assert_eq!(fewer.span(), clip.span());
        for key in 0..KEYS {
            let time = key as f32 / 60.0;
            let (was, is) = (at(&clip, &armature, time), at(&fewer, &armature, time));
            for bone in armature.bone_ids() {
                let (was, is) = (was.local(bone).unwrap(), is.local(bone).unwrap());
                let rounding = 2e-6;
                assert!((was.translation - is.translation).length() <= size + rounding);
                assert!(apart(was.rotation, is.rotation) <= 2.0 * size + rounding);
                assert!((was.scale - is.scale).abs().max_element() <= 0.5 * size + rounding);
            }
        }
        let now = keys(&fewer, &armature);
        assert!(now < before, "{now} of {before} keys at {size}");
        before = now;
    }
}

#[test]
fn straight_lines_keep_only_their_ends() {
    let random = &mut Random::new(42);
    let armature = armature(2, random);
    let bone = armature.bone("bone 1").unwrap();
    let times: Vec<f32> = (0..=64).map(|key| key as f32 / 64.0).collect();
    let line = times
        .iter()
        .map(|time| Vec3A::new(*time, 0.0, 1.0))
        .collect();
    let turn = times
        .iter()
        .map(|time| Quat::from_rotation_y(2.0 * time))
        .collect();
    let still = vec![Vec3A::splat(2.0); times.len()];
    let mut builder = Clip::builder("line", &armature);
    builder
        .channel(
            bone,
            Channel::Translation(KeyedCurve::linear(times.clone(), line).unwrap()),
        )
        .unwrap();
    builder
        .channel(
            bone,
            Channel::Rotation(RotationCurve::slerp(times.clone(), turn).unwrap()),
        )
        .unwrap();
    builder
        .channel(
            bone,
            Channel::Scale(KeyedCurve::linear(times, still).unwrap()),
        )
        .unwrap();
    let clip = builder.build();
    let tolerance = KeyTolerance::EXACT.with_rotation(1e-6);
    let fewer = clip.with_fewer_keys(&armature, &tolerance).unwrap();
    // Two keys of the line, two of the rotation, one of the constant channel.
    assert_eq!(keys(&fewer, &armature), 5);
}

/// Weights of morph targets are ratios like scales, and use their tolerance.
#[test]
fn morph_weights_use_the_scale_tolerance() {
    let random = &mut Random::new(46);
    let armature = armature(1, random);
    let armature = armature.with_morph_targets(vec!["smile".into()]).unwrap();
    let mut builder = Clip::builder("smile", &armature);
    let curve = KeyedCurve::linear(vec![0.0, 1.0, 2.0], vec![0.0, 0.45, 1.0]);
    builder.morph_weight(0, curve.unwrap()).unwrap();
    let clip = builder.build();
    for (scale, expected) in [(0.06, 2), (0.04, 3)] {
        let tolerance = KeyTolerance::EXACT
            .with_translation(0.1 - scale)
            .with_rotation(0.1 - scale)
            .with_scale(scale);
        let fewer = clip.with_fewer_keys(&armature, &tolerance).unwrap();
        let weights = fewer.morph_channels(&armature).unwrap();
        assert_eq!(weights[0].1.times().len(), expected, "within {scale}");
    }
}

#[test]
fn jump_keeps_its_keys() {
    let random = &mut Random::new(43);
    let armature = armature(1, random);
    let bone = armature.bone("bone 0").unwrap();
    let times = vec![0.0, 1.0, 1.001, 2.0];
    let jump = [0.0, 0.0, 1.0, 1.0].map(Vec3A::splat).to_vec();
    let mut builder = Clip::builder("jump", &armature);
    builder
        .channel(
            bone,
            Channel::Translation(KeyedCurve::linear(times, jump).unwrap()),
        )
        .unwrap();
    let clip = builder.build();
    let fewer = clip
        .with_fewer_keys(&armature, &KeyTolerance::EXACT.with_translation(0.01))
        .unwrap();
    assert_eq!(fewer, clip);
}

/// After a full turn a quaternion has the opposite sign, which is the same rotation. A constant part after it needs no
/// more keys.
#[test]
fn whole_turn_needs_no_keys_after_it() {
    let random = &mut Random::new(44);
    let armature = armature(1, random);
    let bone = armature.bone("bone 0").unwrap();
    let third = std::f32::consts::TAU / 3.0;
    let times: Vec<f32> = (0..40).map(|key| key as f32).collect();
    let turn = |key: usize| Quat::from_rotation_z(third * key.min(3) as f32);
    let turns = (0..40).map(turn).collect();
    let mut builder = Clip::builder("turn", &armature);
    let curve = RotationCurve::slerp(times, turns).unwrap();
    builder.channel(bone, Channel::Rotation(curve)).unwrap();
    let tolerance = KeyTolerance::EXACT.with_rotation(1e-4);
    let fewer = builder.build();
    let fewer = fewer.with_fewer_keys(&armature, &tolerance).unwrap();
    // Three thirds of a turn, and the end.
    assert_eq!(keys(&fewer, &armature), 5);
}

/// A clip may begin before its first key and end after its last. Fewer keys, another rest pose or another seam do not
/// change its duration.
#[test]
fn changed_clips_keep_their_duration() {
    let random = &mut Random::new(45);
    let armature = armature(2, random);
    let bone = armature.bone("bone 1").unwrap();
    let line = [0.0, 1.0, 2.0].map(Vec3A::splat).to_vec();
    let mut builder = Clip::builder("line", &armature);
    let curve = KeyedCurve::linear(vec![1.0, 2.0, 3.0], line).unwrap();
    builder.channel(bone, Channel::Translation(curve)).unwrap();
    builder.span(-0.5, 4.25).unwrap();
    builder.event(0.5, "step").unwrap();
    let clip = builder.build();
    let fewer = clip.with_fewer_keys(&armature, &KeyTolerance::EXACT);
    let rebased = clip.at_rest_in(&armature, &armature);
    for changed in [fewer, rebased] {
        let changed = changed.unwrap();
        assert_eq!(changed.span(), [-0.5, 4.25]);
        assert_eq!(changed.duration(), 4.75);
        assert_eq!(changed.events(), clip.events());
    }
}
