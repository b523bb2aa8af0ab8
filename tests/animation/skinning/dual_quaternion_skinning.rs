//! Promise: dual quaternion skinning moves rigid parts rigidly, blends along the short arc, and rejects transforms that
//! dual quaternions cannot represent.

use std::f32::consts::PI;

use glam::{Affine3A, Mat3, Mat3A, Quat, Vec3};
use kinopt::skinning::{
    Deformation, DualQuaternion, DualQuaternionBlend, LinearBlend, PackedDualQuaternionBlend,
    PackedWeights, SkinWeights, SkinningError, SkinningMethod,
};

/// One vertex for each row of weights.
fn weights(rows: &[&[f64]]) -> SkinWeights {
    let mut builder = SkinWeights::builder(rows.len(), rows[0].len());
    for (vertex, row) in rows.iter().enumerate() {
        for (bone, &weight) in row.iter().enumerate() {
            builder.add(vertex, bone, weight).unwrap();
        }
    }
    builder.build().unwrap()
}

fn about(pivot: Vec3, rotation: Quat) -> Affine3A {
    Affine3A::from_translation(pivot)
        * Affine3A::from_quat(rotation)
        * Affine3A::from_translation(-pivot)
}

fn posed(weights: &SkinWeights, transforms: &[Affine3A], rest: &[Vec3]) -> Vec<Vec3> {
    let mut out = vec![Vec3::ZERO; rest.len()];
    let blend = DualQuaternionBlend::new(weights, transforms).unwrap();
    blend.positions(rest, &mut out).unwrap();
    out
}

#[test]
fn single_bone_moves_by_its_transform() {
    let weights = weights(&[&[1.0, 0.0], &[0.0, 1.0]]);
    let turn = Quat::from_axis_angle(Vec3::new(1.0, -2.0, 0.5).normalize(), 2.7);
    let transforms = [
        Affine3A::from_rotation_translation(turn, Vec3::new(3.0, -1.0, 0.25)),
        about(Vec3::new(0.0, 2.0, 0.0), Quat::from_rotation_x(PI)),
    ];
    let rest = [Vec3::new(0.3, 0.7, -1.1), Vec3::new(-0.4, 0.2, 0.9)];
    for ((posed, transform), rest) in posed(&weights, &transforms, &rest)
        .iter()
        .zip(&transforms)
        .zip(rest)
    {
        assert!((*posed - transform.transform_point3(rest)).length() < 2e-6);
    }
}

/// Between rotations about one axis the blend rotates about that axis and keeps the distance from it. The half angle is
/// the arctangent of mean sine over mean cosine.
#[test]
fn blended_rotations_keep_the_axis_distance() {
    let pivot = Vec3::new(0.5, 1.0, 0.0);
    for share in [0.1, 0.25, 0.5, 0.8] {
        let weights = weights(&[&[1.0 - share, share]]);
        let angle = 2.9_f64;
        let rotated = about(pivot, Quat::from_rotation_z(angle as f32));
        let rest = pivot + Vec3::new(2.0, 0.0, 0.7);
        let actual = posed(&weights, &[Affine3A::IDENTITY, rotated], &[rest])[0] - pivot;
        let half = (share * (angle / 2.0).sin()).atan2(1.0 - share + share * (angle / 2.0).cos());
        let (sin, cos) = (2.0 * half).sin_cos();
        let expected = Vec3::new(2.0 * cos as f32, 2.0 * sin as f32, 0.7);
        assert!(
            (actual - expected).length() < 3e-6,
            "{share}: {actual} {expected}"
        );
    }
}

#[test]
fn quaternion_signs_do_not_matter() {
    // 200° in one direction is 160° in the other.
    let weights = weights(&[&[0.6, 0.4], &[0.4, 0.6]]);
    let turn = |degrees: f32| Affine3A::from_quat(Quat::from_rotation_y(degrees.to_radians()));
    let rest = [Vec3::X, Vec3::X];
    let one = posed(&weights, &[turn(170.0), turn(-170.0)], &rest);
    let same = posed(&weights, &[turn(170.0), turn(190.0)], &rest);
    for (a, b) in one.iter().zip(same) {
        assert!((*a - b).length() < 1e-6);
        // The short arc between them passes 180°, not 0°.
        assert!(a.x < -0.99);
    }
}

