//! Promise: a reach layer over animated poses brings tips and pinned bones to their targets by their weights, and
//! leaves every other bone exactly unchanged.

use glam::{Affine3A, Quat, Vec3, Vec3A};
use kinopt::animation::{
    Armature, ArmatureBone, EulerPoseMap, LayerError, LocalTransform, Pose, ReachLayer,
};
use kinopt::model::Limits;
use kinopt::problem::ProblemError;
use kinopt::skeleton::{Bone, BoneId};
use kinopt::spatial::Placement;
use kinopt::{Skeleton, Solver};
use support::armatures::{apart, difference, model_by_ancestors};
use support::bones::RandomRig;
use support::random::Random;

#[test]
fn angles_and_local_rotations_agree() {
    for seed in 0..20 {
        let skeleton = RandomRig::new(seed).skeleton;
        let (armature, bridge) = (
            Armature::of_skeleton(&skeleton),
            EulerPoseMap::new(&skeleton),
        );
        let mut random = Random::new(seed);
        let limits: Vec<_> = skeleton.model().limits().collect();
        let q: Vec<f64> = limits
            .iter()
            .map(|l| random.within(l.lower, l.upper))
            .collect();
        let mut pose = armature.rest().clone();
        bridge.pose_of(&q, &mut pose).unwrap();
        let mut model = vec![Affine3A::IDENTITY; armature.bones()];
        armature.local_to_model(&pose, &mut model).unwrap();
        let posed = skeleton.pose(&q).unwrap();
        for (bone, model) in skeleton.bone_ids().zip(&model) {
            let tip = Vec3::from(
                posed
                    .tip(&skeleton, bone)
                    .unwrap()
                    .to_array()
                    .map(|x| x as f32),
            );
            let along = Vec3::X * skeleton.bones()[bone.index()].length as f32;
            assert!((model.transform_point3(along) - tip).length() < 2e-4);
        }
        let mut back = vec![f64::NAN; q.len()];
        bridge.angles_of(&pose, &mut back).unwrap();
        let mut again = armature.rest().clone();
        bridge.pose_of(&back, &mut again).unwrap();
        assert!(difference(&pose, &again) < 1e-5);
        // Of the angles that give a rotation, those within the limits are chosen. Where single precision loses a bend,
        // only the sum of both twists is defined.
        for (angles, limits) in back.chunks(3).zip(limits.chunks(3)) {
            let lower: Vec<f64> = limits.iter().map(|l| l.lower).collect();
            let upper: Vec<f64> = limits.iter().map(|l| l.upper).collect();
            let within = |angle: f64, [low, high]: [f64; 2]| {
                assert!(
                    low - 2e-3 <= angle && angle <= high + 2e-3,
                    "{angles:?} {limits:?}"
                );
            };
            within(angles[1], [lower[1], upper[1]]);
            if angles[1].abs() < 1e-6 {
                let sums = [&lower, &upper].map(|ends| ends[0] + ends[2]);
                within(angles[0] + angles[2], sums);
            } else {
                within(angles[0], [lower[0], upper[0]]);
                within(angles[2], [lower[2], upper[2]]);
            }
        }
    }
}

