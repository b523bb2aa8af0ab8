//! Bone transforms in single precision, and checks of them.

use glam::{Affine3A, Mat3A};

use super::SkinningError;
use kinopt_kinematics::SizeMismatch;
use kinopt_kinematics::spatial::Placement;

/// Largest deviation of an entry of MᵀM from the identity at which M counts as a rotation. Products along a chain of
/// bones in single precision stay far below it.
pub(super) const ROTATION_TOLERANCE: f32 = 1e-4;

/// A bone's transform T = W T̂⁻¹ (rest model → posed model) in single precision.
#[must_use]
pub fn single_precision_transform(posed_from_rest: &Placement<f64>) -> Affine3A {
    Affine3A::from(*posed_from_rest)
}

/// Checks that there is one finite transform per bone.
pub(super) fn check(transforms: &[Affine3A], bones: usize) -> Result<(), SkinningError> {
    SizeMismatch::check("bone transforms", transforms.len(), bones)?;
    match transforms.iter().position(|t| !t.is_finite()) {
        Some(bone) => Err(SkinningError::NonFiniteTransform { bone }),
        None => Ok(()),
    }
}

/// Reports whether M is a rotation: MᵀM is the identity and det M > 0.
pub(super) fn is_rotation(matrix: &Mat3A) -> bool {
    let (x, y, z) = (matrix.x_axis, matrix.y_axis, matrix.z_axis);
    let is_near = |value: f32, expected: f32| (value - expected).abs() <= ROTATION_TOLERANCE;
    is_near(x.length_squared(), 1.0)
        && is_near(y.length_squared(), 1.0)
        && is_near(z.length_squared(), 1.0)
        && is_near(x.dot(y), 0.0)
        && is_near(y.dot(z), 0.0)
        && is_near(z.dot(x), 0.0)
        && x.dot(y.cross(z)) > 0.0
}
