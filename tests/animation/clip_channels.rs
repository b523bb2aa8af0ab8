//! Promise: a clip lists its channels relative to the rest pose of any armature of its size. Moving channels keep their
//! motion, constant ones that differ from the rest pose get one key, and none is listed twice. On that armature the
//! channels give the same clip.

use glam::{Quat, Vec3A};
use kinopt::animation::curve::KeyedCurve;
use kinopt::animation::rotation::RotationCurve;
use kinopt::animation::{Channel, Clip};
use support::armatures::{armature, difference, pose};
use support::random::Random;

use super::baked_clips::at;

#[test]
fn channels_round_trip_for_any_rest() {
    let random = &mut Random::new(61);
    let source = armature(5, random);
    let rest = pose(&source, random);
    let other = source.clone().at_rest_in(&rest).unwrap();
    let times = vec![0.5, 1.0, 2.0];
    let smile = KeyedCurve::linear(times.clone(), vec![0.1, 0.9, 0.4]).unwrap();
    let turns = vec![
        Quat::IDENTITY,
        Quat::from_rotation_x(1.0),
        Quat::from_rotation_z(1.0),
    ];
    let ways = vec![Vec3A::X, Vec3A::Y, Vec3A::Z];
    let bone = source.bone("bone 2").unwrap();
    let moving = [
        Channel::Rotation(RotationCurve::slerp(times.clone(), turns).unwrap()),
        Channel::Translation(KeyedCurve::linear(times, ways).unwrap()),
    ];
    let mut builder = Clip::builder("nod", &source);
    for channel in moving.clone() {
        builder.channel(bone, channel).unwrap();
    }
    builder.morph_weight(0, smile.clone()).unwrap();
    let clip = builder.build();

    let channels = clip.channels(&other).unwrap();
    // Each of five bones has three properties, all of which differ from the other armature's rest pose.
    assert_eq!(channels.len(), 15);
    for channel in moving {
        assert!(channels.contains(&(bone, channel)));
    }
    let weights = clip.morph_channels(&other).unwrap();
    let still = KeyedCurve::step(vec![0.5], vec![0.0]).unwrap();
    assert_eq!(weights, [(0, smile), (1, still)]);

    let mut builder = Clip::builder("nod", &other);
    for (bone, channel) in channels {
        builder.channel(bone, channel).unwrap();
    }
    for (target, curve) in weights {
        builder.morph_weight(target, curve).unwrap();
    }
    let again = builder.build();
    assert_eq!(again.span(), clip.span());
    for step in 0..=12 {
        let time = step as f32 / 8.0;
        let apart = difference(&at(&again, &other, time), &at(&clip, &source, time));
        assert!(apart < 1e-6, "{apart} at {time}");
    }
}