#[test]
fn normals_and_tangents_rotate_with_the_blend() {
    let weights = weights(&[&[0.5, 0.5]]);
    let transforms = [
        Affine3A::IDENTITY,
        Affine3A::from_quat(Quat::from_rotation_z(PI / 2.0)),
    ];
    let blend = DualQuaternionBlend::new(&weights, &transforms).unwrap();
    let (mut normal, mut tangent) = ([Vec3::ZERO], [glam::Vec4::ZERO]);
    blend
        .normals(&[Vec3::new(5.0, 0.0, 0.0)], &mut normal)
        .unwrap();
    blend
        .tangents(&[glam::Vec4::new(0.0, 2.0, 0.0, -1.0)], &mut tangent)
        .unwrap();
    let s = 0.5_f32.sqrt();
    assert!((normal[0] - Vec3::new(s, s, 0.0)).length() < 1e-6);
    assert!((tangent[0] - glam::Vec4::new(-s, s, 0.0, -1.0)).length() < 1e-6);
}

/// With one bone the two phases equal its transform, for any pivot.
#[test]
fn stretch_is_applied_at_rest() {
    let weights = weights(&[&[1.0]]);
    let matrix = Mat3A::from_quat(Quat::from_rotation_x(1.2))
        * Mat3A::from_diagonal(Vec3::new(2.0, 0.5, 1.5));
    let transform = Affine3A {
        matrix3: matrix,
        translation: Vec3::new(1.0, 2.0, 3.0).into(),
    };
    let rest = [Vec3::new(0.2, -0.4, 0.9)];
    for pivot in [Vec3::ZERO, Vec3::new(0.3, 5.0, -1.0)] {
        let blend = DualQuaternionBlend::stretched(&weights, &[transform], &[pivot]).unwrap();
        let (mut out, mut normal) = ([Vec3::ZERO], [Vec3::ZERO]);
        blend.positions(&rest, &mut out).unwrap();
        assert!((out[0] - transform.transform_point3(rest[0])).length() < 3e-6);
        blend
            .normals(&[Vec3::new(0.6, 0.0, 0.8)], &mut normal)
            .unwrap();
        let expected = matrix.inverse().transpose() * glam::Vec3A::new(0.6, 0.0, 0.8);
        assert!((normal[0] - Vec3::from(expected.normalize())).length() < 1e-6);
    }
    // Without rotation, two phases equal linear blend.
    let both = self::weights(&[&[0.3, 0.7]]);
    let scale = |factor: f32, at: Vec3| {
        Affine3A::from_translation(at)
            * Affine3A::from_scale(Vec3::splat(factor))
            * Affine3A::from_translation(-at)
    };
    let pivots = [Vec3::X, Vec3::new(0.0, 3.0, 0.0)];
    let transforms = [scale(2.0, pivots[0]), scale(0.5, pivots[1])];
    let (mut dual, mut linear) = ([Vec3::ZERO], [Vec3::ZERO]);
    let blend = DualQuaternionBlend::stretched(&both, &transforms, &pivots).unwrap();
    blend.positions(&rest, &mut dual).unwrap();
    let blend = LinearBlend::new(&both, &transforms).unwrap();
    blend.positions(&rest, &mut linear).unwrap();
    assert!((dual[0] - linear[0]).length() < 1e-6);
}

