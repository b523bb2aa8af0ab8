//! Promise: the bone at the end of a limb has the goal's rotation, by its own weight.

use glam::{Quat, Vec3A};
use kinopt::animation::{Armature, EndRotation, LayerError, Limb, LimbGoal, Pose};
use support::armatures::{apart, model_by_ancestors, rotation};
use support::fault_tables::ExpectedError;
use support::limbs::{arm, bent, joint_positions, limb, reachable, turn};
use support::random::Random;

fn to_hand(armature: &Armature) -> Limb {
    let [upper, lower, hand] = ["upper", "lower", "hand"].map(|name| armature.bone(name).unwrap());
    Limb::to_bone(armature, upper, lower, hand).unwrap()
}

/// Rotation of the hand in the model, from the matrices along its ancestors.
fn hand(armature: &Armature, pose: &Pose) -> Quat {
    let model = model_by_ancestors(armature, pose);
    let hand = armature.bone("hand").unwrap();
    Quat::from_mat3a(&model[hand.index()].matrix3)
}

fn reached(armature: &Armature, pose: &Pose, goal: &LimbGoal) -> Pose {
    let mut posed = pose.clone();
    to_hand(armature).reach(armature, &mut posed, goal).unwrap();
    posed
}

/// The arm in a pose with a rotated hand, and a goal for it.
fn cases() -> impl Iterator<Item = (Armature, Pose, LimbGoal, Quat)> {
    let mut random = Random::new(71);
    (0..100).map(move |_| {
        let armature = arm();
        let mut pose = bent(&armature, &mut random);
        turn(&armature, &mut pose, "hand", rotation(&mut random, 1.5));
        let target = reachable(&mut random, &joint_positions(&armature, &pose));
        let goal = LimbGoal {
            weight: random.within(0.0, 1.0) as f32,
            ..LimbGoal::at(target)
        };
        (armature, pose, goal, rotation(&mut random, 1.5))
    })
}

#[test]
fn limb_to_a_bone_brings_it_to_the_target() {
    for (armature, mut pose, goal, _) in cases() {
        let goal = LimbGoal {
            weight: 1.0,
            ..goal
        };
        let same = reached(&armature, &pose, &goal);
        let mut by_point = pose.clone();
        limb(&armature)
            .reach(&armature, &mut by_point, &goal)
            .unwrap();
        assert_eq!(same, by_point);
        // A hand that the clip moved relative to the forearm keeps that position, not its rest position.
        let bone = armature.bone("hand").unwrap();
        let mut local = pose.local(bone).unwrap();
        local.translation += Vec3A::new(0.02, 0.01, -0.03);
        pose.set_local(bone, local).unwrap();
        let posed = reached(&armature, &pose, &goal);
        let at = model_by_ancestors(&armature, &posed)[bone.index()].translation;
        assert!((at - goal.target).length() < 1e-4);
    }
}

#[test]
fn held_end_keeps_its_rotation() {
    for (armature, pose, goal, _) in cases() {
        let end = EndRotation::Hold { weight: 1.0 };
        let posed = reached(&armature, &pose, &LimbGoal { end, ..goal });
        assert!(apart(hand(&armature, &posed), hand(&armature, &pose)) < 2e-5);
        // The rest of the arm moves as without the rotation goal.
        let followed = reached(&armature, &pose, &goal);
        let same = |name: &str| {
            let bone = armature.bone(name).unwrap();
            posed.local(bone).unwrap() == followed.local(bone).unwrap()
        };
        assert!(["upper", "twist", "lower", "bystander"].map(same) == [true; 4]);
    }
}

#[test]
fn end_goal_rotates_by_its_weight() {
    for (armature, pose, goal, target_rotation) in cases() {
        let followed = hand(&armature, &reached(&armature, &pose, &goal));
        let angle = apart(followed, target_rotation);
        for weight in [0.25, 0.5, 1.0] {
            // The negative quaternion, or one of another length, is the same rotation.
            let rotation = target_rotation * if weight == 0.5 { -3.0 } else { 1.0 };
            let end = EndRotation::Goal { rotation, weight };
            let posed = reached(&armature, &pose, &LimbGoal { end, ..goal });
            let turned = hand(&armature, &posed);
            assert!((apart(followed, turned) - weight * angle).abs() < 1e-4);
            assert!((apart(turned, target_rotation) - (1.0 - weight) * angle).abs() < 1e-4);
            // With a position weight of zero, the hand rotates and the arm does not move.
            let still = LimbGoal {
                end: EndRotation::Goal {
                    rotation,
                    weight: 1.0,
                },
                weight: 0.0,
                ..goal
            };
            let posed = reached(&armature, &pose, &still);
            assert!(apart(hand(&armature, &posed), target_rotation) < 2e-5);
            assert_eq!(posed.rotations()[..5], pose.rotations()[..5]);
        }
    }
}

#[test]
fn end_without_goal_follows_the_lower_bone() {
    let not = Quat::from_xyzw(0.0, 0.0, 0.0, 0.0);
    for (armature, pose, goal, rotation) in cases().take(20) {
        let followed = reached(&armature, &pose, &goal);
        let bone = armature.bone("hand").unwrap();
        assert_eq!(followed.local(bone).unwrap(), pose.local(bone).unwrap());
        let ends = [
            EndRotation::Hold { weight: 0.0 },
            EndRotation::Hold { weight: f32::NAN },
            EndRotation::Goal {
                rotation,
                weight: -1.0,
            },
            EndRotation::Goal {
                rotation: not,
                weight: 1.0,
            },
            EndRotation::Goal {
                rotation: Quat::NAN,
                weight: 1.0,
            },
        ];
        for end in ends {
            let posed = reached(&armature, &pose, &LimbGoal { end, ..goal });
            assert_eq!(posed, followed, "{end:?}");
        }
    }
}

#[test]
fn end_outside_the_limb_is_named() {
    let armature = arm();
    let bone = |name| armature.bone(name).unwrap();
    let error = Limb::to_bone(&armature, bone("upper"), bone("lower"), bone("bystander"));
    error.says("`bystander` | `lower`");
    let swapped = Limb::to_bone(&armature, bone("lower"), bone("upper"), bone("hand"));
    assert!(matches!(swapped, Err(LayerError::NotAbove { .. })));
}
