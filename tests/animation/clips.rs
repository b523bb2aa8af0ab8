//! Promise: a clip's pose is the value of each channel's curve at that time, whatever was played before.

use glam::{Quat, Vec3A, Vec4};
use kinopt::animation::curve::{KeyedCurve, TensionContinuityBias};
use kinopt::animation::rotation::{EulerOrder, RotationCurve};
use kinopt::animation::{
    Armature, Channel, Clip, ClipError, Cursor, EulerClip, EulerCurve, EulerInterpolation,
    EulerKey, EulerTrack, Playback, Pose,
};
use support::armatures::{apart, armature, difference, rotation, vector};
use support::bones::RandomRig;
use support::fault_tables::ExpectedError;
use support::random::Random;

fn times(random: &mut Random) -> Vec<f32> {
    let mut at = 0.0;
    let count = 1 + random.below(9);
    let next = |_| {
        at += random.within(0.01, 0.7) as f32;
        at
    };
    (0..count).map(next).collect()
}

fn vectors(random: &mut Random, times: &[f32], mean: Vec3A) -> KeyedCurve<Vec3A> {
    let mut values =
        || -> Vec<Vec3A> { times.iter().map(|_| mean + vector(random, 0.4)).collect() };
    let (keys, other) = (values(), values());
    let times = times.to_vec();
    let tangents = keys.iter().zip(other).map(|(a, b)| [*a, b]).collect();
    let tcb = vec![
        TensionContinuityBias {
            tension: 0.2,
            ..Default::default()
        };
        times.len()
    ];
    match random.below(4) {
        0 => KeyedCurve::step(times, keys),
        1 => KeyedCurve::linear(times, keys),
        2 => KeyedCurve::cubic(times, keys, tangents),
        _ => KeyedCurve::kochanek_bartels(times, keys, &tcb),
    }
    .unwrap()
}

fn rotations(random: &mut Random, times: &[f32]) -> RotationCurve {
    // Some with the opposite sign, which is the same rotation.
    let keys = times
        .iter()
        .map(|_| rotation(random, 2.0) * [1.0, -1.0][random.below(2)]);
    let keys: Vec<Quat> = keys.collect();
    let tangents = keys
        .iter()
        .map(|_| [Vec4::splat(0.1), Vec4::splat(-0.2)])
        .collect();
    let times = times.to_vec();
    match random.below(5) {
        0 => RotationCurve::step(times, keys),
        1 => RotationCurve::squad(times, keys),
        2 => RotationCurve::smooth(times, keys),
        3 => RotationCurve::cubic(times, keys, tangents),
        _ => RotationCurve::slerp(times, keys),
    }
    .unwrap()
}

/// Clip, and its channels separately.
fn random_clip(armature: &Armature, random: &mut Random) -> (Clip, Vec<(usize, Channel)>) {
    let mut builder = Clip::builder("random", armature);
    let mut channels = Vec::new();
    let shared = times(random);
    for index in 0..armature.bones() {
        let times_of = |random: &mut Random| match random.below(2) {
            0 => shared.clone(),
            _ => times(random),
        };
        if random.below(4) > 0 {
            let times = times_of(random);
            channels.push((
                index,
                Channel::Translation(vectors(random, &times, Vec3A::ZERO)),
            ));
        }
        if random.below(4) > 0 {
            let times = times_of(random);
            channels.push((index, Channel::Scale(vectors(random, &times, Vec3A::ONE))));
        }
        let times = times_of(random);
        match random.below(6) {
            0 => {}
            1 => {
                let curve = EulerCurve {
                    order: EulerOrder::ALL[random.below(12)],
                    before: rotation(random, 1.0),
                    angles: vectors(random, &times, Vec3A::ZERO),
                };
                channels.push((index, Channel::Euler(curve)));
            }
            _ => channels.push((index, Channel::Rotation(rotations(random, &times)))),
        }
    }
    for (index, channel) in &channels {
        builder
            .channel(armature.bone_at(*index).unwrap(), channel.clone())
            .unwrap();
    }
    (builder.build(), channels)
}

/// Pose by each curve's own evaluation, which uses a binary search.
fn expected(armature: &Armature, channels: &[(usize, Channel)], time: f32) -> Pose {
    let mut pose = armature.rest().clone();
    for (index, channel) in channels {
        let bone = armature.bone_at(*index).unwrap();
        let mut local = pose.local(bone).unwrap();
        match channel {
            Channel::Translation(curve) => local.translation = curve.at(time),
            Channel::Scale(curve) => local.scale = curve.at(time),
            Channel::Rotation(curve) => local.rotation = curve.at(time),
            Channel::Euler(curve) => {
                let angles = curve.angles.at(time).as_dvec3().to_array();
                local.rotation = curve.before * curve.order.to_quaternion(angles).as_quat();
            }
            other => panic!("{other:?}"),
        }
        pose.set_local(bone, local).unwrap();
    }
    pose
}

