//! Promise: so it is for inverse kinematics over clips, over a rig's own keys and over poses, of which several things are asked at once.
#![allow(clippy::unwrap_used)]

use glam::{DVec3, Vec3A};
use kinopt::Solver;
use kinopt::animation::curve::{KeyedCurve, TensionContinuityBias};
use kinopt::animation::{
    Armature, Channel, Clip, Cursor, EulerInterpolation, Playback, ReachLayer,
};
use kinopt::ik::Restarts;
use kinopt::motion::ContactDetection;
use kinopt::motion::clip_ik::{ClipIk, KeyframeIk, Reach, ground_speed};
use kinopt::skeleton::{BoneId, Skeleton};
use kinopt::spatial::{Quaternion, Vector3};
use support::limbs::arm;
use support::random::Random;

use crate::animated::{check_single, rotation, vector};
use crate::clip_ik;
use crate::crowds;
use crate::digest::{Digest, Value, check};
use crate::drawn::{at_times, one_of};
use crate::keys;
use crate::reaching::bent;
use crate::walking_figure::{figure, walk};

fn reach(random: &mut Random, bone: BoneId, near: [f64; 3], span: f64) -> Reach {
    let off = |random: &mut Random| random.within(-0.3, 0.3);
    let mut at = || near.map(|x| x + off(random));
    let points = [at(), at(), at()].map(DVec3::from);
    let mut reach = match at_times(random, 0.4) {
        true => {
            let times = vec![0.1 * span, 0.5 * span, 0.8 * span];
            let curve = KeyedCurve::catmull_rom(times, points.to_vec());
            Reach::along(bone, curve.unwrap())
        }
        false => Reach::to(bone, points[0].to_array()).unwrap(),
    };
    if at_times(random, 0.6) {
        let from = span * one_of(random, &[-0.3, 0.0, 0.2, 0.35, 0.6]);
        let long = span * one_of(random, &[0.2, 0.35, 0.35, 0.9, 0.0]);
        reach = reach.with_span(from..=from + long);
    }
    if at_times(random, 0.4) {
        reach = reach.with_fade(span * one_of(random, &[0.0, 0.05, 0.1, 0.1, 0.6]));
    }
    reach
}

fn detection(random: &mut Random) -> ContactDetection {
    let mut own = ContactDetection::default().with_speed(one_of(random, &[0.0, 0.4, 0.8]));
    if at_times(random, 0.5) {
        own = own.with_height(one_of(random, &[0.0, 0.05, 0.2]));
    }
    if at_times(random, 0.3) {
        own = own.with_shortest(one_of(random, &[0.0, 0.3]));
    }
    if at_times(random, 0.4) {
        own = own.with_lead(one_of(random, &[0.0, 0.4, -1.0]));
    }
    own
}

/// The same in five times the time, so that all of it is slow.
fn slowed(armature: &Armature, clip: &Clip) -> Clip {
    let (mut cursor, mut poses) = (Cursor::new(), Vec::new());
    let times: Vec<f32> = (0..12).map(|k| 0.5 * k as f32).collect();
    for &time in &times {
        let mut pose = armature.rest().clone();
        let elapsed = f64::from(time) / 5.0;
        clip.sample(elapsed, Playback::Hold, &mut cursor, &mut pose)
            .unwrap();
        poses.push(pose);
    }
    Clip::through_poses("slow", armature, &times, &poses).unwrap()
}