/// Also if 0 is outside of a bone's range, on either side.
#[test]
fn angles_are_chosen_within_limits() {
    let mut random = Random::new(44);
    for case in 0..300 {
        let about = |middle: f64, half: f64| Limits::new(middle - half, middle + half);
        let sign = |bit: u32| if case >> bit & 1 == 0 { 1.0 } else { -1.0 };
        let limits = [
            about(2.4 * sign(0), 0.5),
            about(0.9 * sign(1), 0.6),
            about(1.7 * sign(2), 0.5),
        ];
        let mut builder = Skeleton::builder("bone");
        builder.add(Bone {
            name: "bone".into(),
            parent: None,
            length: 1.0,
            model_from_rest: Placement::identity(),
            limits,
        });
        let skeleton = builder.build().unwrap();
        let bridge = EulerPoseMap::new(&skeleton);
        let q = limits.map(|limits| random.within(limits.lower, limits.upper));
        let mut pose = Armature::of_skeleton(&skeleton).rest().clone();
        bridge.pose_of(&q, &mut pose).unwrap();
        let mut back = [0.0; 3];
        bridge.angles_of(&pose, &mut back[..]).unwrap();
        for (back, q) in back.iter().zip(&q) {
            assert!((back - q).abs() < 1e-4, "{back} {q} {limits:?}");
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
fn reach_layer_moves_tips_by_their_weights() {
    let mut reached = 0;
    for seed in 0..8 {
        let rig = RandomRig::new(100 + seed);
        let (skeleton, tips) = (&rig.skeleton, &rig.tips[..2]);
        let (armature, bridge) = (Armature::of_skeleton(skeleton), EulerPoseMap::new(skeleton));
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
        let (mut pose, mut goal_pose) = (armature.rest().clone(), armature.rest().clone());
        bridge.pose_of(&clip, &mut pose).unwrap();
        bridge.pose_of(&goal, &mut goal_pose).unwrap();
        let mut layer = ReachLayer::new(skeleton, tips, Solver::default()).unwrap();
        let mut untouched = pose.clone();
        assert!(layer.apply(&mut untouched).unwrap().is_none());
        assert_eq!(untouched, pose);

        let weights = [1.0, 0.5];
        let targets = [0, 1].map(|k| {
            let [from, to] = [&pose, &goal_pose].map(|pose| tip(&armature, &rig, pose, tips[k]));
            let target = skeleton
                .pose(&goal)
                .unwrap()
                .tip(skeleton, tips[k])
                .unwrap();
            layer.set_goal(tips[k], target, weights[k]).unwrap();
            from + (to - from) * weights[k] as f32
        });
        let mut posed = pose.clone();
        let solution = layer.apply(&mut posed).unwrap().unwrap();
        if solution.reached {
            reached += 1;
            for (k, target) in targets.into_iter().enumerate() {
                assert!((tip(&armature, &rig, &posed, tips[k]) - target).length() < 1e-4);
            }
        }
        // Bones without a tip below them stay as in the clip.
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
        let error = layer.set_goal(stranger, [0.0; 3], 1.0).unwrap_err();
        assert!(matches!(error, LayerError::NoEffector(own) if own.effectors.len() == 2));
    }
    assert!(reached >= 6, "{reached} of 8");
}

#[test]
fn reach_layer_pins_and_rotates_bones_by_weight() {
    let mut reached = [0; 3];
    for seed in 0..8 {
        let rig = RandomRig::new(200 + seed);
        let (skeleton, tips) = (&rig.skeleton, &rig.tips[..2]);
        let (armature, bridge) = (Armature::of_skeleton(skeleton), EulerPoseMap::new(skeleton));
        let mut random = Random::new(seed);
        let within = |random: &mut Random, low: f64, high: f64| -> Vec<f64> {
            let limits = skeleton.model().limits();
            limits
                .map(|l| l.lower + (l.upper - l.lower) * random.within(low, high))
                .collect()
        };
        let (mut pose, mut goal_pose) = (armature.rest().clone(), armature.rest().clone());
        bridge
            .pose_of(&within(&mut random, 0.45, 0.55), &mut pose)
            .unwrap();
        bridge
            .pose_of(&within(&mut random, 0.4, 0.6), &mut goal_pose)
            .unwrap();
        let turned = |pose: &Pose, bone: BoneId| {
            Quat::from_mat3a(&model_by_ancestors(&armature, pose)[bone.index()].matrix3)
        };
        let [moves, still] = [tips[0], tips[1]];
        let mut layer = ReachLayer::holding(skeleton, tips, tips, Solver::default()).unwrap();
        for (case, weight) in [0.0, 0.5, 1.0].into_iter().enumerate() {
            let mut posed = pose.clone();
            let target = tip(&armature, &rig, &goal_pose, moves);
            let from = tip(&armature, &rig, &pose, moves);
            let near = (from + (target - from) * weight).to_array().map(f64::from);
            // With weight 0 a small displacement, and pinned.
            let near = if case == 0 {
                near.map(|x| x + 0.005)
            } else {
                near
            };
            layer.set_goal(moves, near, 1.0).unwrap();
            let target_rotation = turned(&goal_pose, moves);
            layer
                .set_rotation(moves, target_rotation * -2.0, f64::from(weight))
                .unwrap();
            if !layer.apply(&mut posed).unwrap().unwrap().reached {
                continue;
            }
            reached[case] += 1;
            let [was, is] = [&pose, &posed].map(|pose| turned(pose, moves));
            let angle = apart(was, target_rotation);
            assert!((apart(was, is) - weight * angle).abs() < 1e-4);
            assert!((apart(is, target_rotation) - (1.0 - weight) * angle).abs() < 1e-4);
            // The other end is pinned at its placement.
            assert!(apart(turned(&pose, still), turned(&posed, still)) < 1e-4);
        }
        let stranger = rig.tips[4];
        let error = layer
            .set_rotation(stranger, Quat::IDENTITY, 1.0)
            .unwrap_err();
        assert!(matches!(error, LayerError::NoEffector(own) if own.effectors.len() == 2));
        // A zero quaternion is an error.
        let applied = |layer: &mut ReachLayer, rotation: Quat, weight: f64| {
            layer.set_rotation(moves, rotation, weight).unwrap();
            let mut posed = pose.clone();
            layer.apply(&mut posed).unwrap();
            posed
        };
        let held = applied(&mut layer, Quat::IDENTITY, 0.0);
        for none in [Quat::NAN, Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)] {
            assert!(layer.set_rotation(moves, none, 1.0).is_err());
            let mut posed = pose.clone();
            layer.apply(&mut posed).unwrap();
            assert_eq!(posed, held);
        }
    }
    assert!(reached.iter().all(|&count| count >= 6), "{reached:?} of 8");
}

/// A weight is clamped: above 1 it is 1; below 0 and NaN it is 0.
#[test]
fn weights_are_clamped_to_0_and_1() {
    let rig = RandomRig::new(301);
    let (skeleton, bone) = (&rig.skeleton, rig.tips[0]);
    let (armature, bridge) = (Armature::of_skeleton(skeleton), EulerPoseMap::new(skeleton));
    let inward = |share: f64| -> Vec<f64> {
        let limits = skeleton.model().limits();
        limits
            .map(|l| l.lower + (l.upper - l.lower) * share)
            .collect()
    };
    let mut pose = armature.rest().clone();
    bridge.pose_of(&inward(0.5), &mut pose).unwrap();
    let goal_pose = skeleton.pose(&inward(0.52)).unwrap();
    let target = goal_pose.tip(skeleton, bone).unwrap();
    let mut layer = ReachLayer::holding(skeleton, &[bone], &[bone], Solver::default()).unwrap();
    let mut applied = |goal: f64, turn: f64| {
        layer.set_goal(bone, target, goal).unwrap();
        let turned = Quat::from_rotation_y(0.1);
        layer.set_rotation(bone, turned, turn).unwrap();
        let mut posed = pose.clone();
        layer.apply(&mut posed).unwrap();
        posed
    };
    let (whole, held, turned) = (applied(1.0, 0.0), applied(0.0, 0.0), applied(0.0, 1.0));
    assert_ne!(whole, held);
    assert_ne!(turned, held);
    for above in [1.5, 40.0, f64::INFINITY] {
        assert_eq!(applied(above, 0.0), whole, "{above}");
        assert_eq!(applied(0.0, above), turned, "{above}");
    }
    for none in [-0.5, f64::NEG_INFINITY, f64::NAN] {
        assert_eq!(applied(none, none), held, "{none}");
    }
}

#[test]
fn invalid_reach_goals_fail_or_change_nothing() {
    let rig = RandomRig::new(300);
    let (skeleton, bone) = (&rig.skeleton, rig.tips[0]);
    let armature = Armature::of_skeleton(skeleton);
    let target = skeleton
        .pose(&skeleton.model().neutral())
        .unwrap()
        .tip(skeleton, bone)
        .unwrap();

    // A pose of another armature.
    let mut layer = ReachLayer::new(skeleton, &[bone], Solver::default()).unwrap();
    layer.set_goal(bone, target, 1.0).unwrap();
    let small = Armature::new(Vec::new(), Vec::new()).unwrap();
    let error = layer.apply(&mut small.rest().clone()).unwrap_err();
    assert!(matches!(error, LayerError::Size(_)), "{error}");
    assert!(layer.apply(&mut armature.rest().clone()).unwrap().is_some());

    // A target that is not finite is an error, and the previous one stays.
    for invalid in [f64::NAN, f64::INFINITY] {
        let error = layer.set_goal(bone, [invalid, 0.0, 0.0], 0.0).unwrap_err();
        assert!(error.to_string().contains("not finite"), "{error}");
        assert!(layer.apply(&mut armature.rest().clone()).unwrap().is_some());
    }

    // A bone named twice is one task, which its goal moves.
    let mut twice = ReachLayer::holding(skeleton, &[bone; 2], &[bone; 2], Solver::default());
    let mut once = ReachLayer::holding(skeleton, &[bone], &[bone], Solver::default());
    let poses = [&mut twice, &mut once].map(|layer| {
        let layer = layer.as_mut().unwrap();
        let near = target.to_array().map(|x| x * 0.99);
        layer.set_goal(bone, near, 1.0).unwrap();
        let mut pose = armature.rest().clone();
        layer.apply(&mut pose).unwrap();
        pose
    });
    let [twice, once] = poses;
    assert_eq!(twice, once);

    // The error for a bone of another skeleton says so.
    let stranger = Armature::new(
        (0..skeleton.bones().len() + 1)
            .map(|index| ArmatureBone {
                name: format!("bone {index}"),
                parent: None,
                rest: LocalTransform::IDENTITY,
            })
            .collect(),
        Vec::new(),
    );
    let stranger = stranger.unwrap().bone_at(skeleton.bones().len()).unwrap();
    for (tips, held) in [([stranger], [bone]), ([bone], [stranger])] {
        let error = ReachLayer::holding(skeleton, &tips, &held, Solver::default()).unwrap_err();
        assert!(matches!(error, ProblemError::ForeignId { .. }), "{error}");
    }
}

/// A bone without children may be scaled unevenly: the distance of its tip is scaled by its x scale.
#[test]
fn tip_distance_includes_the_bones_scale() {
    for seed in 0..6 {
        let rig = RandomRig::new(300 + seed);
        let (skeleton, bone) = (&rig.skeleton, rig.tips[0]);
        let (armature, bridge) = (Armature::of_skeleton(skeleton), EulerPoseMap::new(skeleton));
        let middle: Vec<f64> = skeleton
            .model()
            .limits()
            .map(|l| 0.5 * (l.lower + l.upper))
            .collect();
        let mut pose = armature.rest().clone();
        bridge.pose_of(&middle, &mut pose).unwrap();
        let mut local = pose.local(bone).unwrap();
        local.scale = Vec3A::new(1.6, 0.7, 1.1);
        pose.set_local(bone, local).unwrap();
        let from = tip(&armature, &rig, &pose, bone);
        let mut layer = ReachLayer::new(skeleton, &[bone], Solver::default()).unwrap();
        let mut moved = pose.clone();
        let target = from + Vec3A::new(0.004, -0.003, 0.002);
        layer
            .set_goal(bone, target.to_array().map(f64::from), 1.0)
            .unwrap();
        assert!(layer.apply(&mut moved).unwrap().unwrap().reached, "{seed}");
        let deviation = (tip(&armature, &rig, &moved, bone) - target).length();
        assert!(deviation < 2e-5, "{seed}: {deviation}");
    }
}

/// Longer bones of a pose reach further than their rig. A tip that a limit keeps from its target is not proven
/// unreachable.
#[test]
fn longer_bones_extend_the_reported_reach() {
    let mut count = 0;
    for seed in 0..8 {
        let rig = RandomRig::new(400 + seed);
        let (skeleton, bone) = (&rig.skeleton, rig.tips[0]);
        let armature = Armature::of_skeleton(skeleton);
        let mut pose = armature.rest().clone();
        let root = armature.bone_ids().next().unwrap();
        let mut local = pose.local(root).unwrap();
        local.scale = Vec3A::splat(3.0);
        pose.set_local(root, local).unwrap();
        let from = tip(&armature, &rig, &pose, bone);
        let mut layer = ReachLayer::new(skeleton, &[bone], Solver::default()).unwrap();
        // At the same distance from the root on its other side, where joint limits hardly allow motion.
        let behind = (pose.local(root).unwrap().translation * 2.0 - from).to_array();
        layer.set_goal(bone, behind.map(f64::from), 1.0).unwrap();
        let solution = layer.apply(&mut pose).unwrap().unwrap();
        if !solution.reached {
            count += 1;
            let words = solution.explain();
            assert!(!words.contains("Out of reach"), "{seed}: {words}");
        }
    }
    assert!(count > 0);
}

/// A pose with longer bones is another problem, although its rotations are equal.
#[test]
fn reused_layer_notices_longer_bones() {
    for seed in 0..4 {
        let rig = RandomRig::new(500 + seed);
        let (skeleton, bone) = (&rig.skeleton, rig.tips[0]);
        let armature = Armature::of_skeleton(skeleton);
        let limits = skeleton.model().limits();
        let middle: Vec<f64> = limits.map(|l| 0.5 * (l.lower + l.upper)).collect();
        let mut pose = armature.rest().clone();
        EulerPoseMap::new(skeleton)
            .pose_of(&middle, &mut pose)
            .unwrap();
        let mut longer = pose.clone();
        let mut local = longer.local(bone).unwrap();
        local.translation *= 1.1;
        longer.set_local(bone, local).unwrap();
        let here = tip(&armature, &rig, &pose, bone).to_array().map(f64::from);
        let layer = || {
            let mut layer = ReachLayer::new(skeleton, &[bone], Solver::default()).unwrap();
            layer.set_goal(bone, here, 1.0).unwrap();
            layer
        };
        let mut fresh = longer.clone();
        layer().apply(&mut fresh).unwrap();
        assert!(difference(&fresh, &longer) > 1e-4);
        let mut used = layer();
        used.apply(&mut pose.clone()).unwrap();
        let mut again = longer.clone();
        used.apply(&mut again).unwrap();
        assert_eq!(again, fresh, "{seed}");
    }
}
