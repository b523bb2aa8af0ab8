//! Promise: an aimed bone points at its target, upright if possible, by its weight.

use glam::{Affine3A, Quat, Vec3A};
use kinopt::animation::{Aim, AimGoal, Armature, LayerError, Pose};
use kinopt::skeleton::BoneId;
use support::armatures::{apart, difference, model_by_ancestors, rotation, vector};
use support::limbs::{arm, bent};
use support::random::Random;

/// Hand of a bent arm, and its placement in the model.
fn cases(count: usize) -> impl Iterator<Item = (Armature, BoneId, Pose, Affine3A, Random)> {
    (0..count).map(|case| {
        let mut random = Random::new(400 + case as u64);
        let armature = arm();
        let pose = bent(&armature, &mut random);
        let hand = armature.bone("hand").unwrap();
        let model = model_by_ancestors(&armature, &pose)[hand.index()];
        (armature, hand, pose, model, random)
    })
}

/// Direction that is never a coordinate axis.
fn direction(random: &mut Random) -> Vec3A {
    rotation(random, 2.0) * Vec3A::new(0.8, 0.6, 0.0)
}

fn turned(aim: &Aim, armature: &Armature, pose: &Pose, goal: &AimGoal) -> Option<(Pose, Affine3A)> {
    let mut posed = pose.clone();
    let reached = aim.turn(armature, &mut posed, goal).unwrap();
    if !reached {
        assert_eq!(&posed, pose);
        return None;
    }
    let hand = armature.bone("hand").unwrap();
    let model = model_by_ancestors(armature, &posed)[hand.index()];
    Some((posed, model))
}

#[test]
fn aim_takes_the_shortest_arc_to_the_target() {
    for (armature, hand, pose, before, mut random) in cases(200) {
        let forward = direction(&mut random);
        let target = before.translation + direction(&mut random) * random.within(0.05, 4.0) as f32;
        let aim = Aim::new(&armature, hand, forward * 3.0).unwrap();
        let goal = AimGoal::at(target);
        let (posed, after) = turned(&aim, &armature, &pose, &goal).unwrap();
        let direction = (target - before.translation).normalize();
        let points = after.transform_vector3a(forward);
        assert!(points.cross(direction).length() < 1e-5 && points.dot(direction) > 0.0);
        // The arc is as long as the angle between the two directions: no roll.
        let angle = before.transform_vector3a(forward).angle_between(direction);
        let [was, is] = [before, after].map(|m| Quat::from_mat3a(&m.matrix3));
        assert!((apart(was, is) - angle).abs() < 1e-3);
        // Half the weight gives half the rotation, and no other bone moves.
        let goal = AimGoal {
            weight: 0.5,
            ..goal
        };
        let (_, half) = turned(&aim, &armature, &pose, &goal).unwrap();
        let half = Quat::from_mat3a(&half.matrix3);
        assert!((apart(was, half) - 0.5 * angle).abs() < 1e-3);
        for index in (0..armature.bones()).filter(|&index| index != hand.index()) {
            assert_eq!(posed.rotations()[index], pose.rotations()[index]);
        }
    }
}

#[test]
fn up_axis_is_upright_then_twisted() {
    for (armature, hand, pose, before, mut random) in cases(200) {
        let (forward, up) = (direction(&mut random), Vec3A::Z);
        if forward.cross(up).length() < 0.1 {
            continue;
        }
        let target = before.translation + direction(&mut random);
        let up_direction = direction(&mut random);
        let aim = Aim::new(&armature, hand, forward)
            .unwrap()
            .with_up(up)
            .unwrap();
        let goal = AimGoal {
            up: Some(up_direction * 5.0),
            ..AimGoal::at(target)
        };
        let (_, after) = turned(&aim, &armature, &pose, &goal).unwrap();
        let aim_direction = (target - before.translation).normalize();
        assert!(
            after
                .transform_vector3a(forward)
                .cross(aim_direction)
                .length()
                < 1e-5
        );
        let across = |v: Vec3A| v.reject_from(aim_direction).normalize();
        if up_direction.cross(aim_direction).length() > 0.05 {
            let is = across(after.transform_vector3a(up));
            assert!(is.dot(across(up_direction)) > 1.0 - 1e-5);
        }
        let twist = random.within(-3.0, 3.0) as f32;
        let goal = AimGoal { twist, ..goal };
        let (_, twisted) = turned(&aim, &armature, &pose, &goal).unwrap();
        let about = Quat::from_axis_angle(aim_direction.into(), twist);
        let expected = about * after.transform_vector3a(up);
        assert!((twisted.transform_vector3a(up) - expected).length() < 1e-5);
    }
}