fn walks() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2051));
    let plain = figure();
    // One whose world is turned, moved and scaled at rest.
    let mut raised = plain.rest().clone();
    let world = plain.bone("world").unwrap();
    raised.set_rotation(world, rotation(&mut random)).unwrap();
    raised
        .set_translation(world, Vec3A::new(0.3, -0.2, 0.5))
        .unwrap();
    raised.set_scale(world, Vec3A::splat(1.2)).unwrap();
    let raised = plain.clone().at_rest_in(&raised).unwrap();
    let id = |name: &str| plain.bone(name).unwrap();
    for case in 0..36 {
        let armature = if case % 3 == 2 { &raised } else { &plain };
        let mut clip = walk(armature, at_times(&mut random, 0.6));
        if at_times(&mut random, 0.25) {
            clip = slowed(armature, &clip);
        }
        let rate = one_of(&mut random, &[5.0, 8.0, 11.0]);
        let mut ik = ClipIk::new(armature).with_keys_per_second(rate);
        for foot in ["foot.l", "foot.r"] {
            if at_times(&mut random, 0.55) {
                ik = ik.with_planted(id(foot));
            }
        }
        let mut ends = vec![0.05..=0.3, 0.4..=0.6, 0.7..=0.95];
        if at_times(&mut random, 0.25) {
            ends.rotate_left(random.below(3));
            for span in ends.into_iter().take(2) {
                let long = clip.duration();
                let to = [0.5, 1.2, random.within(0.3, 0.8)];
                let own = Reach::to(id("hand"), to).unwrap();
                let span = long * span.start()..=long * span.end();
                ik = ik.with_reach(own.with_span(span).with_fade(0.02));
            }
        }
        for (bone, near) in [
            ("hand", [0.5, 1.2, 0.6]),
            ("head", [0.1, 1.4, 0.6]),
            ("hand", [0.4, 1.3, 1.0]),
            ("foot.r", [-0.1, 0.1, 0.6]),
        ] {
            if at_times(&mut random, 0.35) {
                ik = ik.with_reach(reach(&mut random, id(bone), near, clip.duration()));
            }
        }
        if at_times(&mut random, 0.4) {
            let roots = ["world", "hips", "hips", "hips", "chest", "thigh.l"];
            ik = ik.with_root(id(one_of(&mut random, &roots)));
        }
        if at_times(&mut random, 0.3) {
            ik = ik.with_up(one_of(
                &mut random,
                &[[0.0, 3.0, 0.0], [0.3, 1.0, 0.0], [0.0; 3]],
            ));
        }
        if at_times(&mut random, 0.3) {
            ik = ik.with_detection(detection(&mut random));
        }
        if at_times(&mut random, 0.3) {
            ik = ik.with_root_velocity([random.within(-0.2, 0.2), 0.0, random.within(-1.0, 1.0)]);
        }
        if at_times(&mut random, 0.4) {
            let [rise, tilt, step] = [(); 3].map(|()| random.within(-0.15, 0.15));
            ik = ik.with_ground(move |at: Vector3<f64>| {
                rise * at.z + tilt * at.x + if at.z > 0.5 { step } else { 0.0 }
            });
        }
        let feet = [id("foot.l"), id("foot.r"), id("hand")];
        let count = random.below(3);
        let up = one_of(
            &mut random,
            &[glam::Vec3::Y, glam::Vec3::new(0.2, 1.0, 0.1)],
        );
        if let Some(speed) = digest.answer(ground_speed(armature, &clip, &feet[..count], up, 20.0))
        {
            digest.singles(speed.to_array());
        }
        clip_ik::add(&mut digest, armature, ik.solve(&clip));
    }
    digest.value()
}

/// An arm of bones with limits, in a clip that moves its other channels too.
fn with_joints() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2052));
    let joints: Skeleton = clip_ik::skeleton();
    let body = Armature::of_skeleton(&joints)
        .with_morph_targets(vec!["smile".into()])
        .unwrap();
    for _ in 0..16 {
        let mut builder = Clip::builder("drawn", &body);
        for bone in body.bone_ids() {
            let rest = body.rest().local(bone).unwrap();
            let turns = [(); 3].map(|()| rest.rotation * crate::animated::turn(&mut random, 0.15));
            let times = one_of(&mut random, &[vec![0.0, 0.2, 0.5], vec![0.1, 0.3, 0.4]]);
            let curve =
                kinopt::animation::rotation::RotationCurve::slerp(times.clone(), turns.to_vec());
            if at_times(&mut random, 0.8) {
                builder
                    .channel(bone, Channel::Rotation(curve.unwrap()))
                    .unwrap();
            }
            if at_times(&mut random, 0.3) {
                let size = random.within(0.8, 1.2) as f32;
                let scales = vec![Vec3A::ONE, Vec3A::splat(size), Vec3A::ONE];
                let curve = KeyedCurve::linear(times, scales).unwrap();
                builder.channel(bone, Channel::Scale(curve)).unwrap();
            }
        }
        if at_times(&mut random, 0.5) {
            let weights = KeyedCurve::linear(vec![0.0, 0.5], vec![0.1, 0.9]).unwrap();
            builder.morph_weight(0, weights).unwrap();
        }
        let clip = builder.build();
        let mut ik = ClipIk::new(&body).with_keys_per_second(9.0);
        if at_times(&mut random, 0.7) {
            ik = ik.with_joints_of(&joints);
        }
        let hand = body.bone("hand").unwrap();
        let near = one_of(
            &mut random,
            &[[0.9, 0.5, 0.1], [1.4, 0.3, 0.0], [0.6, 0.9, 0.3]],
        );
        ik = ik.with_reach(reach(&mut random, hand, near, 0.5));
        if at_times(&mut random, 0.4) {
            ik = ik.with_reach(reach(
                &mut random,
                body.bone("fore").unwrap(),
                [0.8, 0.3, 0.0],
                0.5,
            ));
        }
        if at_times(&mut random, 0.4) {
            let roots = ["base", "upper"];
            ik = ik.with_root(body.bone(one_of(&mut random, &roots)).unwrap());
        }
        let solved = ik.solve(&clip);
        if let Ok(edited) = &solved {
            digest.json(&edited.clip.morph_channels(&body).unwrap());
        }
        clip_ik::add(&mut digest, &body, solved);
    }
    digest.value()
}

