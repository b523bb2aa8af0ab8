//! Promise: inverse kinematics over an animated pose brings ends where they were asked, by their
//! weights, and leaves everything else alone.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use glam::{Affine3A, Quat, Vec3, Vec3A};
use kinopt::Solver;
use kinopt::animation::{Armature, Limb, LimbError, LimbGoal, Pose, PoseBridge, ReachLayer};
use kinopt::skeleton::BoneId;
use support::armatures::{apart, difference, model_by_ancestors, rotation, vector};
use support::bones::RandomRig;
use support::limbs::{END, arm, bent, limb, places, reachable};
use support::random::Random;

#[test]
fn the_end_goes_its_share_of_the_way_and_a_hinge_stays_one() {
    let armature = arm();
    let limb = limb(&armature);
    let mut random = Random::new(91);
    for _ in 0..300 {
        let pose = bent(&armature, &mut random);
        let before = places(&armature, &pose);
        let target = reachable(&mut random, &before);
        for weight in [1.0, 0.5, 0.1] {
            let mut posed = pose.clone();
            let goal = LimbGoal {
                weight,
                ..LimbGoal::at(target)
            };
            limb.reach(&armature, &mut posed, &goal).unwrap();
            let after = places(&armature, &posed);
            let mut share = before.end + (target - before.end) * weight;
            // On the straight way the share may come nearer to the root than the bones fold.
            let distance = (share - before.root).length();
            if distance < 0.05 {
                share = before.root + (share - before.root) * (0.05 / distance);
            }
            assert!((after.end - share).length() < 2e-5, "{weight}");
            // The elbow turned about its hinge only, and every other bone is as it was.
            for (index, name) in armature.names().iter().enumerate() {
                let (was, is) = (pose.rotations()[index], posed.rotations()[index]);
                match name.as_str() {
                    "upper" => {}
                    "lower" => assert!(is.xyz().truncate().length() < 2e-3, "{is}"),
                    _ => assert_eq!(was, is),
                }
            }
            assert_eq!(pose.translations(), posed.translations());
        }
    }
}

#[test]
fn weight_zero_and_nonsense_change_nothing() {
    let armature = arm();
    let mut random = Random::new(92);
    let pose = bent(&armature, &mut random);
    let target = Vec3A::new(0.3, 1.4, 0.2);
    let goals = [
        (target, 0.0),
        (target, -1.0),
        (target, f32::NAN),
        (Vec3A::NAN, 1.0),
    ];
    for (target, weight) in goals {
        let mut posed = pose.clone();
        let goal = LimbGoal {
            weight,
            ..LimbGoal::at(target)
        };
        limb(&armature).reach(&armature, &mut posed, &goal).unwrap();
        assert_eq!(posed, pose);
    }
    // A target where the end is moves nothing but by rounding.
    let target = places(&armature, &pose).end;
    let mut posed = pose.clone();
    let goal = LimbGoal::at(target);
    limb(&armature).reach(&armature, &mut posed, &goal).unwrap();
    assert!(difference(&posed, &pose) < 2e-3);
    // A small weight is a small change, with a pole far from the elbow as well.
    let pole = Some(Vec3A::new(-3.0, -1.0, 2.0));
    let goal = LimbGoal {
        pole,
        weight: 1e-4,
        ..LimbGoal::at(target)
    };
    let mut posed = pose.clone();
    limb(&armature).reach(&armature, &mut posed, &goal).unwrap();
    assert!(difference(&posed, &pose) < 1e-2);
}

#[test]
fn out_of_reach_it_stretches_towards_the_target() {
    let armature = arm();
    let mut random = Random::new(93);
    for _ in 0..50 {
        let pose = bent(&armature, &mut random);
        let before = places(&armature, &pose);
        let direction = rotation(&mut random, 3.0) * Vec3A::X;
        let mut posed = pose.clone();
        let goal = LimbGoal::at(before.root + direction * 7.0);
        limb(&armature).reach(&armature, &mut posed, &goal).unwrap();
        let after = places(&armature, &posed);
        assert!((after.end - (before.root + direction * 0.55)).length() < 1e-4);
        assert!(posed.rotations().iter().all(|q| q.is_normalized()));
    }
}

#[test]
fn the_elbow_goes_towards_the_pole_from_a_straight_arm_too() {
    let armature = arm();
    let mut random = Random::new(94);
    for case in 0..200 {
        let mut pose = bent(&armature, &mut random);
        if case % 2 == 0 {
            let lower = armature.bone("lower").unwrap();
            pose.set_local(lower, armature.rest().local(lower));
        }
        let before = places(&armature, &pose);
        let target = reachable(&mut random, &before);
        let pole = before.root + vector(&mut random, 1.0);
        let mut posed = pose.clone();
        let goal = LimbGoal {
            pole: Some(pole),
            ..LimbGoal::at(target)
        };
        limb(&armature).reach(&armature, &mut posed, &goal).unwrap();
        let after = places(&armature, &posed);
        assert!((after.end - target).length() < 2e-5);
        let along = (target - after.root).normalize();
        let across = |p: Vec3A| (p - after.root) - along * (p - after.root).dot(along);
        let [elbow, pole] = [across(after.mid), across(pole)];
        if elbow.length() > 0.02 && pole.length() > 0.05 {
            assert!(elbow.normalize().dot(pole.normalize()) > 1.0 - 1e-3);
        }
    }
}

