//! Promise: below unevenly scaled and mirrored bones, inverse kinematics brings the bones of the armature itself to
//! their targets, according to its own forward kinematics.

use glam::{Affine3A, Quat, Vec3A};
use kinopt::Solver;
use kinopt::animation::{
    Aim, AimGoal, Armature, ArmatureBone, BallPoseMap, Clip, EulerPoseMap, Limb, LimbGoal,
    LocalTransform, Pose, ReachLayer,
};
use kinopt::ik::Drag;
use kinopt::model::Limits;
use kinopt::motion::clip_ik::{ClipIk, Reach};
use kinopt::problem::Problem;
use kinopt::skeleton::{BallSkeleton, BoneId, Cones, SkeletonRoot};
use kinopt::task::Point;
use support::armatures::model_transforms;
use support::random::Random;

/// Scales of the root and of the fourth bone.
const SCALES: [[[f32; 3]; 2]; 8] = [
    [[1.0; 3], [1.0; 3]],
    [[1.0, 1.001, 1.0], [1.0; 3]],
    [[1.0, 1.5, 1.0], [1.0; 3]],
    [[-1.0, 1.0, 1.0], [1.0; 3]],
    [[-1.0; 3], [1.0, 1.0, -1.0]],
    [[1.0, 1.001, 1.0], [1.0, 1.0, 1.3]],
    [[-1.0, 1.5, 1.0], [1.2, -1.0, 1.0]],
    [[-2.0, 2.0, 2.0], [0.5, 0.7, 0.5]],
];

/// Root with two arms of four bones each, rotated at random in the rest pose.
fn armature([root, fourth]: [[f32; 3]; 2], random: &mut Random) -> Armature {
    let mut number = |range: f32| range * random.within(-1.0, 1.0) as f32;
    let bones = (0..9).map(|index| ArmatureBone {
        name: format!("bone {index}"),
        parent: match index {
            0 => None,
            5 => Some(0),
            _ => Some(index - 1),
        },
        rest: LocalTransform {
            translation: Vec3A::new(0.4, number(0.1), number(0.1)),
            rotation: Quat::from_euler(glam::EulerRot::XYZ, number(1.0), number(1.0), number(1.0)),
            scale: Vec3A::from_array(match index {
                0 => root,
                3 => fourth,
                _ => [1.0; 3],
            }),
        },
    });
    Armature::new(bones.collect(), Vec::new()).unwrap()
}

/// The armature in another pose: each bone is rotated by up to `max_angle` radians about each axis.
fn turned(armature: &Armature, max_angle: f64, random: &mut Random) -> Pose {
    let mut pose = armature.rest().clone();
    for bone in armature.bone_ids() {
        let [x, y, z] = [0; 3].map(|_| random.within(-max_angle, max_angle) as f32);
        let rotation = pose.local(bone).unwrap().rotation;
        let turn = Quat::from_euler(glam::EulerRot::XYZ, x, y, z);
        pose.set_rotation(bone, rotation * turn).unwrap();
    }
    pose
}

fn bone(armature: &Armature, index: usize) -> BoneId {
    armature.bone_at(index).unwrap()
}

/// Calls `check` with armatures of all scales.
fn each_scale(seed: u64, mut check: impl FnMut(&Armature, &mut Random, &str)) {
    for scales in SCALES {
        for round in 0..4 {
            let random = &mut Random::new(seed + round);
            let armature = armature(scales, random);
            check(&armature, random, &format!("{scales:?}, round {round}"));
        }
    }
}

#[test]
fn skeleton_at_rest_has_the_joints_of_the_armature() {
    each_scale(10, |armature, _, case| {
        let skeleton = armature
            .skeleton("one", |_| [Limits::UNBOUNDED; 3])
            .unwrap();
        for (bone, placed) in skeleton
            .bones()
            .iter()
            .zip(model_transforms(armature, armature.rest()))
        {
            let tail = glam::DVec3::from(bone.rest_tail().to_array());
            let apart = tail.distance(placed.translation.as_dvec3());
            assert!(apart < 1e-5, "{case}: {apart}");
        }
    });
}