#[test]
fn sampled_pose_equals_the_curves_in_any_order() {
    let mut random = Random::new(61);
    for _ in 0..40 {
        let armature = armature(1 + random.below(30), &mut random);
        let (clip, channels) = random_clip(&armature, &mut random);
        let [start, end] = clip.span();
        let (mut cursor, mut pose) = (Cursor::new(), armature.rest().clone());
        for step in 0..60 {
            // Forwards in small steps, then at random; key times included.
            let elapsed = match step {
                0..30 => f64::from(step) * 0.11 - 0.2,
                30..40 => clip.duration() * [0.0, 1.0][random.below(2)],
                _ => random.within(-1.0, f64::from(end - start) + 1.0),
            };
            let time = f64::from(start) + elapsed;
            clip.sample(time, Playback::Hold, &mut cursor, &mut pose)
                .unwrap();
            let time = time.max(f64::from(start)).min(f64::from(end));
            let expected = expected(&armature, &channels, time as f32);
            let deviation = difference(&pose, &expected);
            assert!(deviation < 5e-5, "{deviation} at {elapsed}");
            assert!(pose.rotations().iter().all(|q| q.is_normalized()));
        }
    }
}

#[test]
fn loops_and_ping_pong_repeat() {
    let mut random = Random::new(62);
    let armature = armature(12, &mut random);
    let (clip, _) = random_clip(&armature, &mut random);
    let length = clip.duration();
    let first = f64::from(clip.span()[0]);
    let at = |elapsed: f64, playback| {
        let mut pose = armature.rest().clone();
        let time = first + elapsed;
        clip.sample(time, playback, &mut Cursor::new(), &mut pose)
            .unwrap();
        pose
    };
    for share in [0.1, 0.35, 0.8] {
        let held = at(share * length, Playback::Hold);
        for cycle in [-3.0, -1.0, 0.0, 1.0, 7.0] {
            let looped = at((cycle + share) * length, Playback::Loop);
            assert!(difference(&held, &looped) < 1e-3);
            let forward = at((2.0 * cycle + share) * length, Playback::PingPong);
            let back = at((2.0 * cycle - share) * length, Playback::PingPong);
            assert!(difference(&held, &forward) < 1e-3 && difference(&held, &back) < 1e-3);
        }
    }
    let start = at(0.0, Playback::Hold);
    assert_eq!(at(-5.0, Playback::Hold), start);
    assert_eq!(at(length, Playback::Loop), at(length, Playback::Hold));
    for playback in [Playback::Hold, Playback::Loop, Playback::PingPong] {
        assert_eq!(at(f64::NAN, playback), start);
        assert!(
            at(f64::INFINITY, playback)
                .rotations()
                .iter()
                .all(|q| q.is_normalized())
        );
    }
}

/// Linear channels on every bone, each with its own key times, some of them equal.
fn captured_clip(armature: &Armature, random: &mut Random) -> Clip {
    let mut builder = Clip::builder("captured", armature);
    let mut keys = || -> Vec<f32> {
        let mut keys: Vec<f32> = (0..40).map(|_| random.below(500) as f32 / 100.0).collect();
        keys.sort_by(f32::total_cmp);
        keys.dedup();
        keys
    };
    let times: Vec<[Vec<f32>; 3]> = (0..armature.bones())
        .map(|_| [(); 3].map(|()| keys()))
        .collect();
    for (index, [moved, turned, scaled]) in times.into_iter().enumerate() {
        let mut vectors = |times: Vec<f32>| {
            let values = times.iter().map(|_| vector(random, 0.4)).collect();
            KeyedCurve::linear(times, values).unwrap()
        };
        let [moved, scaled] = [moved, scaled].map(&mut vectors);
        let rotations = turned.iter().map(|_| rotation(random, 2.0)).collect();
        let turned = RotationCurve::slerp(turned, rotations).unwrap();
        let bone = armature.bone_at(index).unwrap();
        for channel in [
            Channel::Translation(moved),
            Channel::Rotation(turned),
            Channel::Scale(scaled),
        ] {
            builder.channel(bone, channel).unwrap();
        }
    }
    builder.build()
}

