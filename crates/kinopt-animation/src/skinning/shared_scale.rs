//! Scale that all bones of a pose share.
//!
//! A file in centimetres below a root in metres, or below a mirrored root, scales all bones equally. This scale is
//! applied to the rest mesh before skinning, so that the remaining transforms are rigid.

use glam::{Affine3A, Mat3A, Vec3};

use super::bone_transform::ROTATION_TOLERANCE;

/// The map v → (± s v_x, s v_y, s v_z) of rest positions, s > 0. The sign is negative if most bones mirror.
///
/// Blends of dual quaternions do not depend on the axis of the mirror: another axis multiplies all motions by one
/// rotation from the right.
#[derive(Clone, Copy, Debug)]
pub(super) struct SharedScale(Vec3);

impl SharedScale {
    /// The median scale of the bones, which single scaled bones do not change. Of two middle scales the one nearer to 1
    /// counts. `scales` is a workspace. `None` for a scale within 1e-4 of 1, the tolerance of rigid transforms.
    pub(super) fn of_transforms(transforms: &[Affine3A], scales: &mut Vec<f32>) -> Option<Self> {
        scales.clear();
        scales.extend(transforms.iter().map(|t| scale_of(&t.matrix3)));
        scales.sort_unstable_by(f32::total_cmp);
        let middle = [scales.len().saturating_sub(1) / 2, scales.len() / 2];
        let [lower, upper] = middle.map(|index| scales.get(index).copied().unwrap_or(1.0));
        let from_1 = |scale: f32| (scale - 1.0).abs();
        let median = match from_1(lower) <= from_1(upper) {
            true => lower,
            false => upper,
        };
        if from_1(median) <= ROTATION_TOLERANCE || !median.is_normal() {
            return None;
        }
        Some(Self(Vec3::new(median, median.abs(), median.abs())))
    }

    /// The scale as a transform.
    pub(super) fn map(self) -> Affine3A {
        Affine3A::from_scale(self.0)
    }

    /// The part of a transform after this scale.
    pub(super) fn remaining(self, transform: &Affine3A) -> Affine3A {
        *transform * Affine3A::from_scale(self.0.recip())
    }
}

/// Root mean square of the axis lengths; negative if the matrix mirrors.
fn scale_of(matrix: &Mat3A) -> f32 {
    let axes = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let squares: f32 = axes.iter().map(|axis| axis.length_squared()).sum();
    (squares / 3.0).sqrt().copysign(matrix.determinant())
}