/// Uniform scales and mirrors rotate rigidly, so the skeleton's joints are the armature's in all poses.
#[test]
fn mirrored_skeleton_turns_as_its_armature() {
    for scales in [SCALES[3], SCALES[4], [[-1.0, 1.0, 1.0], [2.0, -2.0, -2.0]]] {
        let random = &mut Random::new(11);
        let armature = armature(scales, random);
        let skeleton = armature
            .skeleton("one", |_| [Limits::UNBOUNDED; 3])
            .unwrap();
        let angles = EulerPoseMap::new(&skeleton);
        let root = SkeletonRoot::FREE;
        let figure = BallSkeleton::new(skeleton.clone(), &Cones::new(), root).unwrap();
        let turns = BallPoseMap::new(&armature, &figure);
        for _ in 0..20 {
            let pose = turned(&armature, 1.0, random);
            let (mut q, mut balls) = (Vec::new(), Vec::new());
            angles.angles_of(&pose, &mut q).unwrap();
            turns.configuration_of(&pose, &mut balls).unwrap();
            let placed = [skeleton.pose(&q).unwrap(), figure.pose(&balls).unwrap()];
            for (bone, placement) in skeleton.bone_ids().zip(model_transforms(&armature, &pose)) {
                for placed in &placed {
                    let tail = glam::DVec3::from(placed.tail(bone).unwrap().to_array());
                    let apart = tail.distance(placement.translation.as_dvec3());
                    assert!(apart < 1e-5, "{scales:?}: {apart}");
                }
            }
            let [mut by_angles, mut by_turns] = [0; 2].map(|_| armature.rest().clone());
            angles.pose_of(&q, &mut by_angles).unwrap();
            turns.pose_of(&balls, &mut by_turns).unwrap();
            for back in [by_angles, by_turns] {
                let pairs = back.rotations().iter().zip(pose.rotations());
                for (back, original) in pairs {
                    assert!(back.dot(*original).abs() > 1.0 - 1e-5, "{scales:?}");
                }
            }
        }
    }
}

#[test]
fn reach_layer_brings_the_scaled_armature_there() {
    each_scale(20, |armature, random, case| {
        let free = |_| [Limits::UNBOUNDED; 3];
        let skeleton = armature.skeleton("one", free).unwrap();
        let hands = [4, 8].map(|index| bone(armature, index));
        let mut layer = ReachLayer::new(&skeleton, &hands, Solver::default()).unwrap();
        let target_transforms = model_transforms(armature, &turned(armature, 0.7, random));
        for hand in hands {
            let target = target_transforms[hand.index()]
                .translation
                .as_dvec3()
                .to_array();
            layer.set_goal(hand, target, 1.0).unwrap();
        }
        let mut pose = armature.rest().clone();
        let reached = layer.apply(&mut pose).unwrap().unwrap().reached;
        let placed = model_transforms(armature, &pose);
        for hand in hands.map(BoneId::index) {
            let deviation = placed[hand]
                .translation
                .distance(target_transforms[hand].translation);
            assert!(
                deviation < 1e-5,
                "{case}: bone {hand} is off by {deviation}"
            );
        }
        assert!(reached, "{case}");
    });
}

/// Drag whose targets are the joints' positions in the pose of each frame.
#[test]
fn drag_brings_the_scaled_armature_there() {
    each_scale(25, |armature, random, case| {
        let free = |_| [Limits::UNBOUNDED; 3];
        let mut skeleton = armature.skeleton("one", free).unwrap();
        let angles = EulerPoseMap::new(&skeleton);
        let hand = bone(armature, 4);
        let target_transforms = model_transforms(armature, &turned(armature, 0.4, random));
        let target = target_transforms[4].translation;
        let goal = target.as_dvec3().to_array();
        let mut problem = Problem::builder(skeleton.model());
        problem.add(Point::new(skeleton.tip(hand), goal));
        let start = skeleton.model().neutral();
        let mut drag = Drag::new(problem.build().unwrap(), &start).unwrap();
        let mut pose = armature.rest().clone();
        let mut frames = 0;
        while frames == 0 || !drag.is_at_rest() && frames < 300 {
            let q = drag.advance().q.clone();
            angles.pose_of(&q, &mut pose).unwrap();
            skeleton = pose.posed_skeleton(&skeleton).unwrap();
            drag.move_joints(skeleton.model()).unwrap();
            frames += 1;
        }
        let deviation = model_transforms(armature, &pose)[4]
            .translation
            .distance(target);
        assert!(
            deviation < 1e-5,
            "{case}: {deviation} after {frames} frames"
        );
    });
}