/// A bone of scale 0, or flattened along one or two axes, moves its own vertices as linear blending does. Rounding makes
/// some of these determinants negative.
#[test]
fn singular_bone_moves_as_in_linear_blending() {
    let weights = weights(&[&[1.0, 0.0], &[0.0, 1.0]]);
    let packed = PackedWeights::new(&weights).unwrap();
    let rest = [Vec3::new(0.3, 0.7, -1.1), Vec3::new(-0.4, 0.2, 0.9)];
    let pivots = [Vec3::X, Vec3::new(0.5, -0.2, 0.1)];
    let normal = Vec3::new(0.6, 0.0, 0.8);
    for scale in [
        Vec3::ZERO,
        Vec3::new(1.0, 0.0, 0.0),
        Vec3::new(0.0, -2.0, 0.0),
        Vec3::new(1.0, 0.0, 1.0),
        Vec3::new(0.0, 0.5, -1.5),
    ] {
        for step in 0..50_u8 {
            let angle = 0.37 * f32::from(step);
            let turn = Quat::from_axis_angle(Vec3::new(1.0, -2.0, 0.5).normalize(), angle);
            let axes = Quat::from_rotation_x(1.3 * angle) * Quat::from_rotation_z(0.7 * angle);
            let matrix = Mat3A::from_quat(turn)
                * Mat3A::from_diagonal(scale)
                * Mat3A::from_quat(axes).transpose();
            let singular = Affine3A {
                matrix3: matrix,
                translation: Vec3::new(1.0, 2.0, 3.0).into(),
            };
            let transforms = [Affine3A::from_quat(turn), singular];
            let blends: [&dyn Deformation; 2] = [
                &DualQuaternionBlend::stretched(&weights, &transforms, &pivots).unwrap(),
                &PackedDualQuaternionBlend::stretched(&packed, &transforms, &pivots).unwrap(),
            ];
            for blend in blends {
                let (mut out, mut normals) = ([Vec3::ZERO; 2], [Vec3::ZERO; 2]);
                blend.positions(&rest, &mut out).unwrap();
                for ((out, transform), rest) in out.iter().zip(&transforms).zip(rest) {
                    let error = (*out - transform.transform_point3(rest)).length();
                    assert!(error < 1e-5, "{scale} {step}: {error}");
                }
                blend.normals(&[normal; 2], &mut normals).unwrap();
                assert!(normals.iter().all(|normal| normal.is_finite()));
            }
        }
    }
}

/// Without rotation, the two phases equal linear blending, also next to a bone of scale 0 at its pivot.
#[test]
fn vertex_of_a_hidden_bone_blends_linearly() {
    let weights = weights(&[&[0.3, 0.7]]);
    let pivots = [Vec3::ZERO, Vec3::new(0.5, 2.0, 0.0)];
    let hidden = Affine3A::from_translation(pivots[1])
        * Affine3A::from_scale(Vec3::ZERO)
        * Affine3A::from_translation(-pivots[1]);
    let transforms = [Affine3A::IDENTITY, hidden];
    let rest = [Vec3::new(0.2, -0.4, 0.9)];
    let (mut dual, mut linear) = ([Vec3::ZERO], [Vec3::ZERO]);
    let blend = DualQuaternionBlend::stretched(&weights, &transforms, &pivots).unwrap();
    blend.positions(&rest, &mut dual).unwrap();
    let blend = LinearBlend::new(&weights, &transforms).unwrap();
    blend.positions(&rest, &mut linear).unwrap();
    assert!((dual[0] - linear[0]).length() < 1e-6);
}

/// A matrix that flattens space to a line has many closest rotations. The smallest one is used, so that blended vertices
/// do not turn about the line.
#[test]
fn flattened_bone_rotates_by_the_smallest_angle() {
    let weights = weights(&[&[0.5, 0.5]]);
    let pivots = [Vec3::ZERO; 2];
    let rest = [Vec3::new(0.2, -0.4, 0.9)];
    let line = Affine3A::from_scale(Vec3::new(0.0, 1.0, 0.0));
    let transforms = [Affine3A::IDENTITY, line];
    let mut out = [Vec3::ZERO];
    let blend = DualQuaternionBlend::stretched(&weights, &transforms, &pivots).unwrap();
    blend.positions(&rest, &mut out).unwrap();
    let expected = Vec3::new(0.1, -0.4, 0.45);
    assert!((out[0] - expected).length() < 1e-6, "{}", out[0]);
}

