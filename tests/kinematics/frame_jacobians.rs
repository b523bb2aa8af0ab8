//! Promise: frame Jacobians equal finite differences of forward kinematics and products of screw exponentials. Linear
//! rows come first, in world axes at the frame's origin; each column is a coordinate or variable.

use kinopt::kinematics::{ForwardKinematics, Jacobian, KinematicsError, frame_jacobian};
use kinopt::model::{JointKind, ParameterMap};
use kinopt::spatial::rotation_log;
use nalgebra::{DMatrix, Matrix3, Matrix4, Matrix6, Vector3, Vector6};
use support::random::Random;
use support::trees::RandomTree;

/// Exponential of a unit screw times q: about the axis w through the point p, or along w.
fn exponential(kind: JointKind, w: &Vector3<f64>, p: &Vector3<f64>, q: f64) -> Matrix4<f64> {
    let mut motion = Matrix4::identity();
    if kind == JointKind::Prismatic {
        motion.fixed_view_mut::<3, 1>(0, 3).copy_from(&(w * q));
        return motion;
    }
    let hat = w.cross_matrix();
    let turn = Matrix3::identity() + hat * q.sin() + hat * hat * (1.0 - q.cos());
    motion.fixed_view_mut::<3, 3>(0, 0).copy_from(&turn);
    motion
        .fixed_view_mut::<3, 1>(0, 3)
        .copy_from(&(p - turn * p));
    motion
}

/// Adjoint of a motion on twists (velocity at the world's origin, angular velocity).
fn adjoint(motion: &Matrix4<f64>) -> Matrix6<f64> {
    let turn = motion.fixed_view::<3, 3>(0, 0).into_owned();
    let shift = motion.fixed_view::<3, 1>(0, 3).into_owned();
    let mut adjoint = Matrix6::zeros();
    adjoint.fixed_view_mut::<3, 3>(0, 0).copy_from(&turn);
    adjoint.fixed_view_mut::<3, 3>(3, 3).copy_from(&turn);
    let across = shift.cross_matrix() * turn;
    adjoint.fixed_view_mut::<3, 3>(0, 3).copy_from(&across);
    adjoint
}

/// 6 × degrees of freedom, by Lynch & Park 2017, "Modern Robotics", eq. 5.11, shifted to the frame.
fn by_exponentials(tree: &RandomTree, frame: usize, q: &[f64]) -> DMatrix<f64> {
    let zeros = vec![0.0; q.len()];
    let home = tree.frames_at(&zeros);
    let mut jacobian = DMatrix::zeros(6, q.len());
    let mut path = Vec::new();
    let mut next = tree.frame_offsets[frame].0;
    while let Some(joint) = next {
        path.insert(0, joint);
        next = tree.parts[joint].parent;
    }
    let mut before = Matrix4::identity();
    for joint in path {
        let part = &tree.parts[joint];
        let Some(column) = tree.model.coordinate(tree.joints[joint]) else {
            continue;
        };
        // Every joint carries one frame, whose offset leads back to the joint.
        let hung = tree
            .frame_offsets
            .iter()
            .position(|(on, _)| *on == Some(joint))
            .unwrap();
        let at_zero = home[hung] * tree.frame_offsets[hung].1.inverse();
        let w = at_zero.rotation * part.axis.into_inner();
        let p = at_zero.translation.vector;
        let screw = match part.kind {
            JointKind::Prismatic => Vector6::new(w.x, w.y, w.z, 0.0, 0.0, 0.0),
            _ => {
                let v = -w.cross(&p);
                Vector6::new(v.x, v.y, v.z, w.x, w.y, w.z)
            }
        };
        jacobian
            .column_mut(column)
            .copy_from(&(adjoint(&before) * screw));
        before *= exponential(part.kind, &w, &p, q[column]);
    }
    let origin = tree.frames_at(q)[frame].translation.vector;
    for mut column in jacobian.column_iter_mut() {
        let turning = Vector3::new(column[3], column[4], column[5]);
        let carried = turning.cross(&origin);
        for k in 0..3 {
            column[k] += carried[k];
        }
    }
    jacobian
}

#[test]
fn jacobian_equals_screw_exponentials() {
    for seed in 0..20 {
        let tree = RandomTree::new(seed, 9);
        let q = tree.configuration(&mut Random::new(seed));
        for (frame, &id) in tree.frames.iter().enumerate() {
            let jacobian = frame_jacobian(&tree.model, id, &q).unwrap();
            let expected = by_exponentials(&tree, frame, &q);
            assert_eq!(jacobian.shape(), expected.shape());
            let deviation = (&jacobian - &expected).amax();
            assert!(
                deviation < 1e-13,
                "seed {seed}, frame {frame}: {deviation:e}"
            );
        }
    }
}

