//! Promise: point handles deform a mesh like bones, each about its own point.

use glam::{Affine3A, Mat3A, Quat, Vec3};
use kinopt::animation::{Armature, ArmatureBone, LocalTransform};
use kinopt::skinning::{Deformation, LinearBlend, PointHandle, SkinWeights};

/// A rod of eleven points between two handles with linear weights.
fn rod() -> (Vec<Vec3>, SkinWeights) {
    let mut builder = SkinWeights::builder(11, 2);
    for k in 0..11 {
        let share = k as f64 / 10.0;
        builder.add(k, 0, 1.0 - share).unwrap();
        builder.add(k, 1, share).unwrap();
    }
    let points = (0..11)
        .map(|k| Vec3::new(0.1 * k as f32, 0.0, 0.0))
        .collect();
    (points, builder.build().unwrap())
}

fn posed(handles: &[PointHandle]) -> Vec<Vec3> {
    let (points, weights) = rod();
    let transforms = PointHandle::transforms(handles);
    let mut out = points.clone();
    let blend = LinearBlend::new(&weights, &transforms).unwrap();
    blend.positions(&points, &mut out).unwrap();
    out
}

#[test]
fn translation_is_scaled_by_the_weight() {
    let drag = Vec3::new(0.0, 2.0, -1.0);
    let handles = [
        PointHandle::at(Vec3::ZERO),
        PointHandle::at(Vec3::X).moved_to(Vec3::X + drag),
    ];
    for (k, p) in posed(&handles).into_iter().enumerate() {
        let share = 0.1 * k as f32;
        assert!((p - (Vec3::new(share, 0.0, 0.0) + share * drag)).length() < 1e-6);
    }
}

#[test]
fn rotation_and_stretch_keep_the_handle_fixed() {
    let linear = Mat3A::from_quat(Quat::from_rotation_z(1.1)) * 3.0;
    let handles = [
        PointHandle::at(Vec3::ZERO),
        PointHandle::at(Vec3::X).turned_by(linear),
    ];
    let posed = posed(&handles);
    assert!((posed[10] - Vec3::X).length() < 1e-6);
    // Halfway: the mean of its rest position and its position under the rotated handle.
    let taken = Vec3::X + Vec3::from(linear * glam::Vec3A::new(-0.5, 0.0, 0.0));
    assert!((posed[5] - 0.5 * (Vec3::new(0.5, 0.0, 0.0) + taken)).length() < 1e-6);
}

#[test]
fn common_motion_is_exact() {
    let linear = Mat3A::from_quat(Quat::from_rotation_x(0.4))
        * Mat3A::from_diagonal(Vec3::new(1.0, 2.0, 0.5));
    let shift = Vec3::new(1.0, 2.0, 3.0);
    let moved = |rest: Vec3| Vec3::from(linear * glam::Vec3A::from(rest)) + shift;
    let handles = [Vec3::ZERO, Vec3::X].map(|rest| {
        PointHandle::at(rest)
            .moved_to(moved(rest))
            .turned_by(linear)
    });
    let (points, _) = rod();
    for (posed, rest) in posed(&handles).into_iter().zip(points) {
        assert!((posed - moved(rest)).length() < 1e-6);
    }
}

#[test]
fn root_bone_acts_as_a_handle() {
    let rests = [Vec3::new(0.5, -1.0, 2.0), Vec3::X];
    let standing = |position: Vec3| LocalTransform {
        translation: position.into(),
        ..LocalTransform::IDENTITY
    };
    let bones = rests.iter().enumerate().map(|(k, &rest)| ArmatureBone {
        name: format!("handle {k}"),
        parent: None,
        rest: standing(rest),
    });
    let armature = Armature::new(bones.collect(), vec![]).unwrap();
    let mut pose = armature.rest().clone();
    let mut handles = Vec::new();
    for (k, &rest) in rests.iter().enumerate() {
        let local = LocalTransform {
            translation: (rest + Vec3::new(0.3, 0.2, -0.7)).into(),
            rotation: Quat::from_rotation_y(0.9 + k as f32),
            scale: Vec3::new(1.0, 2.0, 0.5).into(),
        };
        pose.set_local(armature.bone_at(k).unwrap(), local).unwrap();
        let turned = PointHandle::at(rest).turned_by(local.to_affine().matrix3);
        handles.push(turned.moved_to(local.translation.into()));
    }
    let mut model = [Affine3A::IDENTITY; 2];
    let mut skin = model;
    armature.local_to_model(&pose, &mut model).unwrap();
    armature.skinning_transforms(&model, &mut skin).unwrap();
    for (bone, handle) in skin.iter().zip(PointHandle::transforms(&handles)) {
        assert!(bone.abs_diff_eq(handle, 1e-6), "{bone} {handle}");
    }
}
