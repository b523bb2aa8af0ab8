//! Promise: so it is for drawn clips of angles, for captures of drawn clips, and for figures that drawn configurations are put on.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;

use glam::Vec3A;
use kinopt::animation::curve::TensionContinuityBias;
use kinopt::animation::{
    Armature, ArmatureBone, Clip, EulerClip, EulerInterpolation, EulerKey, EulerTrack,
    LocalTransform,
};
use kinopt::motion::retarget::{Capture, FigureTarget, UpAxis};
use kinopt::skeleton::BoneId;
use support::random::Random;

use crate::animated::{check_single, number, rotation, vector};
use crate::digest::{Digest, Value};
use crate::drawn::{at_times, one_of};
use crate::drawn_clips::{PLAYBACKS, body, clip};
use crate::robot_texts::add_text;

/// Tracks in any order, of no keys at times, seldom with one that is wrong.
fn tracks(random: &mut Random, body: &Armature) -> Vec<EulerTrack> {
    let mut bones: Vec<BoneId> = body.bone_ids().filter(|_| at_times(random, 0.8)).collect();
    bones.reverse();
    let count = bones.len();
    if count > 1 {
        bones.swap(0, random.below(count));
        if at_times(random, 0.05) {
            bones[0] = bones[1];
        }
    }
    let tracks = bones.into_iter().map(|bone| {
        let mut time = random.within(-1.0, 1.0);
        let keys = (0..random.below(5)).map(|_| {
            time += random.within(0.1, 1.0);
            let mut angles = [(); 3].map(|()| random.within(-2.0, 2.0));
            match random.below(60) {
                0 => time -= 1.5,
                1 => angles[1] = f64::NAN,
                2 => time = f64::INFINITY,
                _ => {}
            }
            EulerKey { time, angles }
        });
        let keys = keys.collect();
        EulerTrack { bone, keys }
    });
    tracks.collect()
}

fn angles() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2091));
    for case in 0..60 {
        let body = body(&mut random, 1 + case % 5);
        let Some(own) = digest.answer(EulerClip::new(tracks(&mut random, &body))) else {
            continue;
        };
        let odd = [0.0, 0.4, -0.7, 0.4, -0.7, 0.4, -0.7, f32::NAN];
        let kinds = [(); 5].map(|()| {
            let controls = TensionContinuityBias {
                tension: one_of(&mut random, &odd),
                continuity: one_of(&mut random, &odd),
                bias: one_of(&mut random, &odd),
            };
            (random.below(3), controls, at_times(&mut random, 0.05))
        });
        let chosen = own.interpolated(|track| match kinds[track.bone.index() % 5] {
            (0, ..) => EulerInterpolation::CatmullRom,
            (1, ..) => EulerInterpolation::Linear,
            (_, controls, false) => EulerInterpolation::kochanek_bartels(track, controls),
            (_, controls, true) => EulerInterpolation::KochanekBartels(vec![controls; 2]),
        });
        let Some(own) = digest.answer(chosen) else {
            continue;
        };
        digest.json(&own);
        digest.debug((own.keyless(), own.is_empty(), own.time_span()));
        let mut q = vec![9.0; 3 * body.bones()];
        for bone in body.bone_ids() {
            digest.debug((own.keys(bone), own.interpolation(bone)));
        }
        for _ in 0..6 {
            let time = one_of(&mut random, &[-1.5, -0.2, 0.3, 0.9, 2.1, 4.0, f64::NAN]);
            let playback = one_of(&mut random, &PLAYBACKS);
            let angles = q.len() - 3 * (random.below(9) / 8);
            digest.answer(own.sample(time, playback, &mut q[..angles]));
            digest.doubles(q.iter().copied());
        }
        let other = crate::drawn_clips::body(&mut random, 4);
        for armature in [&body, &other] {
            let mut builder = Clip::builder("angles", armature);
            let told = builder.euler_clip(&own).map(|_| ());
            digest.answer(told);
            digest.clip(armature, &builder.build());
        }
    }
    digest.value()
}