/// Jacobians are computed relative to the root, so a distant world origin costs no precision.
#[test]
fn distant_origin_costs_no_precision() {
    let world_from_base = support::rigid(
        nalgebra::Rotation3::identity(),
        Vector3::new(1e8, -2e8, 3e8),
    );
    for seed in 0..10 {
        let [at_origin, displaced] = [support::Rigid::identity(), world_from_base]
            .map(|world_from_base| RandomTree::placed(seed, 9, world_from_base));
        let q = at_origin.configuration(&mut Random::new(seed));
        for (&id, &other) in at_origin.frames.iter().zip(&displaced.frames) {
            let expected = frame_jacobian(&at_origin.model, id, &q).unwrap();
            let deviation =
                (frame_jacobian(&displaced.model, other, &q).unwrap() - expected).amax();
            assert!(deviation < 1e-13, "seed {seed}: {deviation:e}");
        }
    }
}

#[test]
fn jacobian_of_all_frames_matches_differences() {
    const H: f64 = 1e-6;
    for seed in 0..10 {
        let tree = RandomTree::new(seed, 8);
        let q = tree.configuration(&mut Random::new(seed));
        let mut jacobian = Jacobian::new(ForwardKinematics::new(&tree.model));
        let jacobian = jacobian.at(&q).unwrap();
        assert_eq!(jacobian.shape(), (6 * tree.frames.len(), q.len()));
        let mut kinematics = ForwardKinematics::new(&tree.model);
        for j in 0..q.len() {
            let [back, on] = [-H, H].map(|step| {
                let mut moved = q.clone();
                moved[j] += step;
                kinematics.place(&moved).unwrap().to_vec()
            });
            for (k, (back, on)) in back.iter().zip(&on).enumerate() {
                let velocity = (on.translation - back.translation) * (0.5 / H);
                let turn = rotation_log(&(on.rotation * back.rotation.transpose())) * (0.5 / H);
                let twist = [velocity.to_array(), turn.to_array()].concat();
                for (i, expected) in twist.into_iter().enumerate() {
                    assert!((jacobian[(6 * k + i, j)] - expected).abs() < 1e-8);
                }
            }
        }
    }
}

#[test]
fn jacobian_has_requested_rows_and_columns() {
    let tree = RandomTree::new(3, 8);
    let model = &tree.model;
    let [leader, follower] = [model.moving_joints()[0], model.moving_joints()[1]];
    let map = ParameterMap::builder(model).with_coupled(follower, leader, 0.5, 0.1);
    let map = map.build().unwrap();
    let q = tree.configuration(&mut Random::new(3));
    let mut x = vec![0.0; map.variables()];
    let mut within = vec![0.0; q.len()];
    map.reduce(&q, &mut x).unwrap();
    map.expand(&x, &mut within).unwrap();

    let frame = tree.far_frame();
    let kinematics = ForwardKinematics::under(model, &map, &[frame]).unwrap();
    let mut by_variables = Jacobian::new(kinematics);
    let whole = frame_jacobian(model, frame, &within).unwrap();
    let reduced = by_variables.at(&x).unwrap();
    assert_eq!(reduced.shape(), (6, x.len()));
    let expected = whole.column(0) + whole.column(1) * 0.5;
    assert!((reduced.column(0) - expected).amax() < 1e-14);
    assert!((reduced.column(1) - whole.column(2)).amax() < 1e-14);
}

#[test]
fn invalid_configurations_and_frames_fail() {
    let (tree, larger) = (RandomTree::new(1, 3), RandomTree::new(1, 9));
    let (model, frame) = (&tree.model, tree.far_frame());
    let mut q = vec![0.0; model.degrees_of_freedom()];
    let foreign = frame_jacobian(model, larger.far_frame(), &q).unwrap_err();
    assert!(matches!(foreign, KinematicsError::ForeignFrame { .. }));
    let length = frame_jacobian(model, frame, &[]).unwrap_err();
    assert!(matches!(length, KinematicsError::Length { given: 0, .. }));
    q[1] = f64::NAN;
    let number = frame_jacobian(model, frame, &q).unwrap_err();
    assert!(matches!(
        number,
        KinematicsError::NotFinite { index: 1, .. }
    ));
}

/// Repeated evaluations depend on their configuration only.
#[test]
fn repeated_jacobian_depends_on_q_only() {
    let tree = RandomTree::new(5, 8);
    let mut random = Random::new(5);
    let mut jacobian = Jacobian::new(ForwardKinematics::new(&tree.model));
    for _ in 0..3 {
        let q = tree.configuration(&mut random);
        let mut fresh = Jacobian::new(ForwardKinematics::new(&tree.model));
        assert_eq!(jacobian.at(&q).unwrap(), fresh.at(&q).unwrap());
    }
}
