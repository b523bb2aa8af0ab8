//! Promise: a limb bends in its plane, towards its pole and about its hinge, and moves without jumps.

use glam::{Quat, Vec3A};
use kinopt::animation::{Armature, LayerError, Limb, LimbGoal};
use support::armatures::{bone, rotation, vector};
use support::limbs::{END, arm, bent, joint_positions, largest_turn, limb, reachable, turn};
use support::random::Random;

#[test]
fn elbow_never_flips_at_the_upper_bone() {
    let armature = arm();
    let limb = limb(&armature);
    let mut random = Random::new(96);
    for _ in 0..50 {
        let pose = bent(&armature, &mut random);
        let before = joint_positions(&armature, &pose);
        let radius = (before.end - before.root).length();
        let direction = (before.end - before.root) / radius;
        // Circle through the end and the line of the upper bone, and slightly off that line.
        let aside = (before.mid - before.root)
            .reject_from(direction)
            .normalize();
        let aside = (aside + vector(&mut random, 0.05))
            .reject_from(direction)
            .normalize();
        let mut last = pose.clone();
        for step in 0..150 {
            let (sin, cos) = (0.02 * step as f32).sin_cos();
            let goal = LimbGoal::at(before.root + (direction * cos + aside * sin) * radius);
            let mut posed = pose.clone();
            limb.reach(&armature, &mut posed, &goal).unwrap();
            assert!(largest_turn(&last, &posed) < 0.05, "step {step}");
            last = posed;
        }
    }
}

#[test]
fn straight_limb_without_a_pole_does_not_roll() {
    let armature = arm();
    let limb = limb(&armature);
    let mut random = Random::new(97);
    for _ in 0..100 {
        let mut pose = bent(&armature, &mut random);
        let lower = armature.bone("lower").unwrap();
        pose.set_local(lower, armature.rest().local(lower).unwrap())
            .unwrap();
        let before = joint_positions(&armature, &pose);
        let direction = (before.end - before.root).normalize();
        // Next to the end, at equal distance from the root: the shortest rotation to it is 0.02 rad.
        let across = vector(&mut random, 1.0).reject_from(direction).normalize();
        let goal =
            LimbGoal::at(before.root + (direction * 0.02f32.cos() + across * 0.02f32.sin()) * 0.55);
        let mut posed = pose.clone();
        limb.reach(&armature, &mut posed, &goal).unwrap();
        assert!(largest_turn(&pose, &posed) < 0.03);
    }
}

/// Arm stretched along x, with its end 0.55 m from its root.
fn stretched(random: &mut Random) -> (Armature, kinopt::animation::Pose) {
    let armature = arm();
    let mut pose = bent(&armature, random);
    let lower = armature.bone("lower").unwrap();
    pose.set_local(lower, armature.rest().local(lower).unwrap())
        .unwrap();
    (armature, pose)
}

#[test]
fn stretched_limb_bends_about_its_hinge() {
    let mut random = Random::new(98);
    for case in 0..200 {
        let (armature, mut pose) = stretched(&mut random);
        // Noise of the animation that bends the elbow slightly backwards must not decide.
        let noise = [0.0, -0.02][case % 2];
        turn(&armature, &mut pose, "lower", Quat::from_rotation_z(noise));
        let limb = limb(&armature).with_hinge(Vec3A::Z * 3.0).unwrap();
        let goal = LimbGoal::at(reachable(&mut random, &joint_positions(&armature, &pose)));
        let mut posed = pose.clone();
        limb.reach(&armature, &mut posed, &goal).unwrap();
        assert!((joint_positions(&armature, &posed).end - goal.target).length() < 2e-5);
        let elbow = posed
            .local(armature.bone("lower").unwrap())
            .unwrap()
            .rotation;
        let elbow = (elbow * elbow.w.signum()).to_scaled_axis();
        assert!(elbow.truncate().length() < 4e-3, "{elbow}");
        assert!(elbow.z > 0.0, "{elbow}");
        // A target at a tiny distance gives a tiny change.
        let goal = LimbGoal {
            weight: 1e-4,
            ..goal
        };
        let mut posed = pose.clone();
        limb.reach(&armature, &mut posed, &goal).unwrap();
        assert!(largest_turn(&pose, &posed) < 0.05);
    }
}

/// The end is at the root, so it has no direction.
#[test]
fn folded_limb_moves_like_a_nearly_folded_one() {
    let bones = vec![
        bone("upper", None, Vec3A::ZERO),
        bone("lower", Some(0), Vec3A::X * 0.25),
    ];
    let armature = Armature::new(bones, Vec::new()).unwrap();
    let [upper, lower] = [0, 1].map(|index| armature.bone_at(index).unwrap());
    let limb = Limb::new(&armature, upper, lower, Vec3A::X * 0.25).unwrap();
    let limb = limb.with_hinge(Vec3A::Z).unwrap();
    let mut random = Random::new(101);
    for _ in 0..20 {
        let target = rotation(&mut random, 3.0) * Vec3A::X * random.within(0.1, 0.4) as f32;
        // Exactly half a turn, and a hundredth of a radian less.
        let nearly = Quat::from_rotation_z(std::f32::consts::PI - 0.01);
        let [folded, near] = [Quat::from_xyzw(0.0, 0.0, 1.0, 0.0), nearly].map(|elbow| {
            let mut pose = armature.rest().clone();
            turn(&armature, &mut pose, "lower", elbow);
            limb.reach(&armature, &mut pose, &LimbGoal::at(target))
                .unwrap();
            pose
        });
        let apart = largest_turn(&folded, &near);
        assert!(apart < 0.1, "{apart}");
    }
}

