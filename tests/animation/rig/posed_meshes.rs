//! Promise: one call from joint angles to a posed mesh equals the separate steps.

use std::sync::Arc;

use glam::Vec3;
use kinopt::animation::{Armature, EulerPoseMap};
use kinopt::io::FormatError;
use kinopt::io::rig::RigPosing;
use kinopt::skinning::{MeshWeights, PosedVertices, SkinningMethod, single_precision_transform};
use kinopt::task::Point;
use kinopt::{Problem, Solver};
use support::bones::humanoid;

#[test]
fn solution_poses_the_mesh() {
    let rig = humanoid();
    let skeleton = &rig.skeleton;
    let hand = skeleton.bone("left_hand").unwrap();
    let mut tasks = Problem::builder(skeleton.model());
    tasks.add(Point::new(skeleton.tip(hand), [0.35, 0.45, 1.5]));
    let problem = tasks.build().unwrap();
    let rest = skeleton.model().neutral();
    let solution = Solver::default().solve_once(&problem, &rest).unwrap();
    assert!(solution.reached);

    let transforms: Vec<_> = skeleton
        .pose(&solution.q)
        .unwrap()
        .skinning_transforms(skeleton)
        .map(|transform| single_precision_transform(&transform))
        .collect();
    let weights = MeshWeights::from(rig.weights.clone().unwrap());
    let mesh = rig.mesh.clone().unwrap();
    for method in [SkinningMethod::LinearBlend, SkinningMethod::DualQuaternion] {
        let posed = rig.posed_mesh(&solution.q, method).unwrap();
        let by_steps = weights.mesh(method, &mesh, &transforms).unwrap();
        assert_eq!(posed.positions(), by_steps.positions());
        assert_eq!(posed.normals(), by_steps.normals());
        assert_eq!(posed.triangles(), mesh.triangles());
        assert_ne!(posed.positions(), mesh.positions());

        // A pose of the armature, and one posing for many poses.
        let mut posing = rig.posing(method).unwrap();
        assert!(!posing.has_automatic_weights());
        let mut pose = Armature::of_skeleton(skeleton).rest().clone();
        EulerPoseMap::new(skeleton)
            .pose_of(&solution.q, &mut pose)
            .unwrap();
        let of_pose = posing.mesh_of_pose(&pose).unwrap();
        let pairs = of_pose.positions().iter().zip(posed.positions());
        assert!(pairs.into_iter().all(|(a, b)| a.abs_diff_eq(*b, 1e-5)));
        assert_eq!(posing.mesh(&solution.q).unwrap(), posed);

        // Into the caller's memory, with an owned rig.
        let mut owned = RigPosing::new(Arc::new(rig.clone()), method).unwrap();
        let mut positions = vec![Vec3::ZERO; posed.positions().len()];
        let buffers = PosedVertices {
            positions: &mut positions,
            ..PosedVertices::default()
        };
        owned.deform(&solution.q, buffers).unwrap();
        assert_eq!(positions, posed.positions());
        let mut normals = vec![Vec3::ZERO; posed.normals().len()];
        let buffers = PosedVertices {
            normals: &mut normals,
            ..PosedVertices::default()
        };
        owned.deform_to_pose(&pose, buffers).unwrap();
        assert_eq!(normals, of_pose.normals());
        let short = PosedVertices {
            positions: &mut positions[1..],
            ..PosedVertices::default()
        };
        assert!(owned.deform(&solution.q, short).is_err());
    }
}

#[test]
fn missing_parts_are_reported_or_computed() {
    let mut rig = humanoid();
    let rest = rig.skeleton.model().neutral();
    let method = SkinningMethod::LinearBlend;
    let error = rig.posed_mesh(&rest[1..], method).unwrap_err();
    assert!(matches!(error, FormatError::Kinematics(_)), "{error}");
    rig.weights = None;
    let mut posing = rig.posing(method).unwrap();
    assert!(posing.has_automatic_weights());
    assert!(posing.mesh(&rest).is_ok());
    rig.mesh = None;
    let error = rig.posed_mesh(&rest, method).unwrap_err();
    assert_eq!(error.to_string(), "the rig has no mesh");
}