#[test]
fn non_rigid_transforms_are_rejected_by_name() {
    let weights = weights(&[&[0.5, 0.5]]);
    let with = |second: Affine3A| [Affine3A::IDENTITY, second];
    let scaled = with(Affine3A::from_scale(Vec3::new(1.0, 1.0, 1.01)));
    let refused = DualQuaternionBlend::new(&weights, &scaled).unwrap_err();
    assert_eq!(refused, SkinningError::NotRigid { bone: 1 });
    assert!(refused.to_string().contains("bone 1"));
    // Unit columns, two of them not orthogonal.
    for (a, b) in [(0, 1), (1, 2), (2, 0)] {
        let mut sheared = Affine3A::IDENTITY;
        let column = |k: usize| glam::Vec3A::AXES[k];
        *sheared.matrix3.col_mut(b) = 0.6 * column(a) + 0.8 * column(b);
        assert_eq!(
            DualQuaternionBlend::new(&weights, &with(sheared)).unwrap_err(),
            SkinningError::NotRigid { bone: 1 },
            "{a} {b}"
        );
    }
    let mirror = with(Affine3A::from_scale(Vec3::new(1.0, 1.0, -1.0)));
    assert_eq!(
        DualQuaternionBlend::new(&weights, &mirror).unwrap_err(),
        SkinningError::NotRigid { bone: 1 }
    );
    let pivots = [Vec3::ZERO; 2];
    assert_eq!(
        DualQuaternionBlend::stretched(&weights, &mirror, &pivots).unwrap_err(),
        SkinningError::Mirrored { bone: 1 }
    );
    let still = with(Affine3A::IDENTITY);
    let message = DualQuaternionBlend::stretched(&weights, &still, &pivots[..1]);
    let message = message.unwrap_err().to_string();
    assert_eq!(message, "1 pivots given, expected 2");
    assert_eq!(
        DualQuaternionBlend::stretched(&weights, &still, &[Vec3::ZERO, Vec3::NAN]).unwrap_err(),
        SkinningError::NonFinitePivot { bone: 1 }
    );
    let unknown = with(Affine3A::from_translation(Vec3::new(f32::NAN, 0.0, 0.0)));
    for method in SkinningMethod::ALL {
        let mesh = kinopt::mesh::TriangleMesh::new(vec![Vec3::ONE], vec![], vec![]).unwrap();
        assert_eq!(
            method.mesh(&mesh, &weights, &unknown).unwrap_err(),
            SkinningError::NonFiniteTransform { bone: 1 }
        );
    }
    for zero in [
        Quat::from_xyzw(0.0, 0.0, 0.0, 0.0),
        Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0),
    ] {
        let refused = DualQuaternion::from_rotation_translation(zero, Vec3::ONE).unwrap_err();
        assert!(matches!(refused, SkinningError::ZeroQuaternion { .. }));
    }
}

#[test]
fn long_quaternion_is_normalised() {
    let turn = Quat::from_rotation_z(1.0);
    let long = Quat::from_vec4(glam::Vec4::from(turn) * 7.0);
    let motion = DualQuaternion::from_rotation_translation(long, Vec3::Y).unwrap();
    let moved = motion.transform_point(Vec3::X);
    assert!((moved - (turn * Vec3::X + Vec3::Y)).length() < 1e-6);
    // Directions are rotated only, also by a blend, whose norm is not 1.
    let blend = motion * 0.3 + motion * 0.4;
    for part in [motion, blend] {
        let turned = part.transform_vector(Vec3::new(0.2, -0.4, 0.7));
        assert!((turned - turn * Vec3::new(0.2, -0.4, 0.7)).length() < 1e-6);
    }
    // Its weight in a blend equals that of a unit quaternion.
    assert!((motion.real.length() - 1.0).abs() < 1e-6);
    let still = DualQuaternion::from_rotation_translation(Quat::IDENTITY, Vec3::ZERO).unwrap();
    let short = DualQuaternion::from_rotation_translation(turn, Vec3::Y).unwrap();
    let [a, b] = [motion, short].map(|part| (part + still).transform_point(Vec3::X));
    assert!((a - b).length() < 1e-6, "{a} {b}");
}

#[test]
fn methods_have_names() {
    for method in SkinningMethod::ALL {
        assert_eq!(method.name().parse(), Ok(method));
    }
    let unknown = "dq".parse::<SkinningMethod>().unwrap_err();
    assert!(unknown.to_string().contains("lbs") && unknown.to_string().contains("dqs"));
}

