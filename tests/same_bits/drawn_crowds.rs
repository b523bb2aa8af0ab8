//! Promise: so it is for what is laid over poses, whose options are drawn at random: masks, layers, limbs, aims, and crowds of them.
#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use glam::{Quat, Vec3A};
use kinopt::animation::{
    Aim, AimGoal, Armature, BoneMask, Crowd, EndRotation, Layer, LayerMode, Limb, LimbGoal,
    PlayingClip, Pose, blend_poses,
};
use kinopt::skeleton::BoneId;
use support::random::Random;

use crate::animated::{check_single, number, pose, rotation, vector};
use crate::digest::{Digest, Value};
use crate::drawn::{at_times, one_of};
use crate::drawn_clips::{PLAYBACKS, body, clip};

fn any_bone(random: &mut Random, body: &Armature) -> BoneId {
    body.bone_at(random.below(body.bones())).unwrap()
}

/// A weight, or what is none.
fn share(random: &mut Random) -> f32 {
    one_of(
        random,
        &[0.0, 0.3, 0.85, 1.0, 1.0, 1.6, -0.4, f32::NAN, f32::INFINITY],
    )
}

fn mask(digest: &mut Digest, random: &mut Random, body: &Armature, other: &Armature) -> BoneMask {
    let mut mask = match random.below(2) {
        0 => BoneMask::all(body),
        _ => BoneMask::none(body),
    };
    for _ in 0..random.below(4) {
        let own = one_of(random, &[body, body, body, other]);
        let share = one_of(random, &[0.0, 0.3, 0.7, 1.0, 1.0, 1.5, f32::NAN]);
        let bone = any_bone(random, own);
        let told = match random.below(3) {
            0 => mask.clone().with_bone(bone, share),
            1 => mask.clone().with_subtree(own, bone, share),
            _ => mask.clone().with_morph_target(random.below(3), share),
        };
        if let Some(next) = digest.answer(told) {
            mask = next;
        }
    }
    digest.singles(mask.bones().iter().chain(mask.morph_targets()).copied());
    mask
}

fn laid_over() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2011));
    for case in 0..90 {
        let body = body(&mut random, 1 + case % 11);
        let other = crate::drawn_clips::body(&mut random, 2 + case % 7);
        let mut own = pose(&body, &mut random);
        for _ in 0..3 {
            let armature = one_of(&mut random, &[&body, &body, &body, &body, &other]);
            let over = pose(armature, &mut random);
            let mask = mask(&mut digest, &mut random, &body, &other);
            let mut reference = pose(&body, &mut random);
            if at_times(&mut random, 0.5) {
                reference
                    .set_scale(any_bone(&mut random, &body), Vec3A::X)
                    .unwrap();
            }
            let mode = match random.below(3) {
                0 => LayerMode::Override,
                1 => LayerMode::Additive { reference },
                _ => LayerMode::Additive {
                    reference: other.rest().clone(),
                },
            };
            let weight = share(&mut random);
            let told = match random.below(5) {
                0 => own.cross_fade(&over, weight),
                1 => own.cross_fade_masked(&over, weight, &mask),
                _ => Layer { mode, weight, mask }.apply(&mut own, &over),
            };
            digest.answer(told);
            digest.pose(&own);
        }
        let poses = [(); 4].map(|()| pose(&body, &mut random));
        let mut parts: Vec<(&Pose, f32)> = Vec::new();
        for pose in poses.iter().take(random.below(5)) {
            parts.push((pose, one_of(&mut random, &[0.0, 0.5, 1.0, 3.0, 3.0, -1.0])));
        }
        if at_times(&mut random, 0.1) {
            parts.push((other.rest(), 0.5));
        }
        digest.answer(blend_poses(&parts, &mut own));
        digest.pose(&own);
    }
    digest.value()
}