#[test]
fn line_from_an_offset_passes_the_target() {
    let mut short = 0;
    for (armature, hand, pose, before, mut random) in cases(300) {
        let (forward, offset) = (direction(&mut random), vector(&mut random, 0.3));
        let target = before.translation + direction(&mut random) * random.within(0.02, 2.0) as f32;
        let aim = Aim::new(&armature, hand, forward).unwrap();
        let aim = aim.with_offset(offset).unwrap();
        let after = turned(&aim, &armature, &pose, &AimGoal::at(target));
        let Some((_, after)) = after else {
            // No point of the ray is that near to the joint.
            let distance = (target - before.translation).length();
            let ahead = (-offset.dot(forward)).max(0.0);
            assert!((offset + forward * ahead).length() > distance - 1e-5);
            short += 1;
            continue;
        };
        let from = after.transform_point3a(offset);
        let points = after.transform_vector3a(forward);
        let direction = target - from;
        assert!(points.cross(direction).length() < 2e-5 && points.dot(direction) > -1e-5);
    }
    assert!((1..150).contains(&short), "{short}");
}

#[test]
fn scaled_bone_aims_from_its_offset() {
    for (armature, hand, mut pose, _, mut random) in cases(100) {
        // One scale above the bone and one on the bone itself.
        for bone in [armature.bone("hips").unwrap(), hand] {
            let mut local = pose.local(bone).unwrap();
            local.scale = Vec3A::splat(random.within(0.3, 3.0) as f32);
            pose.set_local(bone, local).unwrap();
        }
        let before = model_by_ancestors(&armature, &pose)[hand.index()];
        let (forward, offset) = (direction(&mut random), vector(&mut random, 0.1));
        let target = before.translation + direction(&mut random) * 4.0;
        let aim = Aim::new(&armature, hand, forward).unwrap();
        let aim = aim.with_offset(offset).unwrap();
        let (_, after) = turned(&aim, &armature, &pose, &AimGoal::at(target)).unwrap();
        let direction = target - after.transform_point3a(offset);
        let points = after.transform_vector3a(forward).normalize();
        assert!(points.cross(direction).length() < 2e-5 && points.dot(direction) > 0.0);
    }
}

#[test]
fn zero_weight_and_nan_change_nothing() {
    for (armature, hand, pose, before, _) in cases(10) {
        let aim = Aim::new(&armature, hand, Vec3A::X).unwrap();
        let target = before.translation + Vec3A::Y;
        for weight in [0.0, -1.0, f32::NAN] {
            let mut posed = pose.clone();
            let goal = AimGoal {
                weight,
                ..AimGoal::at(target)
            };
            assert!(aim.turn(&armature, &mut posed, &goal).unwrap());
            assert_eq!(posed, pose);
        }
        for target in [Vec3A::NAN, Vec3A::INFINITY] {
            assert!(turned(&aim, &armature, &pose, &AimGoal::at(target)).is_none());
        }
        let plain = turned(&aim, &armature, &pose, &AimGoal::at(target))
            .unwrap()
            .0;
        let goal = AimGoal {
            up: Some(Vec3A::NAN),
            twist: f32::NAN,
            ..AimGoal::at(target)
        };
        let upright = aim.with_up(Vec3A::Z).unwrap();
        let posed = turned(&upright, &armature, &pose, &goal).unwrap().0;
        assert!(difference(&posed, &plain) < 1e-6);
        // Opposite directions have no unique shortest arc, but a rotation is found.
        let behind = before.translation - before.transform_vector3a(Vec3A::X);
        let (_, after) = turned(&aim, &armature, &pose, &AimGoal::at(behind)).unwrap();
        assert!((after.matrix3.x_axis + before.matrix3.x_axis).length() < 1e-3);
    }
}

#[test]
fn invalid_aims_are_named() {
    let armature = arm();
    let hand = armature.bone("hand").unwrap();
    let other = support::armatures::armature(30, &mut Random::new(1));
    let stranger = Aim::new(&armature, other.bone_at(29).unwrap(), Vec3A::X);
    assert_eq!(
        stranger,
        Err(LayerError::UnknownBone { bone: 29, bones: 7 })
    );
    let axis = "forward";
    for forward in [Vec3A::ZERO, Vec3A::NAN] {
        assert_eq!(
            Aim::new(&armature, hand, forward),
            Err(LayerError::BadAxis { axis })
        );
    }
    let aim = Aim::new(&armature, hand, Vec3A::X).unwrap();
    assert_eq!(aim.with_up(Vec3A::X * -2.0), Err(LayerError::UpIsForward));
    assert_eq!(
        aim.with_up(Vec3A::ZERO),
        Err(LayerError::BadAxis { axis: "up" })
    );
    assert_eq!(aim.with_offset(Vec3A::NAN), Err(LayerError::BadOffset));
    let mut foreign = other.rest().clone();
    assert!(
        aim.turn(&armature, &mut foreign, &AimGoal::at(Vec3A::X))
            .is_err()
    );
}
