//! Promise: so it is for clips of angles, for the events that clips pass and their names, and for what clips refuse.
#![allow(clippy::unwrap_used)]

use glam::{Quat, Vec3A};
use kinopt::animation::curve::{KeyedCurve, TensionContinuityBias};
use kinopt::animation::rotation::{EulerOrder, RotationCurve};
use kinopt::animation::{
    Channel, Clip, EulerClip, EulerCurve, EulerInterpolation, EulerKey, EulerTrack, Playback,
    Playhead,
};
use support::random::Random;

use crate::animated::{armature, check_single};
use crate::digest::{Digest, Value};

fn angles() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(104));
    let body = armature(4, &mut random);
    let bone = |index| body.bone_at(index).unwrap();
    let mut track = |index: usize, times: &[f64]| EulerTrack {
        bone: bone(index),
        keys: times
            .iter()
            .map(|&time| EulerKey {
                time,
                angles: [(); 3].map(|()| random.within(-3.0, 3.0)),
            })
            .collect(),
    };
    let tracks = vec![
        track(3, &[0.5, 1.0, 2.5]),
        track(1, &[]),
        track(0, &[-1.0, 0.0, 0.25, 3.0]),
        track(2, &[0.75]),
    ];
    let clip = EulerClip::new(tracks.clone()).unwrap();
    let odd = TensionContinuityBias {
        tension: 0.3,
        continuity: -0.4,
        bias: 0.5,
    };
    let mixed = clip.clone().interpolated(|track| match track.keys.len() {
        1 => EulerInterpolation::CatmullRom,
        3 => EulerInterpolation::Linear,
        _ => EulerInterpolation::kochanek_bartels(track, odd),
    });
    let empty = EulerClip::new(vec![track(1, &[])]).unwrap();
    for clip in [clip.clone(), mixed.unwrap(), empty] {
        digest.json(&clip);
        let text = serde_json::to_string(&clip).unwrap();
        let clip: EulerClip = serde_json::from_str(&text).unwrap();
        digest.debug((
            clip.tracks(),
            clip.keyless(),
            clip.is_empty(),
            clip.time_span(),
        ));
        for bone in body.bone_ids() {
            digest.debug((clip.keys(bone), clip.interpolation(bone).name()));
        }
        let mut q = [9.0; 12];
        for playback in [Playback::Hold, Playback::Loop, Playback::PingPong] {
            for time in [-2.0, -1.0, 0.3, 0.75, 2.5, 4.5, 8.0] {
                clip.sample(time, playback, &mut q).unwrap();
                digest.doubles(q);
            }
        }
        digest.refused(clip.sample(f64::NAN, Playback::Hold, &mut q));
        let mut builder = Clip::builder("angles", &body);
        builder.euler_clip(&clip).unwrap();
        digest.clip(&body, &builder.build());
    }
    digest.refused(clip.sample(0.0, Playback::Hold, &mut [0.0; 11]));
    let key = |time, angle| EulerKey {
        time,
        angles: [0.0, angle, 0.0],
    };
    let with = |keys: Vec<EulerKey>| {
        let bone = bone(1);
        EulerClip::new(vec![tracks[0].clone(), EulerTrack { bone, keys }])
    };
    digest.refused(EulerClip::new(vec![tracks[0].clone(), tracks[0].clone()]));
    digest.refused(with(vec![key(0.0, 0.0), key(f64::NAN, 0.0)]));
    digest.refused(with(vec![key(0.0, f64::INFINITY)]));
    digest.refused(with(vec![key(0.5, 0.0), key(0.5, 1.0)]));
    digest.refused(with(vec![key(0.0, 0.0), key(1e-300, 1e300)]));
    let nothing = TensionContinuityBias {
        bias: f32::NAN,
        ..odd
    };
    for controls in [vec![odd; 2], vec![odd, nothing, odd]] {
        let one = EulerClip::new(vec![tracks[0].clone()]).unwrap();
        digest.refused(one.interpolated(|_| EulerInterpolation::KochanekBartels(controls.clone())));
    }
    // Times that single precision cannot tell apart, and a bone that is not there.
    let close = with(vec![key(1.0, 0.0), key(1.0 + 1e-12, 1.0)]).unwrap();
    digest.refused(Clip::builder("close", &body).euler_clip(&close));
    let far = armature(2, &mut Random::new(1));
    digest.refused(Clip::builder("far", &far).euler_clip(&clip));
    digest.refused(Clip::builder("far", &armature(1, &mut Random::new(1))).euler_clip(&close));
    digest.value()
}