/// A limb of any bones of a body, or none.
fn limb(digest: &mut Digest, random: &mut Random, body: &Armature) -> Option<Limb> {
    let lower = any_bone(random, body);
    let mut upper = body.parent(lower)?;
    if at_times(random, 0.3) {
        upper = body.parent(upper).unwrap_or(upper);
    }
    let below = body
        .bone_ids()
        .find(|&bone| body.parent(bone) == Some(lower));
    let limb = match below.filter(|_| at_times(random, 0.8)) {
        Some(end) => {
            let end = if at_times(random, 0.1) {
                any_bone(random, body)
            } else {
                end
            };
            Limb::to_bone(body, upper, lower, end)
        }
        None => {
            let end = one_of(
                random,
                &[
                    Vec3A::X,
                    Vec3A::new(0.1, -0.8, 0.2),
                    Vec3A::ZERO,
                    Vec3A::NAN,
                ],
            );
            Limb::new(body, upper, lower, end)
        }
    };
    let mut limb = digest.answer(limb)?;
    if at_times(random, 0.4) {
        let axis = one_of(random, &[Vec3A::Z, Vec3A::new(0.5, -2.0, 0.1), Vec3A::ZERO]);
        limb = digest.answer(limb.with_hinge(axis)).unwrap_or(limb);
    }
    if at_times(random, 0.4) {
        let from = one_of(random, &[0.0, 0.5, 0.9, 1.0, 1.1]);
        limb = digest.answer(limb.with_softening(from)).unwrap_or(limb);
    }
    Some(limb)
}

fn goal(random: &mut Random) -> LimbGoal {
    let far = one_of(random, &[0.0, 0.5, 1.0, 2.0, 9.0]);
    let mut goal = LimbGoal::at(vector(random, far));
    if at_times(random, 0.1) {
        goal.target = Vec3A::NAN;
    }
    goal.weight = share(random);
    if at_times(random, 0.5) {
        goal.pole = Some(one_of(
            random,
            &[Vec3A::Y, Vec3A::new(0.4, 5.0, -2.0), Vec3A::NAN],
        ));
    }
    if at_times(random, 0.4) {
        goal.twist = one_of(random, &[0.5, -2.0, f32::INFINITY]);
    }
    goal.end = match random.below(3) {
        0 => EndRotation::Follow,
        1 => EndRotation::Hold {
            weight: share(random),
        },
        _ => {
            let asked = rotation(random);
            let nothing = Quat::from_xyzw(0.0, 0.0, 0.0, 0.0);
            EndRotation::Goal {
                rotation: one_of(random, &[asked, asked * 3.0, nothing]),
                weight: share(random),
            }
        }
    };
    goal
}

/// As it is, or with bones that stand on a line or are drawn together.
fn stretched(body: &Armature, random: &mut Random) -> Pose {
    let mut pose = pose(body, random);
    let plain = at_times(random, 0.4);
    for bone in body.bone_ids() {
        pose.set_scale(bone, Vec3A::splat(random.within(0.7, 1.4) as f32))
            .unwrap();
        if plain {
            pose.set_translation(bone, Vec3A::X).unwrap();
            pose.set_rotation(bone, Quat::IDENTITY).unwrap();
        }
    }
    if at_times(random, 0.2) {
        let bone = any_bone(random, body);
        pose.set_translation(bone, Vec3A::ZERO).unwrap();
    }
    pose
}