fn captures() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2092));
    for case in 0..40 {
        let body = body(&mut random, 1 + case % 4);
        let mut own = clip("own", &body, &mut random);
        if at_times(&mut random, 0.1) {
            let text = serde_json::to_string(&own).unwrap();
            let span = serde_json::to_string(&own.span()).unwrap();
            own = serde_json::from_str(&text.replacen(&span, "null", 1)).unwrap();
        }
        let duration = own.duration();
        let rates = [
            2.0,
            7.0,
            10.0,
            4.0 / duration,
            2.4999999 / duration,
            0.0,
            1e12,
        ];
        let rate = one_of(&mut random, &rates);
        if let Some(found) = digest.answer(Capture::of_clip(&body, &own, rate)) {
            add_text(&mut digest, &format!("{found:?} {}", found.frames()));
            for frame in [0, found.frames() - 1, found.frames()] {
                add_text(&mut digest, &format!("{:?}", found.frame(frame)));
            }
            for name in ["bone 0", "bone 2", "bome 0"] {
                if let Some(joint) = digest.answer(found.joint(name)) {
                    digest.word(joint as u64);
                }
            }
        }
        let names = ["a", "b", "c", "a"][random.below(2)..2 + random.below(3)].to_vec();
        let names: Vec<String> = names.into_iter().map(str::to_owned).collect();
        let count = 3 * names.len() * random.below(4) + random.below(5) / 4;
        let value = |random: &mut Random| {
            one_of(
                random,
                &[0.5, -2.0, 1.0, 0.25, 3.0, 7.0, -1e12, 1e13, f64::NAN],
            )
        };
        let odd = at_times(&mut random, 0.3);
        let numbers: Vec<f64> = (0..count)
            .map(|k| if odd { value(&mut random) } else { k as f64 })
            .collect();
        if let Some(found) = digest.answer(Capture::new(names, &numbers, 3.0)) {
            add_text(&mut digest, &format!("{found:?}"));
        }
    }
    digest.value()
}

/// A figure that stands anywhere, with bones of any size above those that turn.
fn figure(random: &mut Random, bones: usize) -> Armature {
    let list = (0..bones).map(|k| ArmatureBone {
        name: format!("bone {k}"),
        parent: (k > 0).then(|| (k - 1).min(random.below(k + 3))),
        rest: LocalTransform {
            translation: vector(random, 1.0),
            rotation: rotation(random),
            scale: Vec3A::splat(one_of(random, &[1.0, 0.8, 1.5])),
        },
    });
    Armature::new(list.collect(), Vec::new()).unwrap()
}

fn figures() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2093));
    for case in 0..30 {
        let body = figure(&mut random, 2 + case % 6);
        let turning: BTreeSet<BoneId> = body
            .bone_ids()
            .filter(|_| at_times(&mut random, 0.7))
            .collect();
        let up = one_of(&mut random, &[UpAxis::Y, UpAxis::Z]);
        let Some(target) = digest.answer(FigureTarget::of_armature(&body, &turning, up)) else {
            continue;
        };
        let model = target.robot().model();
        add_text(
            &mut digest,
            &format!("{:?} {:?}", target.up(), model.configuration_len()),
        );
        let frames = random.below(4);
        let mut q = Vec::new();
        for _ in 0..frames {
            let mut own = model.neutral();
            for angle in own.iter_mut().skip(7) {
                *angle += random.within(-0.5, 0.5);
            }
            let turned = rotation(&mut random).as_dquat().normalize();
            own[..3].copy_from_slice(&[(); 3].map(|()| random.within(-1.0, 1.0)));
            own[3..7].copy_from_slice(&[turned.w, turned.x, turned.y, turned.z]);
            if at_times(&mut random, 0.05) {
                own[8] = f64::NAN;
            }
            q.extend(own);
        }
        let mut stands = body.rest().clone();
        if at_times(&mut random, 0.5) {
            let bone = body.bone_at(random.below(body.bones())).unwrap();
            stands
                .set_scale(bone, Vec3A::splat(1.0 + 0.5 * number(&mut random, 0.5)))
                .unwrap();
        }
        let other = figure(&mut random, 3);
        let given = if at_times(&mut random, 0.1) {
            &other
        } else {
            &body
        };
        if let Some(poses) = digest.answer(target.poses(given, &stands, &q)) {
            poses.iter().for_each(|pose| digest.pose(pose));
        }
        if let Some(clip) = digest.answer(target.clip("put on", &body, &q, 5.0)) {
            digest.clip(&body, &clip);
        }
    }
    digest.value()
}

#[test]
fn of_drawn_captures() {
    check_single(&[
        ("drawn clips of angles", angles()),
        ("drawn captures", captures()),
        ("drawn figures", figures()),
    ]);
}