#[test]
fn bones_that_are_no_limb_are_named() {
    let armature = arm();
    let bone = |name| armature.bone(name).unwrap();
    let error = Limb::new(&armature, bone("lower"), bone("upper"), END).unwrap_err();
    assert!(error.to_string().contains("`upper`") && error.to_string().contains("`lower`"));
    assert!(Limb::new(&armature, bone("upper"), bone("upper"), END).is_err());
    assert!(Limb::new(&armature, bone("bystander"), bone("lower"), END).is_err());
    let bad = Limb::new(&armature, bone("upper"), bone("lower"), Vec3A::NAN).unwrap_err();
    assert_eq!(bad, LimbError::BadEnd);
    let mut random = Random::new(95);
    let other = support::armatures::armature(30, &mut random);
    let stranger = other.bone_at(29).unwrap();
    let error = Limb::new(&armature, bone("upper"), stranger, END).unwrap_err();
    assert_eq!(error, LimbError::UnknownBone { bone: 29, bones: 7 });
}

#[test]
fn angles_and_local_rotations_are_the_same_pose() {
    for seed in 0..20 {
        let skeleton = RandomRig::new(seed).skeleton;
        let (armature, bridge) = (Armature::of_skeleton(&skeleton), PoseBridge::new(&skeleton));
        let mut random = Random::new(seed);
        let limits: Vec<_> = skeleton.model().limits().collect();
        let q: Vec<f64> = limits
            .iter()
            .map(|l| random.within(l.lower, l.upper))
            .collect();
        let mut pose = armature.rest().clone();
        bridge.pose_of(&q, &mut pose);
        let mut model = vec![Affine3A::IDENTITY; armature.bones()];
        armature.local_to_model(&pose, &mut model).unwrap();
        let posed = skeleton.pose(&q);
        for (bone, model) in skeleton.bone_ids().zip(&model) {
            let tip = Vec3::from(posed.tip(&skeleton, bone).to_array().map(|x| x as f32));
            let along = Vec3::X * skeleton.bones()[bone.index()].length as f32;
            assert!((model.transform_point3(along) - tip).length() < 2e-4);
        }
        let mut back = vec![f64::NAN; q.len()];
        bridge.angles_of(&pose, &mut back);
        let mut again = armature.rest().clone();
        bridge.pose_of(&back, &mut again);
        assert!(difference(&pose, &again) < 1e-5);
        // Of the ways to write a rotation, one within the limits.
        for (angle, limits) in back.iter().zip(&limits) {
            assert!(
                limits.lower - 2e-3 <= *angle && *angle <= limits.upper + 2e-3,
                "{angle}"
            );
        }
    }
}

fn tip(armature: &Armature, rig: &RandomRig, pose: &Pose, bone: BoneId) -> Vec3A {
    let mut model = vec![Affine3A::IDENTITY; armature.bones()];
    armature.local_to_model(pose, &mut model).unwrap();
    let along = Vec3A::X * rig.skeleton.bones()[bone.index()].length as f32;
    model[bone.index()].transform_point3a(along)
}

