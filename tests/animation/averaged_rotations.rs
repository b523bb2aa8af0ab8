//! Promise: the mean of rotation matrices is no rotation, which linear blend skinning shows. Dual quaternions give a
//! rotation.

use std::f32::consts::FRAC_PI_2;

use glam::{Affine3A, Mat3, Quat, Vec3};
use kinopt::skinning::{Deformation, DualQuaternionBlend, LinearBlend, SkinWeights};

/// The three axes under two bones of equal weight.
fn blended(deformation: &impl Deformation) -> Mat3 {
    let mut posed = [Vec3::ZERO; 3];
    deformation.positions(&Vec3::AXES, &mut posed).unwrap();
    Mat3::from_cols(posed[0], posed[1], posed[2])
}

fn shared(first: f64) -> SkinWeights {
    let mut builder = SkinWeights::builder(3, 2);
    for vertex in 0..3 {
        builder.add(vertex, 0, first).unwrap();
        builder.add(vertex, 1, 1.0 - first).unwrap();
    }
    builder.build().unwrap()
}

#[test]
fn mean_of_opposite_quarter_turns_is_singular() {
    // ½ R_x(90°) + ½ R_x(−90°) = diag(1, 0, 0), and not R_x(0°).
    let turns = [FRAC_PI_2, -FRAC_PI_2].map(|a| Affine3A::from_quat(Quat::from_rotation_x(a)));
    let weights = shared(0.5);
    let flat = blended(&LinearBlend::new(&weights, &turns).unwrap());
    assert!(
        flat.abs_diff_eq(Mat3::from_diagonal(Vec3::X), 1e-7),
        "{flat}"
    );
    assert!(flat.determinant().abs() < 1e-12);
    let turned = blended(&DualQuaternionBlend::new(&weights, &turns).unwrap());
    assert!((turned.determinant() - 1.0).abs() < 1e-5);
    assert!((turned.transpose() * turned).abs_diff_eq(Mat3::IDENTITY, 1e-5));
    // Slightly less than half a turn apart, the shortest rotation is unique, and its middle is the identity.
    let less = [1.5, -1.5].map(|a| Affine3A::from_quat(Quat::from_rotation_x(a)));
    let between = blended(&DualQuaternionBlend::new(&weights, &less).unwrap());
    assert!(between.abs_diff_eq(Mat3::IDENTITY, 1e-5), "{between}");
}

#[test]
fn matrix_blend_has_the_linear_determinant() {
    // det((1 − t) I + t R) = 1 + 2t (cos θ − 1) + 2t² (1 − cos θ): 1 only at t = 0 and t = 1.
    for angle in [0.5_f64, 1.5, 3.0] {
        let turn = Affine3A::from_quat(Quat::from_rotation_z(angle as f32));
        let transforms = [Affine3A::IDENTITY, turn];
        for t in [0.0, 0.25, 0.5, 0.8, 1.0] {
            let weights = shared(1.0 - t);
            let linear = blended(&LinearBlend::new(&weights, &transforms).unwrap());
            let expected = 1.0 - 2.0 * t * (1.0 - t) * (1.0 - angle.cos());
            assert!((f64::from(linear.determinant()) - expected).abs() < 1e-6);
            let dual = blended(&DualQuaternionBlend::new(&weights, &transforms).unwrap());
            assert!((dual.determinant() - 1.0).abs() < 1e-5);
        }
    }
}
