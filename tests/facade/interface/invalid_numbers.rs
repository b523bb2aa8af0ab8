//! Promise: numbers of the wrong count, or not finite, are an `Err` that says so in all of the interface. None is
//! dropped, filled up, taken as 0 or passed on.

use std::error::Error;

use kinopt::animation::{
    Armature, ArmatureBone, BallPoseMap, BoneMask, EulerClip, EulerPoseMap, LocalTransform,
    Playback, Pose,
};
use kinopt::arm::{Arm, Base};
use kinopt::collision::{CollisionModel, MeshUse};
use kinopt::ik::hold_postures;
use kinopt::kinematics::{ForwardKinematics, Jacobian, frame_jacobian};
use kinopt::mesh::TriangleMesh;
use kinopt::model::{JointKind, Limits, Model, ParameterMap};
use kinopt::motion::path::CartesianPath;
use kinopt::problem::{Evaluation, ProblemBuilder};
use kinopt::robot::Robot;
use kinopt::simd_ik::{Chain, ChainJoint};
use kinopt::skeleton::{BallSkeleton, Bone, Cones, Posing, Skeleton, SkeletonRoot};
use kinopt::skinning::{AutomaticWeights, HeatWeights, SkinWeights, SkinningMethod};
use kinopt::solver::{LevenbergMarquardt, Silent, SolverState, Stopping, minimise};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Posture, Smoothness};
use kinopt::{Problem, Solver};
use support::fault_tables::ExpectedError;
use support::planar_arm;

type Outcome = Result<(), Box<dyn Error>>;

fn skeleton() -> Skeleton {
    let mut builder = Skeleton::builder("two bones");
    let mut parent = None;
    for (name, at) in [("upper", 0.0), ("fore", 0.3)] {
        parent = Some(builder.add(Bone {
            name: name.to_owned(),
            parent,
            length: 0.3,
            model_from_rest: Placement::translation(Vector3::new(at, 0.0, 0.0)),
            limits: [Limits::new(-2.0, 2.0); 3],
        }));
    }
    builder.build().unwrap()
}

fn triangle() -> TriangleMesh {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(glam::Vec3::from);
    TriangleMesh::new(corners.to_vec(), Vec::new(), vec![[0, 1, 2]]).unwrap()
}

fn solve(model: &Model, q: &[f64]) -> Outcome {
    let mut tasks = Problem::builder(model);
    tasks.add(kinopt::task::Point::new(model.frame("tip")?, [0.1; 3]));
    Solver::default().solve_once(&tasks.build()?, q)?;
    Ok(())
}

fn minimised(model: &Model, start: &[f64]) -> Outcome {
    let mut tasks = Problem::builder(model);
    tasks.add(Posture::new(model, &[0.0; 3]));
    let problem = tasks.build()?;
    let mut scratch = problem.scratch();
    minimise(
        &mut Evaluation::new(&problem, &mut scratch),
        &LevenbergMarquardt::default(),
        start,
        &Stopping::default(),
        &mut Silent,
        &mut SolverState::default(),
    )?;
    Ok(())
}

/// Functions that take a configuration of a model with three joints.
fn configuration_functions(q: &[f64]) -> Vec<(&'static str, Outcome)> {
    let model = planar_arm(&[0.5, 0.4, 0.3], None);
    let map = ParameterMap::identity(&model);
    let tip = model.frame("tip").unwrap();
    let [first, ..] = *model.moving_joints() else {
        unreachable!()
    };
    let mut room = [0.0; 3];
    let mut kinematics = ForwardKinematics::new(&model);
    let only = ParameterMap::builder(&model).with_only(&[first], q).build();
    let with_tasks = |residual: &dyn Fn(&mut ProblemBuilder<'_>)| {
        let mut tasks = Problem::builder(&model);
        residual(&mut tasks);
        tasks.build().map(drop).map_err(Into::into)
    };
    let joint = ChainJoint {
        parent_from_joint: Placement::identity(),
        axis: Vector3::UNITS[2],
        kind: JointKind::Revolute,
        lower: -1.0,
        upper: 1.0,
    };
    let chain = Chain::new(vec![joint; 3], Placement::identity()).unwrap();
    vec![
        (
            "posture",
            with_tasks(&|tasks| {
                tasks.add(Posture::new(&model, q));
            }),
        ),
        (
            "smoothness",
            with_tasks(&|tasks| {
                tasks.add(Smoothness::new(&model, q, 0.1));
            }),
        ),
        (
            "base_from_tip",
            chain.base_from_tip(q).map(drop).map_err(Into::into),
        ),
        (
            "with_only",
            Arm::builder(&model, Base::World, tip)
                .with_only([first], q)
                .build()
                .map(drop)
                .map_err(Into::into),
        ),
        ("minimise", minimised(&model, q)),
        ("place", kinematics.place(q).map(drop).map_err(Into::into)),
        (
            "at",
            Jacobian::new(kinematics)
                .at(q)
                .map(drop)
                .map_err(Into::into),
        ),
        (
            "frame_jacobian",
            frame_jacobian(&model, tip, q).map(drop).map_err(Into::into),
        ),
        ("expand", map.expand(q, &mut room).map_err(Into::into)),
        (
            "expand_within_limits",
            map.expand_within_limits(q, &mut room).map_err(Into::into),
        ),
        ("reduce", map.reduce(q, &mut room).map_err(Into::into)),
        ("only", only.map(drop).map_err(Into::into)),
        ("solve", solve(&model, q)),
    ]
}

