//! Promise: so it is for poses that reach: limbs and aims in closed form, layers of the optimiser.
#![allow(clippy::unwrap_used)]

use glam::{Quat, Vec3A};
use kinopt::Solver;
use kinopt::animation::{Aim, AimGoal, Armature, EndRotation, Limb, LimbGoal, Pose, ReachLayer};
use kinopt::ik::Restarts;
use kinopt::spatial::Quaternion;
use support::limbs::{END, arm};
use support::random::Random;

use crate::animated::{armature, bone_named as bone, check_single, number, rotation, turn, vector};
use crate::crowds::skeleton;
use crate::digest::{Digest, Value};

/// The limb's armature in a pose with its elbow bent about z, more or less, and scaled alike.
pub(crate) fn bent(body: &Armature, random: &mut Random, off: f64) -> Pose {
    let mut pose = body.rest().clone();
    for name in ["hips", "spine", "upper", "twist"] {
        pose.set_rotation(bone(body, name), turn(random, 1.0))
            .unwrap();
    }
    let about = Vec3A::new(number(random, off), number(random, off), 1.0);
    let elbow = Quat::from_xyzw(about.x, about.y, about.z, 1.5).normalize();
    pose.set_rotation(bone(body, "lower"), elbow).unwrap();
    pose.set_scale(bone(body, "spine"), Vec3A::splat(1.3))
        .unwrap();
    pose
}

fn limbs() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(121));
    let body = arm();
    let [upper, lower, hand] = ["upper", "lower", "hand"].map(|name| bone(&body, name));
    let to_point = || Limb::new(&body, upper, lower, END).unwrap();
    let to_hand = || Limb::to_bone(&body, upper, lower, hand).unwrap();
    let limbs = [
        to_point(),
        to_hand(),
        to_point().with_hinge(Vec3A::Z * 2.0).unwrap(),
        to_hand().with_hinge(Vec3A::new(0.1, 0.2, 1.0)).unwrap(),
        to_point().with_softening(0.8).unwrap(),
        to_hand().with_softening(0.0).unwrap(),
    ];
    let held = [
        EndRotation::Follow,
        EndRotation::Hold { weight: 1.0 },
        EndRotation::Hold { weight: 0.4 },
        EndRotation::Hold { weight: f32::NAN },
        EndRotation::Goal {
            rotation: Quat::from_xyzw(1.0, 2.0, 0.5, -1.0),
            weight: 0.7,
        },
        EndRotation::Goal {
            rotation: Quat::from_xyzw(0.0, 0.0, 0.0, 0.0),
            weight: 1.0,
        },
    ];
    let goals = [
        LimbGoal::at(Vec3A::new(0.5, 1.7, 0.1)),
        LimbGoal::at(Vec3A::new(0.9, 2.5, -1.0)),
        LimbGoal::at(Vec3A::new(0.3, 1.75, 0.05)),
        LimbGoal::at(Vec3A::new(-1.0, 1.0, 0.3)),
        LimbGoal::at(Vec3A::NAN),
    ];
    let poles = [None, Some(Vec3A::new(0.3, 0.5, 2.0)), Some(Vec3A::NAN)];
    for (kind, limb) in limbs.iter().enumerate() {
        for (place, goal) in goals.iter().enumerate() {
            for (number, pole) in poles.iter().enumerate() {
                let case = kind + place + number;
                let goal = LimbGoal {
                    pole: *pole,
                    twist: [0.0, 0.5, f32::NAN, -1.0][case % 4],
                    weight: [1.0, 0.6, 1.5, 0.3, 0.0][case % 5],
                    end: held[case % 6],
                    ..*goal
                };
                let mut pose = bent(&body, &mut random, 0.3);
                limb.reach(&body, &mut pose, &goal).unwrap();
                digest.pose(&pose);
                let mut straight = body.rest().clone();
                limb.reach(&body, &mut straight, &goal).unwrap();
                digest.pose(&straight);
            }
        }
    }
    let small = armature(3, &mut random);
    let first = |k| small.bone_at(k).unwrap();
    digest.refused(Limb::new(&small, first(0), hand, END));
    digest.refused(Limb::new(&body, lower, upper, END));
    digest.refused(Limb::new(&body, upper, lower, Vec3A::NAN));
    digest.refused(Limb::to_bone(&body, upper, hand, lower));
    digest.refused(Limb::to_bone(&body, upper, bone(&body, "bystander"), hand));
    digest.refused(to_hand().with_hinge(Vec3A::ZERO));
    digest.refused(to_hand().with_softening(1.5));
    digest.refused(to_hand().with_softening(f32::NAN));
    digest.refused(to_hand().reach(&body, &mut small.rest().clone(), &goals[0]));
    digest.value()
}