#[test]
fn twist_rotates_the_limb_about_its_target_line() {
    let armature = arm();
    let limb = limb(&armature);
    let mut random = Random::new(99);
    for case in 0..100 {
        let pose = bent(&armature, &mut random);
        let before = joint_positions(&armature, &pose);
        let plain = LimbGoal {
            pole: (case % 2 == 0).then(|| before.root + vector(&mut random, 1.0)),
            ..LimbGoal::at(reachable(&mut random, &before))
        };
        let twist = random.within(-3.0, 3.0) as f32;
        let reached = |goal: &LimbGoal| {
            let mut posed = pose.clone();
            limb.reach(&armature, &mut posed, goal).unwrap();
            joint_positions(&armature, &posed)
        };
        let untwisted = reached(&plain);
        let twisted = reached(&LimbGoal { twist, ..plain });
        let limb_direction = (plain.target - before.root).normalize();
        let about = Quat::from_axis_angle(limb_direction.into(), twist);
        let elbow = before.root + about * (untwisted.mid - before.root);
        assert!((twisted.mid - elbow).length() < 1e-4);
        assert!((twisted.end - plain.target).length() < 2e-5);
        // Half the weight gives half the twist, about the direction to the end at that weight.
        let half = LimbGoal {
            weight: 0.5,
            ..plain
        };
        let [untwisted_half, twisted_half] =
            [0.0, twist].map(|twist| reached(&LimbGoal { twist, ..half }));
        let half_direction = (untwisted_half.end - before.root).normalize();
        let about = Quat::from_axis_angle(half_direction.into(), 0.5 * twist);
        let elbow = before.root + about * (untwisted_half.mid - before.root);
        assert!((twisted_half.mid - elbow).length() < 1e-4);
        let ignored = reached(&LimbGoal {
            twist: f32::NAN,
            ..plain
        });
        assert_eq!(ignored.mid, untwisted.mid);
    }
}

#[test]
fn softened_limb_never_gets_straight() {
    let armature = arm();
    let mut random = Random::new(100);
    let pose = bent(&armature, &mut random);
    let before = joint_positions(&armature, &pose);
    let direction = rotation(&mut random, 3.0) * Vec3A::X;
    let length = 0.55;
    let distance = |limb: &Limb, target_distance: f32| {
        let mut posed = pose.clone();
        let goal = LimbGoal::at(before.root + direction * target_distance);
        limb.reach(&armature, &mut posed, &goal).unwrap();
        let end = joint_positions(&armature, &posed).end - before.root;
        assert!(end.normalize().dot(direction) > 1.0 - 1e-6);
        end.length()
    };
    let hard = limb(&armature);
    let soft = hard.with_softening(0.9).unwrap();
    // Up to nine tenths of the length nothing changes.
    assert!((distance(&soft, 0.89 * length) - 0.89 * length).abs() < 1e-5);
    // The speed is 1 on both sides of that distance; one tenth later e^-1 of the last tenth is left.
    let speed = (distance(&soft, 0.902 * length) - distance(&soft, 0.9 * length)) / 0.002 / length;
    assert!((speed - 1.0).abs() < 0.05, "{speed}");
    let left = length * (1.0 - 0.1 * (-1.0f32).exp());
    assert!((distance(&soft, length) - left).abs() < 1e-5);
    assert!((distance(&hard, length) - length).abs() < 1e-5);
    let far: Vec<f32> = (0..20)
        .map(|k| distance(&soft, length * (0.9 + 0.02 * k as f32)))
        .collect();
    assert!(far.windows(2).all(|pair| pair[0] < pair[1]));
    assert!(distance(&soft, 10.0) < length + 1e-6);
}

#[test]
fn invalid_hinges_and_softenings_are_rejected() {
    let limb = limb(&arm());
    for axis in [Vec3A::ZERO, Vec3A::NAN] {
        assert_eq!(limb.with_hinge(axis), Err(LayerError::BadHinge));
    }
    for share in [-0.1, 1.1, f32::NAN] {
        let error = limb.with_softening(share).unwrap_err().to_string();
        assert!(error.contains(&share.to_string()), "{error}");
    }
    let armature = arm();
    let upper = armature.bone("upper").unwrap();
    let lower = armature.bone("lower").unwrap();
    let infinite = Limb::new(&armature, upper, lower, END * f32::INFINITY);
    assert_eq!(infinite, Err(LayerError::BadEnd));
}
