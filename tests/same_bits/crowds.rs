//! Promise: so it is for what goes between poses and configurations, and for crowds.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::f32::consts::PI;
use std::sync::Arc;

use glam::{Quat, Vec3A};
use kinopt::Skeleton;
use kinopt::animation::{Armature, BallPoseMap, Crowd, EulerPoseMap, Limb, Playback, PlayingClip};
use kinopt::model::{BallLimits, Limits};
use kinopt::skeleton::{BallSkeleton, BoneCone, BoneId, Cones, SkeletonRoot};
use support::limbs::arm;
use support::random::Random;

use crate::animated::{armature, bone_named as bone, check_single, turn, vector};
use crate::clips::varied;
use crate::digest::{Digest, Value};
use crate::reaching::bent;

/// A skeleton of the limb's armature whose joints have limits.
pub(crate) fn skeleton(body: &Armature) -> Skeleton {
    let room = |bone: BoneId| {
        let wide = 0.7 + 0.2 * bone.index() as f64;
        [
            Limits::new(-wide, wide),
            Limits::new(-2.0, wide),
            Limits::UNBOUNDED,
        ]
    };
    body.skeleton("limb", room).unwrap()
}

fn between() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(124));
    let body = arm();
    let hinges = skeleton(&body);
    digest.json(&hinges);
    let turning: BTreeSet<BoneId> = ["spine", "upper", "lower"].map(|n| bone(&body, n)).into();
    digest.json(&body.turning_skeleton("some", &turning).unwrap());
    let angles = EulerPoseMap::new(&hinges);
    let mut q = vec![0.0; 2];
    for case in 0..12 {
        let mut pose = bent(&body, &mut random, 0.5);
        // Straight bones, whose twists only count together; and bones turned half round.
        let half = (0.5 * PI, [0.3, 0.99, -0.8][case % 3]);
        let twist = Quat::from_xyzw(half.1, 0.0, 0.0, half.0).normalize();
        pose.set_rotation(bone(&body, "hand"), twist).unwrap();
        angles.angles_of(&pose, &mut q).unwrap();
        digest.doubles(q.iter().copied());
        let mut again = body.rest().clone();
        angles.pose_of(&q, &mut again).unwrap();
        digest.pose(&again);
    }
    let small = armature(2, &mut random);
    digest.refused(angles.angles_of(small.rest(), &mut q));
    digest.refused(angles.angles_of(body.rest(), &mut q[..4]));
    digest.refused(angles.pose_of(&q[..4], &mut body.rest().clone()));
    digest.refused(angles.pose_of(&q, &mut small.rest().clone()));
    q[3] = f64::NAN;
    digest.refused(angles.pose_of(&q, &mut body.rest().clone()));

    let cone = BoneCone::new(BallLimits::cone(1.0, Limits::new(-0.5, 0.6)));
    let cones = Cones::from([("upper".to_owned(), cone)]);
    let mut raised = body.rest().clone();
    raised
        .set_rotation(bone(&body, "hips"), turn(&mut random, 0.5))
        .unwrap();
    raised
        .set_scale(bone(&body, "hips"), Vec3A::splat(1.5))
        .unwrap();
    for name in ["spine", "upper", "lower", "hand"] {
        raised
            .set_rotation(bone(&body, name), turn(&mut random, 1.0))
            .unwrap();
    }
    let raised = body.clone().at_rest_in(&raised).unwrap();
    digest.json(&raised.turning_skeleton("raised", &turning).unwrap());
    let angles = EulerPoseMap::new(&skeleton(&raised));
    for _ in 0..4 {
        let pose = bent(&raised, &mut random, 0.5);
        angles.angles_of(&pose, &mut q).unwrap();
        digest.doubles(q.iter().copied());
        let mut again = raised.rest().clone();
        angles.pose_of(&q, &mut again).unwrap();
        digest.pose(&again);
    }
    for root in [SkeletonRoot::Fixed, SkeletonRoot::FREE] {
        // The hips stand still, so that a free root has a parent.
        let skeleton = raised.turning_skeleton("balls", &turning).unwrap();
        let figure = BallSkeleton::new(skeleton, &cones, root).unwrap();
        let turns = BallPoseMap::new(&raised, &figure);
        let mut q = Vec::new();
        for _ in 0..4 {
            let mut pose = bent(&raised, &mut random, 0.5);
            let spine = bone(&raised, "spine");
            pose.set_translation(spine, vector(&mut random, 1.0))
                .unwrap();
            pose.set_rotation(bone(&raised, "hips"), raised.rest().rotations()[0])
                .unwrap();
            turns.configuration_of(&pose, &mut q).unwrap();
            digest.doubles(q.iter().copied());
            let mut again = raised.rest().clone();
            turns.pose_of(&q, &mut again).unwrap();
            digest.pose(&again);
        }
        digest.refused(turns.configuration_of(small.rest(), &mut q));
        digest.refused(turns.configuration_of(raised.rest(), &mut q[1..]));
        digest.refused(turns.pose_of(&q, &mut small.rest().clone()));
        digest.refused(turns.pose_of(&q[1..], &mut raised.rest().clone()));
        let end = q.len() - 4;
        q[end..].fill(0.0);
        digest.refused(turns.pose_of(&q, &mut raised.rest().clone()));
    }
    let mut uneven = body.rest().clone();
    uneven
        .set_scale(bone(&body, "spine"), Vec3A::new(1.0, 1.0, 1.1))
        .unwrap();
    let uneven = body.clone().at_rest_in(&uneven).unwrap();
    digest.json(&uneven.turning_skeleton("uneven", &turning).unwrap());
    digest.refused(body.skeleton("none", |_| [Limits::new(1.0, 0.0); 3]));
    digest.value()
}

