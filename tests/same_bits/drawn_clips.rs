//! Promise: so it is for clips whose channels are drawn at random: of any kind, on no bone, some or all of them, and what is made of them.
#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use glam::{Quat, Vec3, Vec3A, Vec4};
use kinopt::animation::curve::{BezierHandle, CurveValue, KeyedCurve, TensionContinuityBias};
use kinopt::animation::rotation::{EulerOrder, RotationCurve};
use kinopt::animation::{
    Armature, ArmatureBone, Channel, Clip, Cursor, Easing, EulerCurve, KeyTolerance, Playback,
    Playhead, Pose,
};
use support::random::Random;

use crate::animated::{check_single, local, number, rotation, vector};
use crate::digest::{Digest, Value};
use crate::drawn::{at_times, one_of};

pub(crate) const PLAYBACKS: [Playback; 3] = [Playback::Hold, Playback::Loop, Playback::PingPong];

/// A tree of few or many bones, with morph targets or not, which may be at rest elsewhere than at nothing.
pub(crate) fn body(random: &mut Random, bones: usize) -> Armature {
    let list = (0..bones).map(|k| ArmatureBone {
        name: format!("bone {k}"),
        parent: (k > 0 && at_times(random, 0.9)).then(|| random.below(k.max(1))),
        rest: local(random),
    });
    let list = list.collect();
    let targets = random.below(4);
    let names = (0..targets).map(|k| format!("target {k}")).collect();
    let own = Armature::new(list, names).unwrap();
    let weights: Vec<f32> = (0..targets).map(|_| number(random, 1.0)).collect();
    own.with_rest_morph_weights(&weights).unwrap()
}

/// Times of keys: of most tracks the same.
fn times(random: &mut Random, shared: &[f32]) -> Vec<f32> {
    match random.below(5) {
        0 => vec![number(random, 1.0)],
        1 => {
            let mut time = number(random, 1.0);
            let mut next = || {
                time += random.within(0.05, 0.7) as f32;
                time
            };
            [(); 3].map(|()| next()).to_vec()
        }
        _ => shared.to_vec(),
    }
}

fn controls(random: &mut Random) -> TensionContinuityBias {
    TensionContinuityBias {
        tension: number(random, 1.0),
        continuity: number(random, 1.0),
        bias: number(random, 1.0),
    }
}

/// Whether no two keys are so near that the time between them has no inverse; the slopes of some curves would not be finite.
fn are_apart(times: &[f32]) -> bool {
    times.windows(2).all(|pair| pair[1] - pair[0] > 1e-30)
}

/// Which kind of curve; one of those without slopes where keys are too near for others.
fn kind(random: &mut Random, times: &[f32]) -> usize {
    random.below(if are_apart(times) { 9 } else { 2 })
}

/// A curve of any kind.
fn curve<V: CurveValue<Real = f32>>(
    random: &mut Random,
    times: Vec<f32>,
    mut value: impl FnMut(&mut Random) -> V,
) -> KeyedCurve<V> {
    let mut values: Vec<V> = times.iter().map(|_| value(random)).collect();
    if at_times(random, 0.15) {
        let first = values[0];
        values.fill(first);
    }
    let count = times.len();
    let kind = kind(random, &times);
    let made = match kind {
        0 => KeyedCurve::step(times, values),
        1 => {
            let easings = (0..count).map(|_| one_of(random, &Easing::ALL));
            let easings = easings.collect();
            KeyedCurve::eased(times, values, easings)
        }
        2 => {
            let tangents = (0..count).map(|_| [value(random), value(random)]);
            let tangents = tangents.collect();
            KeyedCurve::cubic(times, values, tangents)
        }
        3 => KeyedCurve::catmull_rom(times, values),
        4 => {
            let controls: Vec<_> = (0..count).map(|_| controls(random)).collect();
            KeyedCurve::kochanek_bartels(times, values, &controls)
        }
        5 => {
            let gap = |key: usize| match times.get(key..key + 2) {
                Some(pair) => pair[1] - pair[0],
                None => 0.0,
            };
            let handles = (0..count).map(|key| {
                let before = key.checked_sub(1).map_or(0.0, gap);
                [-before, gap(key)].map(|time| BezierHandle {
                    time: time * random.unit() as f32,
                    value: value(random),
                })
            });
            let handles = handles.collect();
            KeyedCurve::bezier(times, values, handles)
        }
        _ => KeyedCurve::linear(times, values),
    };
    made.unwrap()
}

