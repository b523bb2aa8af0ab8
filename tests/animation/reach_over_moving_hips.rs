//! Promise: a reach layer reports the placements of the posed bones, also if the pose moves or scales bones that are
//! motionless at rest.
#![allow(clippy::print_stderr)] // Reports that nothing was tested.

use glam::{Quat, Vec3A};
use kinopt::Solver;
use kinopt::animation::{Armature, ArmatureBone, Cursor, EulerPoseMap, Playback, Pose, ReachLayer};
use kinopt::io::bvh;
use kinopt::model::Limits;
use kinopt::skeleton::{BoneId, Skeleton};
use support::armatures::{apart, model_by_ancestors, vector};
use support::bones::RandomRig;
use support::random::Random;

fn tip(armature: &Armature, skeleton: &Skeleton, pose: &Pose, bone: BoneId) -> Vec3A {
    let along = Vec3A::X * skeleton.bones()[bone.index()].length as f32;
    model_by_ancestors(armature, pose)[bone.index()].transform_point3a(along)
}

fn target(position: Vec3A) -> kinopt::spatial::Vector3<f64> {
    position.to_array().map(f64::from).into()
}

/// Moves every bone in its parent and scales it uniformly.
fn move_and_scale(pose: &mut Pose, armature: &Armature, random: &mut Random) {
    for index in 0..armature.bones() {
        let bone = armature.bone_at(index).unwrap();
        let mut local = pose.local(bone).unwrap();
        local.translation += vector(random, if index == 0 { 2.0 } else { 0.05 });
        local.scale = Vec3A::splat(random.within(0.9, 1.1) as f32);
        pose.set_local(bone, local).unwrap();
    }
}

#[test]
fn moved_and_scaled_bones_are_used_in_reaches() {
    let mut reached = 0;
    for seed in 0..8 {
        let rig = RandomRig::new(400 + seed);
        let (skeleton, tips) = (&rig.skeleton, &rig.tips[..2]);
        let (armature, bridge) = (Armature::of_skeleton(skeleton), EulerPoseMap::new(skeleton));
        let mut random = Random::new(seed);
        let mut within = |low: f64, high: f64| -> Vec<f64> {
            let limits = skeleton.model().limits();
            limits
                .map(|l| l.lower + (l.upper - l.lower) * random.within(low, high))
                .collect()
        };
        let (clip, goal) = (within(0.4, 0.6), within(0.35, 0.65));
        let mut pose = armature.rest().clone();
        move_and_scale(&mut pose, &armature, &mut random);
        let mut goal_pose = pose.clone();
        bridge.pose_of(&clip, &mut pose).unwrap();
        bridge.pose_of(&goal, &mut goal_pose).unwrap();

        let mut layer = ReachLayer::holding(skeleton, tips, &tips[1..], Solver::default()).unwrap();
        let goal_position = tip(&armature, skeleton, &goal_pose, tips[0]);
        let unchanged = tip(&armature, skeleton, &pose, tips[1]);
        layer.set_goal(tips[0], target(goal_position), 1.0).unwrap();
        let mut posed = pose.clone();
        let reported: Vec<f64> = {
            let solution = layer.apply(&mut posed).unwrap().unwrap();
            reached += usize::from(solution.reached);
            let reports = solution.tasks().take(2);
            reports.map(|task| task.rows[0].error).collect()
        };
        let shown = [(tips[0], goal_position), (tips[1], unchanged)]
            .map(|(bone, at)| (tip(&armature, skeleton, &posed, bone) - at).length());
        for (reported, shown) in reported.iter().zip(shown) {
            assert!(
                (reported - f64::from(shown)).abs() < 1e-5,
                "seed {seed}: {reported} {shown}"
            );
        }
        // A pinned hand keeps its rotation.
        let turned = |pose: &Pose| {
            let placement = model_by_ancestors(&armature, pose)[tips[1].index()];
            Quat::from_mat3a(&glam::Mat3A::from_cols(
                placement.matrix3.x_axis.normalize(),
                placement.matrix3.y_axis.normalize(),
                placement.matrix3.z_axis.normalize(),
            ))
        };
        if reported.iter().all(|error| *error < 1e-5) {
            assert!(apart(turned(&pose), turned(&posed)) < 1e-3);
        }
        assert_eq!(posed.translations(), pose.translations());
        assert_eq!(posed.scales(), pose.scales());
    }
    assert!(reached >= 6, "{reached} of 8");
}