#[test]
fn the_optimiser_brings_several_tips_their_shares_of_the_way() {
    let mut reached = 0;
    for seed in 0..8 {
        let rig = RandomRig::new(100 + seed);
        let (skeleton, tips) = (&rig.skeleton, &rig.tips[..2]);
        let (armature, bridge) = (Armature::of_skeleton(skeleton), PoseBridge::new(skeleton));
        let mut random = Random::new(seed);
        let limits: Vec<_> = skeleton.model().limits().collect();
        let within = |random: &mut Random, low: f64, high: f64| -> Vec<f64> {
            let angle = |l: &kinopt::model::Limits| {
                l.lower + (l.upper - l.lower) * random.within(low, high)
            };
            limits.iter().map(angle).collect()
        };
        let clip = within(&mut random, 0.4, 0.6);
        let goal = within(&mut random, 0.35, 0.65);
        let (mut pose, mut there) = (armature.rest().clone(), armature.rest().clone());
        bridge.pose_of(&clip, &mut pose);
        bridge.pose_of(&goal, &mut there);
        let mut layer = ReachLayer::new(skeleton, tips, Solver::default()).unwrap();
        let mut untouched = pose.clone();
        assert!(layer.apply(&mut untouched).unwrap().is_none());
        assert_eq!(untouched, pose);

        let weights = [1.0, 0.5];
        let wanted = [0, 1].map(|k| {
            let [from, to] = [&pose, &there].map(|pose| tip(&armature, &rig, pose, tips[k]));
            let target = skeleton.pose(&goal).tip(skeleton, tips[k]);
            layer.set_goal(tips[k], target, weights[k]).unwrap();
            from + (to - from) * weights[k] as f32
        });
        let mut posed = pose.clone();
        let solution = layer.apply(&mut posed).unwrap().unwrap();
        if solution.reached {
            reached += 1;
            for (k, wanted) in wanted.into_iter().enumerate() {
                assert!((tip(&armature, &rig, &posed, tips[k]) - wanted).length() < 1e-4);
            }
        }
        // Bones that no tip hangs on stay as the clip has them.
        let moves = |index: usize| {
            tips.iter().any(|&tip| {
                let mut next = Some(tip);
                while next.is_some_and(|bone| bone.index() != index) {
                    next = next.and_then(|bone| armature.parent(bone));
                }
                next.is_some()
            })
        };
        for index in (0..armature.bones()).filter(|&index| !moves(index)) {
            assert_eq!(pose.rotations()[index], posed.rotations()[index]);
        }
        let stranger = rig.tips[4];
        let error = layer.set_goal(stranger, [0.0; 3].into(), 1.0).unwrap_err();
        assert_eq!(error.effectors.len(), 2);
    }
    assert!(reached >= 6, "{reached} of 8");
}

#[test]
fn the_optimiser_holds_bones_and_turns_them_by_their_weights() {
    let mut reached = [0; 3];
    for seed in 0..8 {
        let rig = RandomRig::new(200 + seed);
        let (skeleton, tips) = (&rig.skeleton, &rig.tips[..2]);
        let (armature, bridge) = (Armature::of_skeleton(skeleton), PoseBridge::new(skeleton));
        let mut random = Random::new(seed);
        let within = |random: &mut Random, low: f64, high: f64| -> Vec<f64> {
            let limits = skeleton.model().limits();
            limits
                .map(|l| l.lower + (l.upper - l.lower) * random.within(low, high))
                .collect()
        };
        let (mut pose, mut there) = (armature.rest().clone(), armature.rest().clone());
        bridge.pose_of(&within(&mut random, 0.45, 0.55), &mut pose);
        bridge.pose_of(&within(&mut random, 0.4, 0.6), &mut there);
        let turned = |pose: &Pose, bone: BoneId| {
            Quat::from_mat3a(&model_by_ancestors(&armature, pose)[bone.index()].matrix3)
        };
        let [moves, still] = [tips[0], tips[1]];
        let mut layer = ReachLayer::holding(skeleton, tips, tips, Solver::default()).unwrap();
        for (case, weight) in [0.0, 0.5, 1.0].into_iter().enumerate() {
            let mut posed = pose.clone();
            let target = tip(&armature, &rig, &there, moves);
            let from = tip(&armature, &rig, &pose, moves);
            let near = (from + (target - from) * weight).to_array().map(f64::from);
            // With weight 0 a small way, and held.
            let near = if case == 0 {
                near.map(|x| x + 0.005)
            } else {
                near
            };
            layer.set_goal(moves, near.into(), 1.0).unwrap();
            let wanted = turned(&there, moves);
            layer
                .set_rotation(moves, wanted * -2.0, f64::from(weight))
                .unwrap();
            if !layer.apply(&mut posed).unwrap().unwrap().reached {
                continue;
            }
            reached[case] += 1;
            let [was, is] = [&pose, &posed].map(|pose| turned(pose, moves));
            let way = apart(was, wanted);
            assert!((apart(was, is) - weight * way).abs() < 1e-4);
            assert!((apart(is, wanted) - (1.0 - weight) * way).abs() < 1e-4);
            // The other end is held where it was.
            assert!(apart(turned(&pose, still), turned(&posed, still)) < 1e-4);
        }
        let stranger = rig.tips[4];
        let error = layer
            .set_rotation(stranger, Quat::IDENTITY, 1.0)
            .unwrap_err();
        assert_eq!(error.effectors.len(), 2);
        // No rotation at all is as good as none asked for.
        let applied = |layer: &mut ReachLayer, rotation: Quat, weight: f64| {
            layer.set_rotation(moves, rotation, weight).unwrap();
            let mut posed = pose.clone();
            layer.apply(&mut posed).unwrap();
            posed
        };
        let held = applied(&mut layer, Quat::IDENTITY, 0.0);
        for none in [Quat::NAN, Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)] {
            assert_eq!(applied(&mut layer, none, 1.0), held);
        }
    }
    assert!(reached.iter().all(|&count| count >= 6), "{reached:?} of 8");
}