/// Leg of three bones whose first bone has a scale. The bones are along y, as in many rigs.
fn leg(scale: [f32; 3]) -> Armature {
    let bone = |name: &str, parent, translation, rotation, scale| ArmatureBone {
        name: name.into(),
        parent,
        rest: LocalTransform {
            translation: Vec3A::from_array(translation),
            rotation,
            scale: Vec3A::from_array(scale),
        },
    };
    let bend = |angle: f32| Quat::from_rotation_x(angle);
    let bones = vec![
        bone("thigh", None, [0.0, 1.0, 0.0], bend(3.0), scale),
        bone("shin", Some(0), [0.0, 0.45, 0.0], bend(0.2), [1.0; 3]),
        bone("foot", Some(1), [0.0, 0.45, 0.0], bend(-1.2), [1.0; 3]),
        bone("toes", Some(2), [0.0, 0.2, 0.0], Quat::IDENTITY, [1.0; 3]),
    ];
    Armature::new(bones, Vec::new()).unwrap()
}

/// Strong shear changes the joints by more than the motion that caused it.
#[test]
fn drag_converges_below_strong_shear() {
    for scale in [
        [1.0, 1.5, 0.8],
        [1.0, 2.0, 0.7],
        [1.0, 1.0, 0.5],
        [1.0, 2.0, 0.5],
    ] {
        let armature = leg(scale);
        let free = |_| [Limits::UNBOUNDED; 3];
        let mut skeleton = armature.skeleton("leg", free).unwrap();
        let angles = EulerPoseMap::new(&skeleton);
        let toes = bone(&armature, 3);
        let rest = model_transforms(&armature, armature.rest())[3].translation;
        for offset in [[0.0, 0.15, 0.1], [0.1, 0.2, -0.1], [-0.2, 0.3, 0.2]] {
            let target = rest + Vec3A::from_array(offset);
            let goal = target.as_dvec3().to_array();
            let mut problem = Problem::builder(skeleton.model());
            problem.add(Point::new(skeleton.tip(toes), goal));
            let start = skeleton.model().neutral();
            let mut drag = Drag::new(problem.build().unwrap(), &start).unwrap();
            let mut pose = armature.rest().clone();
            for _ in 0..60 {
                let q = drag.advance().q.clone();
                angles.pose_of(&q, &mut pose).unwrap();
                skeleton = pose.posed_skeleton(&skeleton).unwrap();
                drag.move_joints(skeleton.model()).unwrap();
            }
            let off = model_transforms(&armature, &pose)[3]
                .translation
                .distance(target);
            assert!(off < 1e-5, "{scale:?} {offset:?}: {off}");
        }
    }
}

/// A solution of an unreachable target is that of the armature as well.
#[test]
fn reach_layer_that_misses_reports_the_armature() {
    each_scale(30, |armature, _, case| {
        let free = |_| [Limits::UNBOUNDED; 3];
        let skeleton = armature.skeleton("one", free).unwrap();
        let hand = bone(armature, 4);
        let mut layer = ReachLayer::new(&skeleton, &[hand], Solver::default()).unwrap();
        let target = Vec3A::new(9.0, 3.0, -2.0);
        let goal = target.as_dvec3().to_array();
        layer.set_goal(hand, goal, 1.0).unwrap();
        let mut pose = armature.rest().clone();
        let solution = layer.apply(&mut pose).unwrap().unwrap();
        let reported = solution.tasks().next().unwrap().rows[0].error;
        let shown = f64::from(
            model_transforms(armature, &pose)[4]
                .translation
                .distance(target),
        );
        assert!(!solution.reached, "{case}");
        assert!(
            (reported - shown).abs() < 1e-5,
            "{case}: {reported} {shown}"
        );
    });
}

#[test]
fn limb_brings_the_scaled_armature_there() {
    each_scale(40, |armature, random, case| {
        let [upper, lower, end] = [1, 2, 4].map(|index| bone(armature, index));
        let limb = Limb::to_bone(armature, upper, lower, end).unwrap();
        let mut moved = armature.rest().clone();
        for bone in [upper, lower] {
            let turn = Quat::from_rotation_z(random.within(-0.7, 0.7) as f32);
            let rotation = moved.local(bone).unwrap().rotation;
            moved.set_rotation(bone, rotation * turn).unwrap();
        }
        let target = model_transforms(armature, &moved)[4].translation;
        let mut pose = armature.rest().clone();
        limb.reach(armature, &mut pose, &LimbGoal::at(target))
            .unwrap();
        let deviation = model_transforms(armature, &pose)[4]
            .translation
            .distance(target);
        assert!(deviation < 1e-5, "{case}: {deviation}");
    });
}