fn crowds() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(125));
    let body = armature(16, &mut random);
    let clips = [(); 2].map(|()| Arc::new(varied(&body, &mut random)));
    let child = body
        .bone_ids()
        .filter(|&b| body.parent(b).is_some())
        .last()
        .unwrap();
    let limb = Limb::new(&body, body.parent(child).unwrap(), child, Vec3A::X).unwrap();
    let mut crowd = Crowd::new(body.clone(), vec![limb]);
    for count in 0..4 {
        let playing = (0..count).map(|k| {
            let mut own = PlayingClip::new(Arc::clone(&clips[k % 2]));
            own.playhead.speed = 1.0 - 0.7 * k as f64;
            own.share = [0.3, 0.5, f32::NAN][k];
            own.playback = [Playback::Loop, Playback::PingPong, Playback::Hold][k];
            own
        });
        let character = crowd.add(playing.collect()).unwrap();
        character.goals_mut()[0].target = vector(&mut random, 1.0);
        character.goals_mut()[0].weight = 0.25 * count as f32;
        digest.pose(character.pose());
        digest.affines(character.model_from_bone());
    }
    let mut twin = crowd.clone();
    for step in [0.0, 0.4, 1.1, -0.3] {
        crowd.advance(step).unwrap();
        twin.advance_parallel(step).unwrap();
        for (own, other) in crowd.characters().iter().zip(twin.characters()) {
            digest.pose(own.pose());
            digest.affines(own.model_from_bone());
            assert_eq!(own.pose(), other.pose());
        }
        let [.., last] = crowd.characters_mut() else {
            continue;
        };
        last.clips_mut()[1].share = 0.9;
        let [.., last] = twin.characters_mut() else {
            continue;
        };
        last.clips_mut()[1].share = 0.9;
    }
    digest.text(crowd.characters_mut()[1].clips_mut()[0].clip().name());
    digest.debug(crowd.armature().bones());
    let mut other = Crowd::new(armature(3, &mut random), Vec::new());
    let own = PlayingClip::new(Arc::clone(&clips[0]));
    digest.refused(other.add(vec![own]).map(|_| ()));
    digest.value()
}

#[test]
fn of_crowds() {
    check_single(&[
        ("between poses and configurations", between()),
        ("crowds", crowds()),
    ]);
}
