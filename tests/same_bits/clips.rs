//! Promise: so it is for clips: every kind of channel on bones in and out of order, sampled on, back and in leaps, their
//! events and names, and what is refused.
#![allow(clippy::unwrap_used)]

use std::sync::OnceLock;

use glam::{Quat, Vec3A, Vec4};
use kinopt::animation::curve::KeyedCurve;
use kinopt::animation::rotation::{EulerOrder, RotationCurve};
use kinopt::animation::{
    Armature, Channel, Clip, ClipBuilder, Cursor, Easing, EulerCurve, Playback,
};
use support::random::Random;

use crate::animated::{armature, check_single, rotation, turn, vector};
use crate::digest::{Digest, Value};

/// Times of tracks: most share the first ones.
const LINES: [&[f32]; 4] = [
    &[-0.5, 0.0, 0.25, 1.0, 1.5],
    &[0.0, 0.5, 1.25],
    &[-0.25, 1.75],
    &[0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0],
];

fn times(line: usize) -> Vec<f32> {
    LINES[line].to_vec()
}

fn vectors(random: &mut Random, line: usize) -> Vec<Vec3A> {
    LINES[line].iter().map(|_| vector(random, 1.0)).collect()
}

fn straight(random: &mut Random, line: usize) -> KeyedCurve<Vec3A> {
    KeyedCurve::linear(times(line), vectors(random, line)).unwrap()
}

fn slerp(random: &mut Random, line: usize) -> RotationCurve {
    let keys = LINES[line].iter().map(|_| rotation(random)).collect();
    RotationCurve::slerp(times(line), keys).unwrap()
}

fn add(builder: &mut ClipBuilder<'_>, armature: &Armature, bone: usize, channel: Channel) {
    builder
        .channel(armature.bone_at(bone).unwrap(), channel)
        .unwrap();
}

/// Every kind of channel, on bones here and there.
pub(crate) fn varied(armature: &Armature, random: &mut Random) -> Clip {
    let mut builder = Clip::builder("varied", armature);
    let mut put = |bone, channel| add(&mut builder, armature, bone, channel);
    let still = |value| KeyedCurve::step(vec![0.75], vec![value]).unwrap();
    for (bone, line) in [(9, 0), (0, 0), (3, 1), (5, 0), (4, 2)] {
        put(bone, Channel::Translation(straight(random, line)));
        put(bone, Channel::Scale(straight(random, 2 - line)));
    }
    for (bone, line) in [(8, 0), (1, 0), (2, 1), (7, 0), (0, 3), (5, 0), (6, 2)] {
        put(bone, Channel::Rotation(slerp(random, line)));
    }
    let keys = || [rotation, rotation, rotation, rotation, rotation];
    let mut turns = || keys().map(|draw| draw(random)).to_vec();
    let curves = [
        RotationCurve::step(times(0), turns()),
        RotationCurve::squad(times(0), turns()),
        RotationCurve::smooth(times(0), turns()),
        RotationCurve::eased(times(0), turns(), vec![Easing::CubicInOut; 5]),
        RotationCurve::cubic(times(0), turns(), vec![[Vec4::splat(0.5), Vec4::X]; 5]),
        RotationCurve::slerp(vec![0.5], vec![turns()[2]]),
    ];
    for (bone, curve) in (9..).zip(curves) {
        put(bone, Channel::Rotation(curve.unwrap()));
    }
    let spare = vectors(random, 1);
    put(1, Channel::Translation(still(spare[0])));
    put(2, Channel::Scale(still(spare[1])));
    let curved = [
        KeyedCurve::step(times(1), vectors(random, 1)),
        KeyedCurve::catmull_rom(times(1), vectors(random, 1)),
        KeyedCurve::eased(times(0), vectors(random, 0), Easing::ALL[1..6].to_vec()),
    ];
    for (bone, curve) in (6..).zip(curved) {
        let curve = curve.unwrap();
        put(bone, Channel::Scale(curve.clone()));
        put(bone, Channel::Translation(curve));
    }
    for (bone, order) in [(3, EulerOrder::Zxy), (4, EulerOrder::Xzx)] {
        let (before, angles) = (rotation(random), straight(random, bone - 3));
        put(
            bone,
            Channel::Euler(EulerCurve {
                order,
                before,
                angles,
            }),
        );
    }
    let (order, before, angles) = (EulerOrder::Yzy, rotation(random), still(spare[2]));
    put(
        15,
        Channel::Euler(EulerCurve {
            order,
            before,
            angles,
        }),
    );
    let weights = KeyedCurve::linear(vec![0.0, 0.5, 3.0], vec![0.1, 0.9, 0.4]);
    builder.morph_weight(1, weights.unwrap()).unwrap();
    let held = KeyedCurve::step(vec![0.25], vec![0.75]);
    builder.morph_weight(0, held.unwrap()).unwrap();
    for (time, name) in [
        (1.5, "end"),
        (-0.5, "start"),
        (0.5, "b"),
        (0.5, "a"),
        (9.0, "never"),
    ] {
        builder.event(time, name).unwrap();
    }
    builder.build()
}