/// An explicit span counts, not that of the keys. Outside of the keys the end values are held until the clip loops.
#[test]
fn explicit_span_overrides_the_keys() {
    let armature = armature(1, &mut Random::new(70));
    let bone = armature.bone_at(0).unwrap();
    let curve = KeyedCurve::linear(vec![0.0, 1.0], vec![Vec3A::ZERO, Vec3A::X]).unwrap();
    let mut builder = Clip::builder("late", &armature);
    builder.channel(bone, Channel::Translation(curve)).unwrap();
    builder.span(-1.0, 5.0).unwrap();
    let clip = builder.build();
    assert_eq!((clip.span(), clip.duration()), ([-1.0, 5.0], 6.0));
    let (mut pose, mut cursor) = (armature.rest().clone(), Cursor::new());
    for (time, x) in [
        (-1.0, 0.0),
        (0.5, 0.5),
        (3.0, 1.0),
        (5.5, 0.0),
        (6.25, 0.25),
    ] {
        clip.sample(time, Playback::Loop, &mut cursor, &mut pose)
            .unwrap();
        assert_eq!(pose.translations()[0], Vec3A::X * x, "{time} s");
    }
}

/// Keys at 1 s and 2 s of the file: samples, events and span count from the file's zero.
#[test]
fn sample_counts_seconds_of_the_file() {
    let armature = armature(1, &mut Random::new(71));
    let bone = armature.bone_at(0).unwrap();
    let curve = KeyedCurve::linear(vec![1.0, 2.0], vec![Vec3A::ZERO, Vec3A::X]).unwrap();
    let mut builder = Clip::builder("late", &armature);
    builder.channel(bone, Channel::Translation(curve)).unwrap();
    let clip = builder.build();
    assert_eq!(clip.span(), [1.0, 2.0]);
    let (mut pose, mut cursor) = (armature.rest().clone(), Cursor::new());
    for (time, playback, x) in [
        (0.0, Playback::Hold, 0.0),
        (1.5, Playback::Hold, 0.5),
        (1.5, Playback::Loop, 0.5),
        (2.25, Playback::Loop, 0.25),
        (2.25, Playback::PingPong, 0.75),
        (9.0, Playback::Hold, 1.0),
    ] {
        clip.sample(time, playback, &mut cursor, &mut pose).unwrap();
        assert_eq!(
            pose.translations()[0],
            Vec3A::X * x,
            "{time} s {playback:?}"
        );
    }
}

#[test]
fn stepped_playback_equals_a_search_exactly() {
    let mut random = Random::new(65);
    for bones in [1, 4, 23] {
        let armature = armature(bones, &mut random);
        let clips = [
            captured_clip(&armature, &mut random),
            random_clip(&armature, &mut random).0,
        ];
        for (clip, step) in clips
            .iter()
            .flat_map(|c| [0.017, -0.023, 0.4, -1.1].map(|step| (c, step)))
        {
            let (mut cursor, mut pose) = (Cursor::new(), armature.rest().clone());
            let mut fresh = pose.clone();
            for frame in 0..400 {
                // Back and forth across the seam of a clip as well.
                let elapsed = step * f64::from(if frame < 300 { frame } else { 600 - frame });
                for playback in [Playback::Loop, Playback::PingPong] {
                    clip.sample(elapsed, playback, &mut cursor, &mut pose)
                        .unwrap();
                    clip.sample(elapsed, playback, &mut Cursor::new(), &mut fresh)
                        .unwrap();
                    assert_eq!(pose, fresh, "{elapsed} {playback:?}");
                }
            }
        }
    }
}

#[test]
fn cursor_of_another_clip_is_harmless() {
    let mut random = Random::new(63);
    let armature = armature(9, &mut random);
    let clips: Vec<Clip> = (0..6)
        .map(|_| random_clip(&armature, &mut random).0)
        .collect();
    let (mut shared, mut pose) = (Cursor::new(), armature.rest().clone());
    for _ in 0..200 {
        let clip = &clips[random.below(6)];
        let elapsed = random.within(-1.0, 4.0);
        clip.sample(elapsed, Playback::Loop, &mut shared, &mut pose)
            .unwrap();
        let mut fresh = armature.rest().clone();
        clip.sample(elapsed, Playback::Loop, &mut Cursor::new(), &mut fresh)
            .unwrap();
        assert_eq!(pose, fresh);
    }
}

