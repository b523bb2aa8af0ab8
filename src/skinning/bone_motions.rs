//! The transforms of a pose as dual quaternions, with what they stretch apart.

use glam::{Affine3A, DMat3, Mat3A, Vec3, Vec3A};

use super::bone_transform::{check, is_rotation};
use super::{DualQuaternion, SkinningError};

/// Each bone's rigid motion, and where a pose stretches, what is done before it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct BoneMotions {
    pub(super) rigid: Vec<DualQuaternion>,
    /// Empty, or by bone the stretch at rest.
    pub(super) stretches: Vec<Affine3A>,
}

impl BoneMotions {
    /// Motions that turn and shift only.
    pub(super) fn rigid(transforms: &[Affine3A], bones: usize) -> Result<Self, SkinningError> {
        check(transforms, bones)?;
        if let Some(bone) = transforms.iter().position(|t| !is_rotation(&t.matrix3)) {
            return Err(SkinningError::NotRigid { bone });
        }
        Ok(Self {
            rigid: transforms.iter().map(DualQuaternion::of_rigid).collect(),
            stretches: Vec::new(),
        })
    }

    /// T = (rigid motion) · (stretch about the bone's pivot): with the polar decomposition M = R S of
    /// the linear part and the pivot c, the stretch is v → S (v − c) + c and the rigid motion is
    /// v → R v + T c − R c (Kavan et al. 2008, section 4.2, two phases).
    pub(super) fn stretched(
        transforms: &[Affine3A],
        pivots: &[Vec3],
        bones: usize,
    ) -> Result<Self, SkinningError> {
        check(transforms, bones)?;
        if pivots.len() != bones {
            return Err(SkinningError::TransformCount {
                given: pivots.len(),
                bones,
            });
        }
        let mut motions = Self::default();
        for (bone, (transform, pivot)) in transforms.iter().zip(pivots).enumerate() {
            if !pivot.is_finite() {
                return Err(SkinningError::NonFiniteTransform { bone });
            }
            let pivot = Vec3A::from(*pivot);
            let (rotation, stretch) =
                polar(&transform.matrix3).ok_or(SkinningError::Mirrored { bone })?;
            motions.rigid.push(DualQuaternion::of_rigid(&Affine3A {
                matrix3: rotation,
                translation: transform.transform_point3a(pivot) - rotation * pivot,
            }));
            motions.stretches.push(Affine3A {
                matrix3: stretch,
                translation: pivot - stretch * pivot,
            });
        }
        Ok(motions)
    }
}

/// M = R S with R a rotation and S symmetric, by singular values; `None` when det M ≤ 0.
fn polar(matrix: &Mat3A) -> Option<(Mat3A, Mat3A)> {
    let wide = DMat3::from_cols(
        matrix.x_axis.as_dvec3(),
        matrix.y_axis.as_dvec3(),
        matrix.z_axis.as_dvec3(),
    );
    let m = nalgebra::Matrix3::from_column_slice(&wide.to_cols_array());
    let svd = m.svd(true, true);
    let (u, v_t) = (svd.u?, svd.v_t?);
    let flat = svd.singular_values.min() <= 1e-9 * svd.singular_values.max();
    if flat || m.determinant() <= 0.0 {
        return None;
    }
    let rotation = u * v_t;
    let stretch = v_t.transpose() * nalgebra::Matrix3::from_diagonal(&svd.singular_values) * v_t;
    let narrow = |m: nalgebra::Matrix3<f64>| {
        let columns: [f64; 9] = m.data.as_slice().try_into().unwrap_or_default();
        Mat3A::from_cols_array(&columns.map(|entry| entry as f32))
    };
    Some((narrow(rotation), narrow(stretch)))
}