fn aims() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(122));
    let body = arm();
    let hand = bone(&body, "hand");
    let aim = || Aim::new(&body, hand, Vec3A::new(2.0, 0.1, 0.0)).unwrap();
    let offset = Vec3A::new(0.05, 0.1, -0.02);
    let aims = [
        aim(),
        aim().with_up(Vec3A::Y * 3.0).unwrap(),
        aim().with_offset(offset).unwrap(),
        aim()
            .with_offset(offset)
            .unwrap()
            .with_up(Vec3A::Z)
            .unwrap(),
    ];
    for aim in &aims {
        for case in 0..20 {
            let mut pose = bent(&body, &mut random, 0.3);
            let target = match case {
                0 => body.model_from_bone(&pose, hand).unwrap().translation,
                1 => body.model_from_bone(&pose, hand).unwrap().translation + 0.01,
                2 => Vec3A::NAN,
                _ => vector(&mut random, 2.0),
            };
            let goal = AimGoal {
                up: [None, Some(Vec3A::Y), Some(Vec3A::ZERO)][case % 3],
                twist: [0.0, 0.4, f32::INFINITY, -2.0][case % 4],
                weight: [1.0, 0.5, 2.0, -1.0, f32::NAN][case % 5],
                ..AimGoal::at(target)
            };
            digest.word(aim.turn(&body, &mut pose, &goal).unwrap().into());
            digest.pose(&pose);
        }
    }
    // Straight back, where the shortest arc has any axis.
    let root = bone(&body, "hips");
    let looks = Aim::new(&body, root, Vec3A::X).unwrap();
    let mut pose = body.rest().clone();
    let back = AimGoal::at(Vec3A::new(-3.0, 1.0, 0.0));
    looks.turn(&body, &mut pose, &back).unwrap();
    digest.pose(&pose);
    let small = armature(2, &mut random);
    digest.refused(Aim::new(&small, hand, Vec3A::X));
    digest.refused(Aim::new(&body, hand, Vec3A::ZERO));
    digest.refused(aim().with_up(Vec3A::NAN));
    digest.refused(aim().with_up(Vec3A::new(-4.0, -0.2, 0.0)));
    digest.refused(aim().with_offset(Vec3A::NAN));
    digest.refused(aim().turn(&body, &mut small.rest().clone(), &back));
    digest.value()
}

fn layers() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(123));
    let body = arm();
    let skeleton = skeleton(&body);
    let [spine, hand, other] = ["spine", "hand", "bystander"].map(|name| bone(&body, name));
    let solver = || Solver::default().with_restarts(Restarts::none());
    let mut layers = [
        ReachLayer::new(&skeleton, &[hand, other, hand], solver()).unwrap(),
        ReachLayer::holding(&skeleton, &[hand], &[hand, spine, spine], solver()).unwrap(),
    ];
    for layer in &mut layers {
        let mut pose = bent(&body, &mut random, 0.3);
        assert!(layer.apply(&mut pose).unwrap().is_none());
        for case in 0..6 {
            let mut pose = bent(&body, &mut random, 0.3);
            pose.set_translation(hand, Vec3A::new(0.2, 0.05, 0.0))
                .unwrap();
            pose.set_scale(hand, Vec3A::new(1.0, 2.0, 1.0)).unwrap();
            let to = vector(&mut random, 0.8).as_dvec3().to_array();
            let weight = [1.0, 0.5, 3.0, f64::NAN, 0.2, 1.0][case];
            layer
                .set_goal(hand, [to[0], 1.5 + to[1], to[2]], weight)
                .unwrap();
            let turned = rotation(&mut random).as_dquat() * 2.0;
            let turned = Quaternion::from(turned);
            digest.debug(layer.set_rotation(spine, turned, 0.6).is_ok());
            digest.debug(layer.set_rotation(hand, turned, weight).is_ok());
            digest.debug(layer.set_goal(other, [-0.3, 1.6, 0.2], 0.7).is_ok());
            if let Some(solution) = layer.apply(&mut pose).unwrap() {
                digest.solution(solution);
            }
            digest.pose(&pose);
        }
    }
    let [first, second] = &mut layers;
    digest.refused(first.set_goal(spine, [0.0; 3], 1.0));
    digest.refused(first.set_goal(hand, [f64::NAN, 0.0, 0.0], 1.0));
    digest.refused(first.set_rotation(hand, Quaternion::from(glam::DQuat::IDENTITY), 1.0));
    let nothing = Quaternion::from(glam::DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0));
    digest.refused(second.set_rotation(spine, nothing, 1.0));
    digest.refused(ReachLayer::new(&skeleton, &[], solver()).map(|_| ()));
    let mut pose = bent(&body, &mut random, 0.1);
    for scale in [Vec3A::new(1.0, 1.0, 1.2), Vec3A::splat(-1.0)] {
        pose.set_scale(spine, scale).unwrap();
        if let Some(solution) = second.apply(&mut pose).unwrap() {
            digest.solution(solution);
        }
    }
    digest.refused(
        second
            .apply(&mut armature(2, &mut random).rest().clone())
            .map(|_| ()),
    );
    digest.value()
}

#[test]
fn of_poses_that_reach() {
    check_single(&[
        ("limbs that reach", limbs()),
        ("bones that aim", aims()),
        ("layers that reach", layers()),
    ]);
}