#[test]
fn rig_keyframes_match_its_angles() {
    let mut random = Random::new(64);
    let skeleton = RandomRig::new(64).skeleton;
    let armature = Armature::of_skeleton(&skeleton);
    let tracks = skeleton
        .bone_ids()
        .filter(|bone| bone.index() % 3 != 1)
        .map(|bone| {
            let keys = [0.0, 0.5, 0.75, 2.0].map(|time| EulerKey {
                time,
                angles: [(); 3].map(|()| random.within(-2.0, 2.0)),
            });
            EulerTrack {
                bone,
                keys: keys.to_vec(),
            }
        });
    let tracks: Vec<EulerTrack> = tracks.collect();
    let controls = TensionContinuityBias {
        tension: 0.3,
        continuity: -0.4,
        bias: 0.6,
    };
    for interpolation in [
        EulerInterpolation::Linear,
        EulerInterpolation::CatmullRom,
        EulerInterpolation::kochanek_bartels(&tracks[0], controls),
    ] {
        let euler = EulerClip::new(tracks.clone()).unwrap();
        let euler = euler.interpolated(|_| interpolation.clone()).unwrap();
        let mut builder = Clip::builder("angles", &armature);
        builder.euler_clip(&euler).unwrap();
        let clip = builder.build();
        let (mut pose, mut cursor) = (armature.rest().clone(), Cursor::new());
        let mut model = vec![glam::Affine3A::IDENTITY; skeleton.bones().len()];
        let mut q = vec![0.0; skeleton.angles()];
        for step in 0..=40 {
            let time = f64::from(step) * 0.05;
            clip.sample(time, Playback::Hold, &mut cursor, &mut pose)
                .unwrap();
            armature.local_to_model(&pose, &mut model).unwrap();
            euler.sample(time, Playback::Hold, &mut q).unwrap();
            let posed = skeleton.pose(&q).unwrap();
            for (bone, model) in skeleton.bone_ids().zip(&model) {
                let tip = posed
                    .tip(&skeleton, bone)
                    .unwrap()
                    .to_array()
                    .map(|x| x as f32);
                let along = Vec3A::X * skeleton.bones()[bone.index()].length as f32;
                let deviation = (model.transform_point3a(along) - Vec3A::from(tip)).length();
                assert!(deviation < 1e-4, "{deviation}");
            }
        }
    }
}

#[test]
fn morph_weights_are_sampled_with_bones() {
    let mut random = Random::new(65);
    let armature = armature(3, &mut random);
    let mut builder = Clip::builder("smile", &armature);
    builder
        .morph_weights(&[0.0, 1.0, 3.0], &[0.0, 1.0, 0.8, 0.0, 0.4, 0.5])
        .unwrap();
    let clip = builder.build();
    let (mut pose, mut cursor) = (armature.rest().clone(), Cursor::new());
    for (time, smile, frown) in [
        (0.5, 0.4, 0.5),
        (1.0, 0.8, 0.0),
        (2.0, 0.6, 0.25),
        (9.0, 0.4, 0.5),
    ] {
        clip.sample(time, Playback::Hold, &mut cursor, &mut pose)
            .unwrap();
        for (actual, expected) in pose.morph_weights().iter().zip([smile, frown]) {
            assert!((actual - expected).abs() < 1e-6);
        }
    }
}