fn turns(random: &mut Random, times: Vec<f32>) -> RotationCurve {
    let mut keys: Vec<Quat> = times.iter().map(|_| rotation(random) * 1.5).collect();
    if at_times(random, 0.15) {
        let first = keys[0];
        keys.fill(first);
    }
    let count = times.len();
    let kind = kind(random, &times);
    let made = match kind {
        0 => RotationCurve::step(times, keys),
        1 => {
            let easings = (0..count).map(|_| one_of(random, &Easing::ALL)).collect();
            RotationCurve::eased(times, keys, easings)
        }
        2 => RotationCurve::squad(times, keys),
        3 => RotationCurve::smooth(times, keys),
        4 => {
            let rate = |random: &mut Random| Vec4::from(rotation(random));
            let rates = (0..count).map(|_| [rate(random), rate(random)]).collect();
            RotationCurve::cubic(times, keys, rates)
        }
        _ => RotationCurve::slerp(times, keys),
    };
    made.unwrap()
}

fn angles(random: &mut Random, times: Vec<f32>) -> EulerCurve {
    let orders = [
        EulerOrder::Xyz,
        EulerOrder::Zyx,
        EulerOrder::Xzx,
        EulerOrder::Yxz,
    ];
    EulerCurve {
        order: one_of(random, &orders),
        before: rotation(random),
        angles: curve(random, times, |random| vector(random, 2.0)),
    }
}

/// A clip of an armature: of each property no bone, some bones or all have a channel.
pub(crate) fn clip(name: &str, body: &Armature, random: &mut Random) -> Clip {
    let mut builder = Clip::builder(name, body);
    let mut shared = vec![number(random, 0.5)];
    for _ in 0..1 + random.below(4) {
        shared.push(shared[shared.len() - 1] + random.within(0.1, 0.8) as f32);
    }
    if at_times(random, 0.1) {
        shared = vec![0.0, 1e-40, 0.7];
    }
    let shares = [0.0, 0.5, 1.0, 1.0];
    let share: [f64; 4] = [(); 4].map(|()| one_of(random, &shares));
    for bone in body.bone_ids() {
        if at_times(random, share[0]) {
            let times = times(random, &shared);
            let own = curve(random, times, |random| vector(random, 1.0));
            builder.channel(bone, Channel::Translation(own)).unwrap();
        }
        if at_times(random, share[1]) {
            let times = times(random, &shared);
            let own = match random.below(4) {
                0 => Channel::Euler(angles(random, times)),
                _ => Channel::Rotation(turns(random, times)),
            };
            builder.channel(bone, own).unwrap();
        }
        if at_times(random, share[2]) {
            let times = times(random, &shared);
            let own = curve(random, times, |random| Vec3A::ONE + vector(random, 0.5));
            builder.channel(bone, Channel::Scale(own)).unwrap();
        }
    }
    for target in 0..body.morph_targets().len() {
        if at_times(random, share[3]) {
            let times = times(random, &shared);
            let own = curve(random, times, |random| number(random, 1.0));
            builder.morph_weight(target, own).unwrap();
        }
    }
    for _ in 0..random.below(4) {
        let time = one_of(random, &[shared[0], shared[1], 0.5, -0.25, 7.0]);
        let name = one_of(random, &["step", "stop", "start"]);
        builder.event(time, name).unwrap();
    }
    if !are_apart(&shared) {
        builder.span(0.0, 0.7).unwrap();
    } else if at_times(random, 0.3) {
        let start = number(random, 0.5);
        let length = one_of(random, &[0.0, 0.6, 1.7]);
        builder.span(start, start + length).unwrap();
    }
    builder.build()
}

/// A pose as another clip may have left it.
fn used(body: &Armature) -> Pose {
    let mut pose = body.rest().clone();
    for bone in body.bone_ids() {
        pose.set_scale(bone, Vec3A::splat(7.0)).unwrap();
        pose.set_translation(bone, Vec3A::splat(3.0)).unwrap();
        pose.set_rotation(bone, Quat::from_xyzw(0.0, 1.0, 0.0, 0.0))
            .unwrap();
    }
    pose.morph_weights_mut().fill(5.0);
    pose
}

fn moment(random: &mut Random) -> f64 {
    one_of(
        random,
        &[
            0.0,
            0.1,
            0.35,
            0.7,
            1.2,
            2.5,
            -0.4,
            1e6,
            f64::INFINITY,
            f64::NAN,
        ],
    )
}

/// One pose and one cursor for several clips in turn.
fn sampled() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2001));
    for case in 0..60 {
        let body = body(&mut random, 1 + case % 10);
        let clips = ["a", "b", "c"].map(|name| clip(name, &body, &mut random));
        let (mut pose, mut cursor) = (used(&body), Cursor::new());
        for _ in 0..10 {
            let own = one_of(&mut random, &[0, 1, 2]);
            let (time, playback) = (moment(&mut random), one_of(&mut random, &PLAYBACKS));
            clips[own]
                .sample(time, playback, &mut cursor, &mut pose)
                .unwrap();
            digest.pose(&pose);
            let mut anew = used(&body);
            clips[own]
                .sample(time, playback, &mut Cursor::new(), &mut anew)
                .unwrap();
            assert_eq!(anew, pose, "whatever was in the pose and under the cursor");
        }
        for own in &clips {
            for playback in PLAYBACKS {
                let mut head = Playhead::starting_at(one_of(&mut random, &[0.0, -1.5, 0.7]));
                head.speed = one_of(&mut random, &[1.0, -1.0, 0.5, 3.0, 0.0]);
                for _ in 0..3 {
                    let seconds = one_of(&mut random, &[0.0, 0.3, 1.7, -0.2, f64::NAN]);
                    let passage = head.advance(seconds);
                    digest.debug((passage, own.fired(playback, passage).collect::<Vec<_>>()));
                }
            }
        }
    }
    digest.value()
}

