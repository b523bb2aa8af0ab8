//! Promise: the skeleton of an armature has the armature's placements in every pose, and the optimiser can drag its
//! bones.

use glam::{Affine3A, EulerRot, Quat, Vec3A};
use kinopt::Solver;
use kinopt::animation::{Armature, ArmatureBone, EulerPoseMap, LocalTransform, ReachLayer};
use kinopt::model::Limits;
use kinopt::spatial::Vector3;
use support::armatures::model_transforms;
use support::random::Random;

const FREE: [Limits; 3] = [Limits::UNBOUNDED; 3];

fn armature(bones: usize, random: &mut Random) -> Armature {
    let mut number = |range: f32| range * random.within(-1.0, 1.0) as f32;
    let mut made: Vec<ArmatureBone> = Vec::new();
    for index in 0..bones {
        let turn = [3.0, 1.5, 3.0].map(&mut number);
        made.push(ArmatureBone {
            name: format!("bone {index}"),
            parent: index.checked_sub(1 + index % 2),
            rest: LocalTransform {
                translation: Vec3A::from_array([1.0; 3].map(&mut number)),
                rotation: Quat::from_euler(EulerRot::ZYX, turn[0], turn[1], turn[2]),
                // Uniform scales, as in files with other units.
                scale: Vec3A::splat(1.0 + number(0.5)),
            },
        });
    }
    Armature::new(made, Vec::new()).unwrap()
}

#[test]
fn skeleton_and_armature_poses_agree() {
    let random = &mut Random::new(3);
    for _ in 0..20 {
        let armature = armature(12, random);
        let skeleton = armature.skeleton("one", |_| FREE).unwrap();
        let bridge = EulerPoseMap::new(&skeleton);
        let mut pose = armature.rest().clone();
        for round in 0..5 {
            let turn = f64::from(round.min(1)) * 3.0;
            let q: Vec<f64> = (0..skeleton.angles())
                .map(|_| random.within(-turn, turn))
                .collect();
            bridge.pose_of(&q, &mut pose).unwrap();
            let placed = skeleton.pose(&q).unwrap();
            for (bone, ours) in skeleton.bone_ids().zip(model_transforms(&armature, &pose)) {
                let apart = ours.translation.as_dvec3()
                    - glam::DVec3::from(placed.tail(bone).unwrap().to_array());
                assert!(apart.length() < 1e-4, "{apart}");
                assert_eq!(
                    placed.tail(bone).unwrap(),
                    placed.tip(&skeleton, bone).unwrap()
                );
            }
        }
        // Scales and translations are unchanged.
        assert_eq!(pose.scales(), armature.rest().scales());
        assert_eq!(pose.translations(), armature.rest().translations());
    }
}

#[test]
fn hand_of_an_armature_reaches_its_target() {
    let random = &mut Random::new(4);
    for _ in 0..10 {
        let armature = armature(8, random);
        let skeleton = armature.skeleton("one", |_| FREE).unwrap();
        let hand = skeleton.bone_at(7).unwrap();
        let mut layer = ReachLayer::new(&skeleton, &[hand], Solver::default()).unwrap();
        // Targets from another pose, so they are reachable.
        let q: Vec<f64> = (0..skeleton.angles())
            .map(|_| random.within(-1.0, 1.0))
            .collect();
        let target = skeleton.pose(&q).unwrap().tip(&skeleton, hand).unwrap();
        layer.set_goal(hand, target, 1.0).unwrap();
        let mut pose = armature.rest().clone();
        assert!(layer.apply(&mut pose).unwrap().unwrap().reached);
        let found = model_transforms(&armature, &pose)[7]
            .translation
            .as_dvec3()
            .to_array();
        assert!((Vector3::from(found) - target).norm() < 1e-4);
    }
}