fn rigs_keys() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2053));
    let skeleton = keys::skeleton();
    let id = |name: &str| skeleton.bone(name).unwrap();
    for _ in 0..26 {
        let key = random.below(9);
        let beyond = one_of(&mut random, &[0.0, 0.0, 1.0, -1.3]);
        let clip = keys::keys(&skeleton, |k| if k == key { beyond } else { 0.0 });
        let controls = TensionContinuityBias {
            tension: random.within(-0.5, 0.5) as f32,
            continuity: random.within(-0.5, 0.5) as f32,
            bias: random.within(-0.5, 0.5) as f32,
        };
        let kinds = [(); 5].map(|()| random.below(3));
        let clip = clip.interpolated(|track| match kinds[track.bone.index() % 5] {
            0 => EulerInterpolation::default(),
            1 => EulerInterpolation::kochanek_bartels(track, controls),
            _ => EulerInterpolation::Linear,
        });
        let rate = one_of(&mut random, &[4.0, 7.0]);
        let mut ik = KeyframeIk::new(&skeleton).with_moments_per_second(rate);
        for (bone, near) in [
            ("hand", [0.9, 0.4, 0.1]),
            ("head", [0.6, 0.3, 0.1]),
            ("fore", [0.9, 0.3, 0.1]),
        ] {
            if at_times(&mut random, 0.5) {
                ik = ik.with_reach(reach(&mut random, id(bone), near, 2.0));
            }
        }
        if at_times(&mut random, 0.4) {
            ik = ik.with_root(id(one_of(
                &mut random,
                &["trunk", "trunk", "upper", "head"],
            )));
        }
        keys::add(&mut digest, ik.solve(&clip.unwrap()));
    }
    digest.value()
}

/// Layers of several tips and held bones, asked time after time.
fn layers() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2054));
    let body = arm();
    let skeleton = crowds::skeleton(&body);
    let bones: Vec<BoneId> = body.bone_ids().collect();
    for _ in 0..30 {
        let some = |random: &mut Random, least: usize, most: usize| -> Vec<BoneId> {
            let count = least + random.below(most);
            (0..count).map(|_| one_of(random, &bones)).collect()
        };
        let (tips, held) = (some(&mut random, 0, 3), some(&mut random, 0, 3));
        let solver = Solver::default().with_restarts(Restarts::none());
        let Some(mut layer) = digest.answer(ReachLayer::holding(&skeleton, &tips, &held, solver))
        else {
            continue;
        };
        for _ in 0..5 {
            let mut pose = bent(&body, &mut random, 0.3);
            if at_times(&mut random, 0.4) {
                let scale = one_of(
                    &mut random,
                    &[
                        Vec3A::splat(0.8),
                        Vec3A::new(1.0, 1.4, 0.9),
                        Vec3A::splat(-1.0),
                    ],
                );
                pose.set_scale(one_of(&mut random, &bones), scale).unwrap();
            }
            if at_times(&mut random, 0.3) {
                let place = vector(&mut random, 0.4);
                pose.set_translation(one_of(&mut random, &bones), place)
                    .unwrap();
            }
            let weights = [0.0, 0.3, 1.0, 2.5, -1.0, f64::NAN];
            for &tip in tips.iter().chain(&held) {
                if at_times(&mut random, 0.6) {
                    let mut to = vector(&mut random, 0.7).as_dvec3() + DVec3::Y * 1.5;
                    if at_times(&mut random, 0.1) {
                        to.z = f64::INFINITY;
                    }
                    let weight = one_of(&mut random, &weights);
                    digest.answer(layer.set_goal(tip, to.to_array(), weight));
                }
                if at_times(&mut random, 0.6) {
                    let size = one_of(&mut random, &[1.0, 1.0, 2.0, 0.0]);
                    let turned = Quaternion::from(rotation(&mut random).as_dquat() * size);
                    let weight = one_of(&mut random, &weights);
                    digest.answer(layer.set_rotation(tip, turned, weight));
                }
            }
            if let Some(Some(solution)) = digest.answer(layer.apply(&mut pose)) {
                digest.solution(solution);
            }
            digest.pose(&pose);
        }
    }
    digest.value()
}

#[test]
fn of_drawn_clip_ik() {
    check_single(&[
        ("drawn clip IK of a walk", walks()),
        ("drawn clip IK of limited joints", with_joints()),
        ("drawn layers that reach", layers()),
    ]);
    check(&[("drawn keys of a rig", rigs_keys())]);
}