#[test]
fn bad_channels_are_named_errors() {
    let mut random = Random::new(66);
    let armature = armature(2, &mut random);
    let [bone, other] = [0, 1].map(|index| armature.bone_at(index).unwrap());
    let still = || Channel::Rotation(RotationCurve::step(vec![0.0], vec![Quat::IDENTITY]).unwrap());
    let mut builder = Clip::builder("bad", &armature);
    builder.channel(bone, still()).unwrap();
    builder.channel(bone, still()).says("`bone 0` | rotation");
    let euler = |before| {
        Channel::Euler(EulerCurve {
            order: EulerOrder::Xyz,
            before,
            angles: KeyedCurve::step(vec![0.0], vec![Vec3A::ZERO]).unwrap(),
        })
    };
    let also = builder.channel(bone, euler(Quat::IDENTITY)).unwrap_err();
    assert!(matches!(also, ClipError::DuplicateChannel { .. }), "{also}");
    let zero = builder
        .channel(other, euler(Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)))
        .unwrap_err();
    assert_eq!(
        zero,
        ClipError::BadRotation {
            bone: "bone 1".into()
        }
    );
    let big = support::armatures::armature(5, &mut random);
    let stranger = builder
        .channel(big.bone_at(4).unwrap(), still())
        .unwrap_err();
    assert_eq!(stranger, ClipError::UnknownBone { bone: 4, bones: 2 });

    let weight = || KeyedCurve::step(vec![0.0], vec![1.0]).unwrap();
    builder.morph_weight(1, weight()).unwrap();
    builder.morph_weight(1, weight()).says("`frown`");
    assert!(builder.morph_weight(2, weight()).is_err());
    let count = builder.morph_weights(&[0.0], &[1.0]).unwrap_err();
    assert_eq!(
        count,
        ClipError::WeightCount {
            given: 1,
            keys: 1,
            targets: 2
        }
    );
    // Errors of keys that the builder makes curves of name the moved channel.
    let mut keyed = Clip::builder("keyed", &armature);
    let nan = keyed.morph_weights(&[0.0, 1.0], &[0.0, 0.0, 0.5, f32::NAN]);
    nan.says("`frown` | key 1");
    // Two times that are equal in single precision.
    let key = |time| EulerKey {
        time,
        angles: [0.0; 3],
    };
    let track = EulerTrack {
        bone: other,
        keys: vec![key(1.0), key(1.0 + 1e-12)],
    };
    let clip = EulerClip::new(vec![track]).unwrap();
    keyed.euler_clip(&clip).says("`bone 1` | key 1");
    builder.event(f32::NAN, "step").says("`step`");
    assert!(builder.span(2.0, 1.0).is_err() && builder.span(0.0, f32::INFINITY).is_err());

    let rotation = |q| RotationCurve::slerp(vec![0.0, 1.0], vec![Quat::IDENTITY, q]);
    rotation(Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)).says("key 1 | zero");
    assert!(rotation(Quat::from_xyzw(0.0, f32::NAN, 0.0, 1.0)).is_err());
    // Quaternions of any other length are normalised.
    for scale in [1e-30, 2.0, 1e30] {
        let curve = rotation(Quat::from_rotation_x(0.4) * scale).unwrap();
        assert!(apart(curve.at(1.0), Quat::from_rotation_x(0.4)) < 1e-6);
    }
    // Without channels it is the rest pose.
    let empty = Clip::builder("empty", &armature).build();
    let mut pose = support::armatures::pose(&armature, &mut random);
    empty
        .sample(3.0, Playback::Loop, &mut Cursor::new(), &mut pose)
        .unwrap();
    assert_eq!(&pose, armature.rest());
    let mut wrong = big.rest().clone();
    assert!(
        empty
            .sample(0.0, Playback::Hold, &mut Cursor::new(), &mut wrong)
            .is_err()
    );
}

/// Computed by hand, for a span from 2 s to 5 s.
#[test]
fn times_outside_an_offset_span_are_wrapped() {
    let span = [2.0, 5.0];
    for (time, hold, looped, there_and_back) in [
        (1.0, 2.0, 4.0, 3.0),
        (0.0, 2.0, 3.0, 4.0),
        (-2.5, 2.0, 3.5, 3.5),
        (-3.0, 2.0, 3.0, 3.0),
        (6.0, 5.0, 3.0, 4.0),
        (9.5, 5.0, 3.5, 3.5),
        (3.25, 3.25, 3.25, 3.25),
    ] {
        assert_eq!(Playback::Hold.within(time, span), hold, "{time}");
        assert_eq!(Playback::Loop.within(time, span), looped, "{time}");
        assert_eq!(
            Playback::PingPong.within(time, span),
            there_and_back,
            "{time}"
        );
    }
}

/// Channels are sorted by bone, moving or constant, in any order of addition.
#[test]
fn channels_are_sorted_by_bone() {
    for seed in 0..40 {
        let mut random = Random::new(seed);
        let armature = armature(6, &mut random);
        let mut builder = Clip::builder("mixed", &armature);
        let mut bones: Vec<_> = armature.bone_ids().collect();
        for k in (1..bones.len()).rev() {
            bones.swap(k, random.below(k + 1));
        }
        let mut added = 0;
        for bone in bones {
            let count = random.below(3);
            let times: Vec<f32> = (0..count).map(|k| k as f32).collect();
            if count > 0 {
                let turns = rotations(&mut random, &times);
                builder.channel(bone, Channel::Rotation(turns)).unwrap();
                let ways = vectors(&mut random, &times, Vec3A::ONE);
                builder.channel(bone, Channel::Translation(ways)).unwrap();
                added += 2;
            }
        }
        let channels = builder.build().channels(&armature).unwrap();
        assert_eq!(channels.len(), added);
        let order: Vec<_> = channels
            .iter()
            .map(|(bone, channel)| (*bone, matches!(channel, Channel::Rotation(_))))
            .collect();
        assert!(order.is_sorted(), "{order:?}");
    }
}