fn limbs_and_aims() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2012));
    for case in 0..200 {
        let body = body(&mut random, 3 + case % 6);
        let small = crate::drawn_clips::body(&mut random, 2);
        if let Some(limb) = limb(&mut digest, &mut random, &body) {
            for _ in 0..4 {
                let mut own = stretched(&body, &mut random);
                digest.answer(limb.reach(&body, &mut own, &goal(&mut random)));
                digest.pose(&own);
            }
            digest.answer(limb.reach(&body, &mut small.rest().clone(), &goal(&mut random)));
        }
        let axes = [
            Vec3A::Z,
            Vec3A::new(0.0, 0.3, 1.0),
            Vec3A::X * 3.0,
            Vec3A::ZERO,
        ];
        let own = one_of(&mut random, &[&body, &body, &body, &small]);
        let bone = any_bone(&mut random, &body);
        let Some(mut aim) = digest.answer(Aim::new(own, bone, one_of(&mut random, &axes))) else {
            continue;
        };
        if at_times(&mut random, 0.6) {
            let up = aim.with_up(one_of(&mut random, &axes));
            aim = digest.answer(up).unwrap_or(aim);
        }
        if at_times(&mut random, 0.5) {
            let offsets = [
                Vec3A::Y * 0.2,
                Vec3A::new(0.1, 0.1, 0.4),
                -Vec3A::Z,
                Vec3A::INFINITY,
            ];
            let offset = aim.with_offset(one_of(&mut random, &offsets));
            aim = digest.answer(offset).unwrap_or(aim);
        }
        for _ in 0..4 {
            let mut own = stretched(&body, &mut random);
            let mut goal = AimGoal::at(vector(&mut random, 2.0));
            goal.weight = share(&mut random);
            goal.twist = one_of(&mut random, &[0.0, 0.0, 1.1, f32::NAN]);
            if at_times(&mut random, 0.5) {
                goal.up = Some(one_of(&mut random, &axes));
            }
            if at_times(&mut random, 0.1) {
                goal.target = body.model_from_bone(&own, bone).unwrap().translation;
            }
            digest.debug(aim.turn(&body, &mut own, &goal).ok());
            digest.pose(&own);
        }
    }
    digest.value()
}

/// Characters whose clips, limbs and goals differ, as some of them change between frames.
fn crowds() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2013));
    for case in 0..40 {
        let body = body(&mut random, 1 + case % 9);
        let other = crate::drawn_clips::body(&mut random, 1 + case % 8);
        let own = ["a", "b", "c"].map(|name| Arc::new(clip(name, &body, &mut random)));
        let wrong = Arc::new(clip("wrong", &other, &mut random));
        let mut limbs: Vec<Limb> = Vec::new();
        for _ in 0..random.below(3) {
            limbs.extend(limb(&mut digest, &mut random, &body));
        }
        let mut crowd = Crowd::new(body.clone(), limbs);
        for _ in 0..5 {
            let mut clips = Vec::new();
            for _ in 0..random.below(4) {
                let played = match at_times(&mut random, 0.1) {
                    true => &wrong,
                    false => &own[random.below(3)],
                };
                let mut playing = PlayingClip::new(Arc::clone(played));
                playing.share = share(&mut random);
                playing.playback = one_of(&mut random, &PLAYBACKS);
                playing.playhead.speed = one_of(&mut random, &[1.0, -0.6, 2.0, 0.0]);
                clips.push(playing);
            }
            let Some(character) = digest.answer(crowd.add(clips)) else {
                continue;
            };
            for own in character.goals_mut() {
                if at_times(&mut random, 0.6) {
                    *own = goal(&mut random);
                }
            }
        }
        digest.word(crowd.characters().len() as u64);
        for _ in 0..4 {
            let seconds = one_of(&mut random, &[0.0, 0.2, 0.7, -0.3, f64::NAN]);
            crowd.advance(seconds).unwrap();
            let mut twin = crowd.clone();
            twin.advance_parallel(0.1).unwrap();
            for (own, twin) in crowd.characters().iter().zip(twin.characters()) {
                for character in [own, twin] {
                    digest.pose(character.pose());
                    digest.affines(character.model_from_bone());
                }
            }
            for character in crowd.characters_mut() {
                match random.below(4) {
                    0 => character
                        .clips_mut()
                        .iter_mut()
                        .for_each(|own| own.share = number(&mut random, 1.0)),
                    1 => character
                        .goals_mut()
                        .iter_mut()
                        .for_each(|own| *own = goal(&mut random)),
                    _ => {}
                }
            }
        }
    }
    digest.value()
}

#[test]
fn of_drawn_crowds() {
    check_single(&[
        ("drawn layers and masks", laid_over()),
        ("drawn limbs and aims", limbs_and_aims()),
        ("drawn crowds", crowds()),
    ]);
}