fn refused() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(105));
    let body = armature(3, &mut random);
    let far = armature(9, &mut random).bone_at(7).unwrap();
    let (first, one) = (body.bone_at(0).unwrap(), Quat::IDENTITY);
    let mut builder = Clip::builder("wrong", &body);
    let angles = |before| EulerCurve {
        order: EulerOrder::Xyz,
        before,
        angles: KeyedCurve::step(vec![0.0], vec![Vec3A::ZERO]).unwrap(),
    };
    let turns = || Channel::Rotation(RotationCurve::step(vec![0.0], vec![one]).unwrap());
    let place = || KeyedCurve::step(vec![0.0], vec![Vec3A::ZERO]).unwrap();
    digest.refused(builder.channel(far, turns()));
    digest.refused(builder.channel(first, Channel::Euler(angles(one * 1.5))));
    digest.refused(builder.channel(first, Channel::Euler(angles(one * f32::NAN))));
    builder.channel(first, turns()).unwrap();
    digest.refused(builder.channel(first, Channel::Euler(angles(one))));
    for channel in [Channel::Translation, Channel::Scale] {
        builder.channel(first, channel(place())).unwrap();
        digest.refused(builder.channel(first, channel(place())));
    }
    let weights = || KeyedCurve::step(vec![0.0], vec![1.0]).unwrap();
    digest.refused(builder.morph_weight(2, weights()));
    digest.refused(builder.morph_weights(&[0.0, 1.0], &[0.0; 3]));
    digest.refused(builder.morph_weights(&[1.0, 1.0], &[0.0; 4]));
    builder.morph_weight(1, weights()).unwrap();
    digest.refused(builder.morph_weight(1, weights()));
    digest.refused(builder.event(f32::NAN, "step"));
    for [start, end] in [[1.0, 0.5], [f32::NAN, 1.0], [0.0, f32::INFINITY]] {
        digest.refused(builder.span(start, end));
    }
    let named = |name: &str| Clip::builder(name, &body).build();
    let names = [
        "Armature|Walk",
        "Walk.001",
        "SlowWalk",
        "x Run",
        "y Run",
        "x Run",
        "Run2",
    ];
    let clips = names.map(named);
    for name in ["Walk", "Walk.001", "001", "x Run", "Run2", "Armature|Walk"] {
        digest.text(Clip::named(&clips, name).unwrap().name());
    }
    for name in ["Run", "", "Wlak", "alk"] {
        digest.refused(Clip::named(&clips, name));
    }
    digest.value()
}

fn events() -> Value {
    let mut digest = Digest::new();
    let body = armature(1, &mut Random::new(106));
    let clip = |span: [f32; 2], times: &[f32]| {
        let mut builder = Clip::builder("steps", &body);
        builder.span(span[0], span[1]).unwrap();
        for (k, &time) in times.iter().enumerate() {
            builder.event(time, format!("{k}")).unwrap();
        }
        builder.build()
    };
    let clips = [
        clip([0.5, 2.5], &[0.5, 2.5, 1.0, 1.75, 1.75, 3.0, 0.0]),
        clip([0.0, 0.0], &[0.0, 1.0]),
        clip([-1.0, 0.0], &[]),
    ];
    for clip in &clips {
        for playback in [Playback::Hold, Playback::Loop, Playback::PingPong] {
            for (start, speed) in [
                (0.0, 1.0),
                (0.0, -1.0),
                (2.0, 1.5),
                (-3.5, 1.0),
                (4.0, -0.5),
            ] {
                let mut head = Playhead::starting_at(start);
                head.speed = speed;
                for step in [0.0, 0.5, 0.75, 0.75, 2.0, 5.5, f64::NAN, -1.0, 0.25, 0.0] {
                    let passage = head.advance(step);
                    digest.debug((passage, head.elapsed()));
                    for fired in clip.fired(playback, passage) {
                        digest.text(&fired.event.name);
                        digest.doubles([fired.elapsed, f64::from(fired.event.time)]);
                    }
                }
            }
        }
    }
    // Where cycles can no longer be told apart.
    let mut head = Playhead::starting_at(1e17);
    let passage = head.advance(64.0);
    digest.debug(clips[0].fired(Playback::Loop, passage).count());
    digest.debug(Playhead::default());
    for playback in [Playback::Hold, Playback::Loop, Playback::PingPong] {
        digest.json(&playback);
        for time in [
            -7.25,
            -0.5,
            1.0,
            3.0,
            3.5,
            6.0,
            1e6,
            f64::NAN,
            f64::INFINITY,
        ] {
            let spans = [[1.0, 3.0], [2.0, 2.0], [-0.5, 0.0]];
            digest.doubles(spans.map(|span| playback.within(time, span)));
        }
    }
    digest.value()
}

#[test]
fn of_events() {
    check_single(&[
        ("clips of angles", angles()),
        ("clips: what is refused", refused()),
        ("clips, what they pass", events()),
    ]);
}