/// Functions that take the stacked angles of a skeleton with two bones.
fn angle_functions(q: &[f64]) -> Vec<(&'static str, Outcome)> {
    let skeleton = skeleton();
    let holds = skeleton.holds(&[]);
    let bridge = EulerPoseMap::new(&skeleton);
    let mut pose = Armature::of_skeleton(&skeleton).rest().clone();
    vec![
        ("pose", skeleton.pose(q).map(drop).map_err(Into::into)),
        (
            "posing",
            Posing::new(&skeleton).pose(q).map(drop).map_err(Into::into),
        ),
        (
            "holds",
            holds.parameters(&skeleton, q).map(drop).map_err(Into::into),
        ),
        (
            "postures",
            hold_postures(&holds, &skeleton, q)
                .map(drop)
                .map_err(Into::into),
        ),
        ("pose_of", bridge.pose_of(q, &mut pose).map_err(Into::into)),
    ]
}

#[test]
fn invalid_configurations_are_rejected() {
    for (name, right) in configuration_functions(&[0.1, 0.2, 0.3]) {
        assert!(right.is_ok(), "{name}: {right:?}");
    }
    for (name, right) in angle_functions(&[0.1; 6]) {
        assert!(right.is_ok(), "{name}: {right:?}");
    }
    let wrong: [&[f64]; 4] = [&[], &[0.1, 0.2], &[0.1; 4], &[0.1, f64::NAN, 0.3]];
    for q in wrong {
        for (name, refused) in configuration_functions(q) {
            let message = refused.expect_err(name).to_string();
            let reason = if q.len() == 3 { "finite" } else { "3" };
            assert!(message.contains(reason), "{name}: {message}");
        }
    }
    let mut odd = [0.1; 6];
    odd[4] = f64::NAN;
    let wrong: [&[f64]; 4] = [&[], &[0.1; 5], &[0.1; 7], &odd];
    for q in wrong {
        for (name, refused) in angle_functions(q) {
            let message = refused.expect_err(name).to_string();
            let reason = if q.len() == 6 { "finite" } else { "6" };
            assert!(message.contains(reason), "{name}: {message}");
        }
    }
}

#[test]
fn configuration_buffers_of_wrong_length_are_rejected() {
    let map = ParameterMap::identity(&planar_arm(&[0.5, 0.4, 0.3], None));
    for length in [0, 2, 4] {
        let mut room = vec![7.0; length];
        assert!(map.expand(&[0.0; 3], &mut room).is_err());
        assert!(map.expand_within_limits(&[0.0; 3], &mut room).is_err());
        assert!(map.reduce(&[0.0; 3], &mut room).is_err());
        assert!(room.iter().all(|value| *value == 7.0), "it was written to");
    }
}

