//! Promise: a limb over an animated pose brings its end to its target by its weight, and changes nothing else.

use glam::{Quat, Vec3A};
use kinopt::animation::{LayerError, Limb, LimbGoal};
use support::armatures::{difference, rotation, vector};
use support::limbs::{END, JointPositions, arm, bent, joint_positions, limb, reachable};
use support::random::Random;

#[test]
fn end_moves_by_its_weight_and_hinge_is_kept() {
    let armature = arm();
    let limb = limb(&armature);
    let mut random = Random::new(91);
    for _ in 0..300 {
        let pose = bent(&armature, &mut random);
        let before = joint_positions(&armature, &pose);
        let target = reachable(&mut random, &before);
        for weight in [1.0, 0.5, 0.1] {
            let mut posed = pose.clone();
            let goal = LimbGoal {
                weight,
                ..LimbGoal::at(target)
            };
            limb.reach(&armature, &mut posed, &goal).unwrap();
            let after = joint_positions(&armature, &posed);
            let mut share = before.end + (target - before.end) * weight;
            // On the straight segment the weighted target may be nearer to the root than the bones can fold.
            let distance = (share - before.root).length();
            if distance < 0.05 {
                share = before.root + (share - before.root) * (0.05 / distance);
            }
            assert!((after.end - share).length() < 2e-5, "{weight}");
            // The elbow rotates about its hinge only, and every other bone is unchanged.
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
fn zero_weight_and_nan_change_nothing() {
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
    // A target at the current end moves nothing but by rounding.
    let target = joint_positions(&armature, &pose).end;
    let mut posed = pose.clone();
    let goal = LimbGoal::at(target);
    limb(&armature).reach(&armature, &mut posed, &goal).unwrap();
    assert!(difference(&posed, &pose) < 2e-3);
    // A small weight gives a small change, also with a pole far from the elbow.
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
fn unreachable_target_stretches_the_limb() {
    let armature = arm();
    let mut random = Random::new(93);
    for _ in 0..50 {
        let pose = bent(&armature, &mut random);
        let before = joint_positions(&armature, &pose);
        let direction = rotation(&mut random, 3.0) * Vec3A::X;
        let mut posed = pose.clone();
        let goal = LimbGoal::at(before.root + direction * 7.0);
        limb(&armature).reach(&armature, &mut posed, &goal).unwrap();
        let after = joint_positions(&armature, &posed);
        assert!((after.end - (before.root + direction * 0.55)).length() < 1e-4);
        assert!(posed.rotations().iter().all(|q| q.is_normalized()));
    }
}

#[test]
fn elbow_moves_towards_the_pole() {
    let armature = arm();
    let mut random = Random::new(94);
    for case in 0..200 {
        let mut pose = bent(&armature, &mut random);
        if case % 2 == 0 {
            let lower = armature.bone("lower").unwrap();
            pose.set_local(lower, armature.rest().local(lower).unwrap())
                .unwrap();
        }
        let before = joint_positions(&armature, &pose);
        let target = reachable(&mut random, &before);
        let pole = before.root + vector(&mut random, 1.0);
        let mut posed = pose.clone();
        let goal = LimbGoal {
            pole: Some(pole),
            ..LimbGoal::at(target)
        };
        limb(&armature).reach(&armature, &mut posed, &goal).unwrap();
        let after = joint_positions(&armature, &posed);
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
fn invalid_limb_bones_are_named() {
    let armature = arm();
    let bone = |name| armature.bone(name).unwrap();
    let error = Limb::new(&armature, bone("lower"), bone("upper"), END).unwrap_err();
    assert!(error.to_string().contains("`upper`") && error.to_string().contains("`lower`"));
    assert!(Limb::new(&armature, bone("upper"), bone("upper"), END).is_err());
    assert!(Limb::new(&armature, bone("bystander"), bone("lower"), END).is_err());
    let invalid = Limb::new(&armature, bone("upper"), bone("lower"), Vec3A::NAN).unwrap_err();
    assert_eq!(invalid, LayerError::BadEnd);
    let mut random = Random::new(95);
    let other = support::armatures::armature(30, &mut random);
    let stranger = other.bone_at(29).unwrap();
    let error = Limb::new(&armature, bone("upper"), stranger, END).unwrap_err();
    assert_eq!(error, LayerError::UnknownBone { bone: 29, bones: 7 });
}

/// Without a pole, the bend follows the direction to the end by the shortest rotation.
#[test]
fn bend_follows_by_the_shortest_rotation() {
    let armature = arm();
    let limb = limb(&armature);
    let mut random = Random::new(97);
    let mut large_turns = 0;
    for _ in 0..60 {
        let pose = bent(&armature, &mut random);
        let before = joint_positions(&armature, &pose);
        let target = reachable(&mut random, &before);
        let mut posed = pose.clone();
        let goal = LimbGoal::at(target);
        limb.reach(&armature, &mut posed, &goal).unwrap();
        let after = joint_positions(&armature, &posed);
        let across = |positions: &JointPositions| {
            (positions.mid - positions.root).cross(positions.end - positions.root)
        };
        let [old, new] =
            [&before, &after].map(|positions| (positions.end - positions.root).normalize());
        if old.dot(new) < -0.9 || across(&after).length() < 1e-3 {
            continue;
        }
        let turn = Quat::from_rotation_arc(old.into(), new.into());
        let carried = turn * across(&before).normalize();
        let apart = (across(&after).normalize() - carried).length();
        assert!(apart < 1e-3, "{apart}");
        large_turns += usize::from(old.dot(new) < 0.5);
    }
    assert!(large_turns > 10, "{large_turns}");
}