/// Straight channels of all bones, or of the first ones, together or not.
fn in_order(armature: &Armature, random: &mut Random, bones: usize, lines: usize) -> Clip {
    let mut builder = Clip::builder(format!("first {bones}"), armature);
    for bone in 0..bones {
        let line = bone % lines;
        add(
            &mut builder,
            armature,
            bone,
            Channel::Translation(straight(random, line)),
        );
        add(
            &mut builder,
            armature,
            bone,
            Channel::Rotation(slerp(random, line)),
        );
        add(
            &mut builder,
            armature,
            bone,
            Channel::Scale(straight(random, line)),
        );
    }
    let weights: Vec<f32> = (0..10).map(|_| random.unit() as f32).collect();
    builder.morph_weights(&times(0), &weights).unwrap();
    builder.span(-0.25, 1.25).unwrap();
    builder.build()
}

fn body() -> &'static Armature {
    static BODY: OnceLock<Armature> = OnceLock::new();
    BODY.get_or_init(|| armature(17, &mut Random::new(101)))
}

/// Elapsed seconds: on in small steps, back, in leaps, and what is no time.
const WAY: [f64; 24] = [
    0.0,
    0.1,
    0.2,
    0.55,
    0.6,
    1.3,
    1.35,
    1.1,
    0.9,
    0.4,
    0.45,
    5.0,
    0.3,
    -0.7,
    2.0,
    1.9,
    1e9,
    0.75,
    0.5,
    3.5,
    3.6,
    0.05,
    f64::NAN,
    f64::NEG_INFINITY,
];

fn sampled() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(102));
    let (body, mut cursor) = (body(), Cursor::new());
    let clips = [
        varied(body, &mut random),
        in_order(body, &mut random, 17, 1),
        in_order(body, &mut random, 9, 2),
        in_order(body, &mut random, 16, 4),
    ];
    for clip in &clips {
        for playback in [Playback::Hold, Playback::Loop, Playback::PingPong] {
            // A pose with other things in it, and a cursor that was on the clip before.
            let mut pose = body.rest().clone();
            for bone in body.bone_ids() {
                pose.set_scale(bone, Vec3A::splat(7.0)).unwrap();
            }
            let mut own = Cursor::new();
            for time in WAY {
                clip.sample(time, playback, &mut cursor, &mut pose).unwrap();
                digest.pose(&pose);
                clip.sample(time, playback, &mut own, &mut pose).unwrap();
                let mut anew = pose.clone();
                clip.sample(time, playback, &mut Cursor::new(), &mut anew)
                    .unwrap();
                assert_eq!(anew, pose, "wherever the cursor was");
            }
        }
    }
    for time in WAY {
        for clip in &clips {
            let mut pose = body.rest().clone();
            clip.sample(time, Playback::Loop, &mut cursor, &mut pose)
                .unwrap();
            digest.pose(&pose);
        }
    }
    let mut other = armature(3, &mut random).rest().clone();
    digest.refused(clips[0].sample(0.0, Playback::Loop, &mut cursor, &mut other));
    digest.value()
}

fn told() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(103));
    let body = body();
    let elsewhere = armature(17, &mut random);
    let moved = body.clone().at_rest_in(elsewhere.rest()).unwrap();
    for clip in [
        varied(body, &mut random),
        in_order(body, &mut random, 9, 3),
        Clip::builder("nothing", body).build(),
    ] {
        digest.clip(body, &clip);
        digest.clip(&moved, &clip.at_rest_in(body, &moved).unwrap());
        let text = serde_json::to_string(&clip).unwrap();
        digest.bytes(&text);
        let again: Clip = serde_json::from_str(&text).unwrap();
        digest.clip(body, &again.renamed("again"));
        let [start, end] = clip.span();
        let none = text.replacen(&serde_json::to_string(&[start, end]).unwrap(), "null", 1);
        let none: Clip = serde_json::from_str(&none).unwrap();
        digest.clip(body, &none);
        digest.clip(&moved, &none.at_rest_in(body, &moved).unwrap());
        digest.refused(clip.channels(&armature(2, &mut random)));
        digest.refused(clip.morph_channels(&armature(2, &mut random)));
        digest.refused(clip.at_rest_in(body, &armature(2, &mut random)));
    }
    let text = r#"{"name":"odd","span":[1,0],"channels":[],"morphs":[],"events":[],"constant":
        {"translations":[],"rotations":[],"scales":[],"morph_weights":[]}}"#;
    digest.refused(serde_json::from_str::<Clip>(text));
    digest.value()
}

#[test]
fn of_clips() {
    // Turns that are small as well.
    let mut small = Digest::new();
    let mut random = Random::new(107);
    let keys: Vec<Quat> = [0.001, 0.1, 1.0]
        .map(|size| turn(&mut random, size))
        .to_vec();
    let body = armature(1, &mut random);
    let mut builder = Clip::builder("small", &body);
    let curve = RotationCurve::slerp(vec![0.0, 1.0, 2.0], keys).unwrap();
    add(&mut builder, &body, 0, Channel::Rotation(curve));
    small.clip(&body, &builder.build());
    check_single(&[
        ("clips, sampled", sampled()),
        ("clips of small turns", small.value()),
        ("clips, what they hold", told()),
    ]);
}