/// Equal angles and targets in a frame in which only the hips have moved are another problem.
#[test]
fn moving_hips_alone_change_the_problem() {
    let rig = RandomRig::new(420);
    let (skeleton, tips) = (&rig.skeleton, &rig.tips[..1]);
    let armature = Armature::of_skeleton(skeleton);
    let mut layer = ReachLayer::new(skeleton, tips, Solver::default()).unwrap();
    let mut pose = armature.rest().clone();
    let goal_position = tip(&armature, skeleton, &pose, tips[0]);
    layer.set_goal(tips[0], target(goal_position), 1.0).unwrap();
    // Nothing to do: the search ends where it begins.
    let steps = layer.apply(&mut pose).unwrap().unwrap().iterations;
    assert_eq!(steps, 0);
    let root = armature.bone_at(0).unwrap();
    let mut pose = armature.rest().clone();
    let mut local = pose.local(root).unwrap();
    local.translation += Vec3A::new(0.2, -0.1, 0.1);
    pose.set_local(root, local).unwrap();
    let solution = layer.apply(&mut pose).unwrap().unwrap();
    let reported = solution.tasks().next().unwrap().rows[0].error;
    let shown = (tip(&armature, skeleton, &pose, tips[0]) - goal_position).length();
    assert!(
        (reported - f64::from(shown)).abs() < 1e-5,
        "{reported} {shown}"
    );
}

/// Captured walks whose hips travel several metres.
#[test]
fn captured_walk_is_reached_in_place() {
    let Some(shared) = std::env::var_os("KINOPT_SHARED") else {
        eprintln!("SKIPPED: KINOPT_SHARED is not set, so no captured walk was tried");
        return;
    };
    let path = std::path::Path::new(&shared).join("assets/bvh/01_01.bvh");
    let capture = bvh::read(&path).unwrap();
    // The tips of bones have frames with such names already.
    let bones = (0..capture.armature.bones()).map(|index| {
        let bone = capture.armature.bone_at(index).unwrap();
        ArmatureBone {
            name: capture.armature.names()[index].replace('/', " "),
            parent: capture.armature.parent(bone).map(BoneId::index),
            rest: capture.armature.rest().local(bone).unwrap(),
        }
    });
    let armature = &Armature::new(bones.collect(), Vec::new()).unwrap();
    let free = |_| [Limits::UNBOUNDED; 3];
    let skeleton = armature.skeleton("captured", free).unwrap();
    let hand = armature.bone("RightHand").unwrap();
    let mut layer = ReachLayer::new(&skeleton, &[hand], Solver::default()).unwrap();
    let (mut reached, size) = (0, skeleton.size());
    let mut cursor = Cursor::new();
    for frame in 0..40 {
        let mut pose = armature.rest().clone();
        let time = f64::from(capture.clip.span()[1]) * f64::from(frame) / 40.0;
        capture
            .clip
            .sample(time, Playback::Hold, &mut cursor, &mut pose)
            .unwrap();
        let at = tip(armature, &skeleton, &pose, hand);
        let goal_position = at + Vec3A::new(0.02, 0.03, -0.02) * size as f32;
        layer.set_goal(hand, target(goal_position), 1.0).unwrap();
        reached += usize::from(layer.apply(&mut pose).unwrap().unwrap().reached);
        let shown = tip(armature, &skeleton, &pose, hand);
        let deviation = f64::from((shown - goal_position).length()) / size;
        assert!(
            deviation < 1e-5,
            "frame {frame}: {deviation} of the figure's size"
        );
    }
    assert_eq!(reached, 40);
}