/// What clips hold, as files too, and what is made of them.
fn made() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2002));
    for case in 0..40 {
        let body = body(&mut random, 1 + case % 5);
        let own = clip("own", &body, &mut random);
        digest.clip(&body, &own);
        let again: Clip = serde_json::from_str(&serde_json::to_string(&own).unwrap()).unwrap();
        assert_eq!(again, own, "as it was written");
        let rate = one_of(&mut random, &[3.0, 7.5, 0.5, 0.0, 1e9]);
        if let Some(baked) = digest.answer(own.baked(&body, rate)) {
            digest.clip(&body, &baked);
        }
        let tolerance = |random: &mut Random| one_of(random, &[0.0, 0.05, 0.4, 3.0, -1.0]);
        let tolerance = KeyTolerance::default()
            .with_translation(tolerance(&mut random))
            .with_rotation(tolerance(&mut random))
            .with_scale(tolerance(&mut random));
        digest.clip(&body, &own.with_fewer_keys(&body, &tolerance).unwrap());
        let seconds = one_of(&mut random, &[0.2, 0.6, own.duration(), 0.0]);
        let rate = one_of(&mut random, &[2.0, 6.0]);
        if let Some(closed) = digest.answer(own.with_closed_seam(&body, seconds, rate)) {
            digest.clip(&body, &closed);
        }
        let moved = body.clone().at_rest_in(&used(&body)).unwrap();
        digest.clip(&moved, &own.at_rest_in(&body, &moved).unwrap());
        let bone = body.bone_at(random.below(body.bones())).unwrap();
        let up = one_of(
            &mut random,
            &[Vec3::Y, Vec3::Z * 0.01, Vec3::new(0.3, 1.0, -0.2)],
        );
        if let Some((still, way)) = digest.answer(own.without_root_motion(&body, bone, up, rate)) {
            digest.clip(&body, &still);
            digest.json(way.way());
            digest.json(way.heading());
            for playback in PLAYBACKS {
                digest.affine(&way.after(moment(&mut random), playback));
            }
            let back = still.with_root_motion(&body, bone, &way, rate);
            digest.clip(&body, &back.unwrap());
        }
        let other = {
            let bones = 1 + random.below(5);
            crate::drawn_clips::body(&mut random, bones)
        };
        let refused = [
            digest.answer(own.baked(&other, 3.0)).is_none(),
            digest
                .answer(own.with_fewer_keys(&other, &tolerance))
                .is_none(),
            digest
                .answer(own.with_closed_seam(&other, 0.1, 3.0))
                .is_none(),
            digest.answer(own.channels(&other)).is_none(),
            digest.answer(own.at_rest_in(&body, &other)).is_none(),
        ];
        digest.debug(refused);
    }
    digest.value()
}

/// Clips through poses that differ in some properties of some bones.
fn through_poses() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2003));
    for case in 0..30 {
        let body = Arc::new(body(&mut random, 1 + case % 4));
        let count = random.below(4);
        let mut poses = vec![used(&body); count];
        for pose in &mut poses {
            for bone in body.bone_ids() {
                let other = local(&mut random);
                match random.below(5) {
                    0 => pose.set_translation(bone, other.translation).unwrap(),
                    1 => pose.set_rotation(bone, other.rotation).unwrap(),
                    2 => pose.set_scale(bone, other.scale).unwrap(),
                    3 => pose.set_local(bone, other).unwrap(),
                    _ => {}
                }
            }
            for weight in pose.morph_weights_mut() {
                *weight = one_of(&mut random, &[5.0, 5.0, 0.25]);
            }
        }
        let mut times: Vec<f32> = (0..count).map(|k| 0.25 * k as f32 - 0.5).collect();
        if let Some(last) = times.last_mut().filter(|_| case % 5 == 4) {
            *last = one_of(&mut random, &[-0.5, f32::NAN]);
        }
        if let Some(clip) = digest.answer(Clip::through_poses("through", &body, &times, &poses)) {
            digest.clip(&body, &clip);
        }
    }
    digest.value()
}

#[test]
fn of_drawn_clips() {
    check_single(&[
        ("drawn clips, sampled in turn", sampled()),
        ("drawn clips, and what is made of them", made()),
        ("drawn clips, through poses", through_poses()),
    ]);
}