/// Half turns about (1, −0.99, 0) and (−0.99, 1, 0) are nearly one rotation. A matrix gives the quaternion with a
/// positive largest component, so the two are in opposite hemispheres and their plain sum is nearly zero.
#[test]
fn quaternions_of_opposite_hemispheres_blend() {
    let weights = weights(&[&[0.5, 0.5]]);
    let packed = PackedWeights::new(&weights).unwrap();
    let turns = [[1.0, -0.99], [-0.99, 1.0]].map(|[x, y]| {
        let axis = Vec3::new(x, y, 0.0).normalize();
        Affine3A::from_mat3(Mat3::from_axis_angle(axis, PI))
    });
    let [a, b] = turns.map(|turn| Quat::from_mat3a(&turn.matrix3));
    assert!(a.dot(b) < -0.99);
    let rest = [Vec3::new(3.0, 1.0, 0.5)];
    let blends: [&dyn Deformation; 2] = [
        &DualQuaternionBlend::new(&weights, &turns).unwrap(),
        &PackedDualQuaternionBlend::new(&packed, &turns).unwrap(),
    ];
    for blend in blends {
        let mut posed = [Vec3::ZERO];
        blend.positions(&rest, &mut posed).unwrap();
        // The half turn about (1, −1, 0): p → 2 (a·p) a − p.
        let [posed] = posed;
        assert!(
            (posed - Vec3::new(-1.0, -3.0, -0.5)).length() < 1e-5,
            "{posed}"
        );
    }
}

/// A scale or reflection common to all bones transforms the blend as a whole.
#[test]
fn shared_scale_and_mirror_scale_the_blend() {
    let weights = weights(&[&[0.5, 0.3, 0.2], &[0.1, 0.2, 0.7], &[0.0, 0.5, 0.5]]);
    let rest = [
        Vec3::new(100.0, 3.0, -8.0),
        Vec3::new(40.0, -20.0, 11.0),
        Vec3::ZERO,
    ];
    let bend = Quat::from_rotation_z(0.6);
    let twist = Quat::from_axis_angle(Vec3::new(1.0, 2.0, -0.5).normalize(), 2.0);
    let rigid = [
        Affine3A::IDENTITY,
        about(Vec3::new(100.0, 0.0, 0.0), bend),
        Affine3A::from_rotation_translation(twist, Vec3::new(9.0, -4.0, 30.0)),
    ];
    let pivots = [Vec3::ZERO, Vec3::new(100.0, 0.0, 0.0), Vec3::ONE];
    let expected = posed(&weights, &rigid, &rest);
    let packed = PackedWeights::new(&weights).unwrap();
    for scale in [
        Vec3::splat(0.01),
        Vec3::splat(2.54),
        Vec3::new(-1.0, 1.0, 1.0),
        Vec3::new(0.4, -0.4, 0.4),
        Vec3::splat(-0.01),
    ] {
        let motion = Affine3A::from_rotation_translation(twist, Vec3::new(1.0, 2.0, 3.0))
            * Affine3A::from_scale(scale);
        let transforms = rigid.map(|bone| motion * bone);
        let blends: [Box<dyn Deformation>; 3] = [
            Box::new(DualQuaternionBlend::new(&weights, &transforms).unwrap()),
            Box::new(DualQuaternionBlend::stretched(&weights, &transforms, &pivots).unwrap()),
            Box::new(PackedDualQuaternionBlend::stretched(&packed, &transforms, &pivots).unwrap()),
        ];
        for blend in blends {
            let mut out = [Vec3::ZERO; 3];
            blend.positions(&rest, &mut out).unwrap();
            for (out, expected) in out.iter().zip(&expected) {
                let expected = motion.transform_point3(*expected);
                let error = (*out - expected).length();
                assert!(
                    error < 1e-5 * (1.0 + 100.0 * scale.x.abs()),
                    "{scale}: {error}"
                );
            }
        }
    }
}

/// A file in centimetres below a root of scale 0.01, bent by 30° at (100, 0, 0). Both bones take this point to (1, 0,
/// 0).
#[test]
fn scaled_bones_keep_the_point_of_their_joint() {
    let weights = weights(&[&[1.0, 0.0], &[0.5, 0.5], &[0.0, 1.0]]);
    let joint = Vec3::new(100.0, 0.0, 0.0);
    let rest = [Vec3::ZERO, joint, 2.0 * joint];
    let scale = Affine3A::from_scale(Vec3::splat(0.01));
    let bend = about(joint, Quat::from_rotation_z(PI / 6.0));
    let transforms = [scale, scale * bend];
    let blend = DualQuaternionBlend::stretched(&weights, &transforms, &[Vec3::ZERO, joint]);
    let mut out = [Vec3::ZERO; 3];
    blend.unwrap().positions(&rest, &mut out).unwrap();
    assert!((out[1] - Vec3::X).length() < 1e-6, "{}", out[1]);
}