#[test]
fn invalid_poses_and_masks_are_rejected() {
    let armature = Armature::of_skeleton(&skeleton());
    let other = Armature::new(Vec::new(), Vec::new()).unwrap();
    let mut pose: Pose = armature.rest().clone();
    assert!(pose.cross_fade(other.rest(), 0.5).is_err());
    assert!(
        armature
            .local_to_model(other.rest(), &mut Vec::new())
            .is_err()
    );
    assert!(armature.skinning_transforms(&[], &mut Vec::new()).is_err());

    let skeleton = skeleton();
    let bridge = EulerPoseMap::new(&skeleton);
    assert!(bridge.angles_of(other.rest(), &mut Vec::new()).is_err());
    assert!(bridge.angles_of(&pose, &mut [7.0; 5]).is_err());
    assert!(bridge.angles_of(&pose, &mut [7.0; 7]).is_err());
    assert!(
        bridge
            .pose_of(&[0.0; 6], &mut other.rest().clone())
            .is_err()
    );
    // A scene's armature, which has bones of its own after the rig's.
    let named = |bone: usize| ArmatureBone {
        name: format!("bone {bone}"),
        parent: None,
        rest: LocalTransform::IDENTITY,
    };
    let more = Armature::new((0..3).map(named).collect(), Vec::new()).unwrap();
    let mut more = more.rest().clone();
    assert!(bridge.pose_of(&[0.0; 6], &mut more).is_ok());
    assert!(bridge.angles_of(&more, &mut Vec::new()).is_ok());
    let balls = BallSkeleton::new(skeleton, &Cones::new(), SkeletonRoot::Fixed).unwrap();
    let turns = BallPoseMap::new(&armature, &balls);
    assert!(
        turns
            .configuration_of(other.rest(), &mut Vec::new())
            .is_err()
    );
    let mut q = balls.model().neutral();
    assert!(turns.configuration_of(&pose, &mut q[1..]).is_err());
    assert!(turns.pose_of(&q, &mut other.rest().clone()).is_err());
    assert!(turns.pose_of(&q, &mut pose).is_ok());
    q[0] = f64::NAN;
    assert!(turns.pose_of(&q, &mut pose).is_err());
    assert!(turns.pose_of(&q[1..], &mut pose).is_err());

    let fore = armature.bone("fore").unwrap();
    let mask = || BoneMask::none(&armature);
    assert!(mask().with_bone(fore, 0.5).is_ok());
    assert!(BoneMask::none(&other).with_bone(fore, 0.5).is_err());
    assert!(
        BoneMask::none(&other)
            .with_subtree(&armature, fore, 0.5)
            .is_err()
    );
    assert!(mask().with_morph_target(0, 0.5).is_err());
    for share in [-0.1, 1.1, f32::NAN] {
        assert!(mask().with_bone(fore, share).is_err());
        assert!(mask().with_subtree(&armature, fore, share).is_err());
    }
}

#[test]
fn invalid_targets_are_rejected() {
    let model = planar_arm(&[0.5, 0.4, 0.3], None);
    let mut posture = Posture::new(&model, &[0.0; 3]);
    assert!(posture.set_reference(&[0.1; 3]).is_ok());
    let mut smoothness = Smoothness::new(&model, &[0.0; 3], 0.1);
    for wrong in [&[][..], &[0.1; 2], &[0.1; 4]] {
        assert!(posture.set_reference(wrong).is_err());
        assert!(smoothness.set_previous(wrong).is_err());
    }
    assert_eq!(posture, Posture::new(&model, &[0.1; 3]));
    assert_eq!(smoothness, Smoothness::new(&model, &[0.0; 3], 0.1));
}

#[test]
fn zero_counts_are_rejected() {
    let keys = vec![Placement::identity(); 2];
    CartesianPath::spline(keys, None, 0).says("steps");
    let robot = Robot::read("../models/franka_panda.urdf").unwrap();
    let builder = CollisionModel::builder(&robot).with_meshes(MeshUse::Pieces(0));
    builder.build().says("pieces");
}

#[test]
fn invalid_sample_times_are_rejected() {
    let clip = EulerClip::default();
    assert!(
        clip.sample(f64::NAN, Playback::Hold, &mut [0.0; 6])
            .is_err()
    );
}

#[test]
fn invalid_skin_weights_are_rejected() {
    let (mesh, skeleton) = (triangle(), skeleton());
    let mut by_distance = AutomaticWeights::default();
    by_distance.most = 0;
    assert!(by_distance.for_skeleton(&mesh, &skeleton).is_err());
    let mut by_heat = HeatWeights::default();
    by_heat.most = 0;
    assert!(by_heat.for_skeleton(&mesh, &skeleton).is_err());

    let mut builder = SkinWeights::builder(3, 2);
    for vertex in 0..3 {
        builder.add(vertex, 0, 1.0).unwrap();
    }
    let weights = builder.build().unwrap();
    assert!(weights.pruned(0).is_err());
    let method = SkinningMethod::LinearBlend;
    assert!(method.mesh(&mesh, &weights, &[]).is_err());
}