#[test]
fn bone_may_have_the_name_of_a_tip() {
    // Named like the End Sites of motion capture: the joint's own tip takes another name.
    let bone = |name: &str, parent, x: f32| ArmatureBone {
        name: name.into(),
        parent,
        rest: LocalTransform {
            translation: Vec3A::new(x, 0.0, 0.0),
            ..LocalTransform::IDENTITY
        },
    };
    let bones = vec![
        bone("Head", None, 1.0),
        bone("Head/tip", Some(0), 2.0),
        bone("Head/tip/2", Some(0), 3.0),
    ];
    let armature = Armature::new(bones, Vec::new()).unwrap();
    let skeleton = armature.skeleton("one", |_| FREE).unwrap();
    let model = skeleton.model();
    for (name, frame) in [
        (
            "Head/tip",
            skeleton.tail(skeleton.bone("Head/tip").unwrap()),
        ),
        (
            "Head/tip/2",
            skeleton.tail(skeleton.bone("Head/tip/2").unwrap()),
        ),
        ("Head/tip/3", skeleton.tip(skeleton.bone("Head").unwrap())),
        (
            "Head/tip/tip",
            skeleton.tip(skeleton.bone("Head/tip").unwrap()),
        ),
    ] {
        assert_eq!(model.frame(name).unwrap(), frame, "{name}");
    }
    let frames = model.frames().iter().map(|frame| frame.name.as_str());
    let different: std::collections::BTreeSet<&str> = frames.collect();
    assert_eq!(different.len(), 6);
}

#[test]
fn rest_pose_can_be_replaced() {
    let random = &mut Random::new(6);
    let armature = armature(6, random);
    let mut pose = armature.rest().clone();
    for bone in (0..6).filter_map(|bone| armature.bone_at(bone)) {
        let turn = Quat::from_rotation_y(random.within(-1.0, 1.0) as f32);
        pose.set_rotation(bone, turn).unwrap();
    }
    let expected = model_transforms(&armature, &pose);
    let posed = armature.clone().at_rest_in(&pose).unwrap();
    assert_eq!(model_transforms(&posed, posed.rest()), expected);
    for (rest_from_model, model_from_rest) in posed.rest_from_model().iter().zip(&expected) {
        assert!((*rest_from_model * *model_from_rest).abs_diff_eq(Affine3A::IDENTITY, 1e-5));
    }
    let skeleton = posed.skeleton("one", |_| FREE).unwrap();
    let placed = skeleton.pose(&vec![0.0; skeleton.angles()]).unwrap();
    for (bone, placement) in skeleton.bone_ids().zip(&expected) {
        let apart = placement.translation.as_dvec3()
            - glam::DVec3::from(placed.tail(bone).unwrap().to_array());
        assert!(apart.length() < 1e-5);
    }
    let other = Armature::new(Vec::new(), Vec::new()).unwrap();
    assert!(armature.at_rest_in(other.rest()).is_err());
}

#[test]
fn skeleton_with_reversed_limits_is_an_error() {
    let backwards = |_| [Limits::new(1.0, -1.0); 3];
    let armature = armature(2, &mut Random::new(5));
    assert!(armature.skeleton("one", backwards).is_err());
}

/// Bones that rotate may rotate freely; all others are locked.
#[test]
fn bones_rotate_freely_or_are_locked() {
    use std::collections::BTreeSet;
    let rig = support::bones::RandomRig::new(3);
    let armature = kinopt::animation::Armature::of_skeleton(&rig.skeleton);
    let turning: BTreeSet<_> = armature
        .bone_ids()
        .filter(|bone| bone.index() % 3 == 1)
        .collect();
    let skeleton = armature.turning_skeleton("turning", &turning).unwrap();
    for bone in armature.bone_ids() {
        let skeleton_bone = skeleton.bone(&armature.names()[bone.index()]).unwrap();
        for limits in skeleton.bones()[skeleton_bone.index()].limits {
            let free = limits.lower == f64::NEG_INFINITY && limits.upper == f64::INFINITY;
            assert_eq!(
                (free, limits.is_locked()),
                match turning.contains(&bone) {
                    true => (true, false),
                    false => (false, true),
                }
            );
        }
    }
}