#[test]
fn aim_points_the_axis_that_the_pose_shows() {
    each_scale(50, |armature, random, case| {
        let head = bone(armature, 4);
        let aim = Aim::new(armature, head, Vec3A::Z).unwrap();
        let offset = Vec3A::new(0.0, 0.05, 0.1);
        let aim = aim.with_offset(offset).unwrap();
        let target = Vec3A::from_array([0; 3].map(|_| 3.0 * random.within(-1.0, 1.0) as f32));
        let mut pose = armature.rest().clone();
        assert!(
            aim.turn(armature, &mut pose, &AimGoal::at(target)).unwrap(),
            "{case}"
        );
        let placed = model_transforms(armature, &pose)[4];
        let from = placed.transform_point3a(offset);
        let along = placed.transform_vector3a(Vec3A::Z).normalize();
        let deviation = (target - from).reject_from_normalized(along).length();
        assert!(
            deviation < 2e-5 && along.dot(target - from) > 0.0,
            "{case}: {deviation}"
        );
    });
}

#[test]
fn clip_ik_brings_the_scaled_armature_there() {
    each_scale(60, |armature, random, case| {
        let poses = [0; 3].map(|_| turned(armature, 0.2, random));
        let clip = Clip::through_poses("sway", armature, &[0.0, 0.5, 1.0], &poses).unwrap();
        let hand = bone(armature, 4);
        // Well within reach: in other directions a sheared arm is shorter.
        let moved = model_transforms(armature, &turned(armature, 0.3, random));
        let target = moved[1].translation.lerp(moved[4].translation, 0.8);
        let reach = Reach::to(hand, target.as_dvec3()).unwrap();
        let edited = ClipIk::new(armature)
            .with_reach(reach)
            .with_root(bone(armature, 0))
            .with_keys_per_second(10.0)
            .solve(&clip)
            .unwrap();
        for key in 0..=10 {
            let mut pose = armature.rest().clone();
            let mut cursor = kinopt::animation::Cursor::new();
            let hold = kinopt::animation::Playback::Hold;
            let time = f64::from(key) / 10.0;
            edited
                .clip
                .sample(time, hold, &mut cursor, &mut pose)
                .unwrap();
            let deviation = model_transforms(armature, &pose)[4]
                .translation
                .distance(target);
            assert!(deviation < 1e-5, "{case}: {deviation} at {time} s");
            assert!(
                edited.report.led[0].miss < 1e-5,
                "{case}: {:?}",
                edited.report.led
            );
        }
    });
}

/// Differences of scales up to 1e-4 are rounding.
#[test]
fn rounded_scale_has_no_scale_note() {
    for (scale, notes) in [(0.999_998, 0), (1.000_05, 0), (0.999, 1)] {
        let armature = armature([[1.0, 1.0, scale], [1.0; 3]], &mut Random::new(85));
        assert_eq!(armature.scale_notes().len(), notes, "{scale}");
    }
}

#[test]
fn scale_notes_name_bones_with_children() {
    let random = &mut Random::new(80);
    let scaled = armature([[1.0, 1.001, 1.0], [1.0, -1.0, 1.0]], random);
    let notes = scaled.scale_notes();
    let messages: Vec<String> = notes.iter().map(ToString::to_string).collect();
    assert_eq!(
        messages,
        [
            "bone `bone 0`: its scale (1, 1.001, 1) shears the bones that rotate below it",
            "bone `bone 3`: its scale (1, -1, 1) mirrors the bones that rotate below it",
        ]
    );
    let plain = scaled.clone().without_scale();
    assert!(plain.scale_notes().is_empty());
    assert_eq!(plain.rest().rotations(), scaled.rest().rotations());
    assert_eq!(plain.rest().translations(), scaled.rest().translations());
    let inverses = plain.rest_from_model();
    for (placement, inverse) in model_transforms(&plain, plain.rest()).iter().zip(inverses) {
        assert!((*placement * *inverse).abs_diff_eq(Affine3A::IDENTITY, 1e-5));
    }
}

/// A rotation in the model is that of the placed bone, reflected as the bone is.
#[test]
fn model_rotation_of_a_mirrored_bone_is_the_one_set() {
    let random = &mut Random::new(70);
    let armature = armature(SCALES[4], random);
    for index in 0..armature.bones() {
        let mut pose = turned(&armature, 1.0, random);
        let bone = bone(&armature, index);
        let before = model_transforms(&armature, &pose)[index].matrix3;
        let turn = Quat::from_rotation_y(0.4) * Quat::from_rotation_x(-0.9);
        let rotation = armature.model_rotation(&pose, bone).unwrap();
        armature
            .set_model_rotation(&mut pose, bone, turn * rotation)
            .unwrap();
        let after = model_transforms(&armature, &pose)[index].matrix3;
        let expected = glam::Mat3A::from_quat(turn) * before;
        assert!(after.abs_diff_eq(expected, 1e-5), "{index}");
    }
}
