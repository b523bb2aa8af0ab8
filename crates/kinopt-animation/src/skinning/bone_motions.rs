//! Bone transforms as dual quaternions with separate stretches.

use glam::{Affine3A, DMat3, Mat3A, Vec3, Vec3A};
use nalgebra as na;

use super::bone_transform::{check, is_rotation};
use super::shared_scale::SharedScale;
use super::{DualQuaternion, SkinningError};
use kinopt_kinematics::SizeMismatch;
use kinopt_kinematics::spatial::Polar;

/// Rigid motion of each bone, and the stretch before it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct BoneMotions {
    pub(super) rigid: Vec<DualQuaternion>,
    /// Stretch of each bone at rest; empty if no bone stretches.
    pub(super) stretches: Vec<Affine3A>,
    /// Workspace.
    scales: Vec<f32>,
}

impl BoneMotions {
    /// Creates motions from rigid transforms, up to a scale that all bones share.
    pub(super) fn rigid(transforms: &[Affine3A], bones: usize) -> Result<Self, SkinningError> {
        let mut motions = Self::default();
        motions.set_rigid(transforms, bones)?;
        Ok(motions)
    }

    /// As [`rigid`](Self::rigid), in the memory of this object.
    pub(super) fn set_rigid(
        &mut self,
        transforms: &[Affine3A],
        bones: usize,
    ) -> Result<(), SkinningError> {
        check(transforms, bones)?;
        let not_rigid = |t: &Affine3A| !is_rotation(&t.matrix3);
        let Some(bone) = transforms.iter().position(not_rigid) else {
            self.stretches.clear();
            self.rigid.clear();
            let motions = transforms.iter().map(DualQuaternion::of_rigid);
            self.rigid.extend(motions);
            return Ok(());
        };
        let Some(shared) = SharedScale::of_transforms(transforms, &mut self.scales) else {
            return Err(SkinningError::NotRigid { bone });
        };
        let mut remaining = transforms.iter().map(|t| shared.remaining(t));
        if let Some(bone) = remaining.position(|t| not_rigid(&t)) {
            return Err(SkinningError::NotRigid { bone });
        }
        self.rigid.clear();
        let remaining = transforms.iter().map(|t| shared.remaining(t));
        self.rigid
            .extend(remaining.map(|t| DualQuaternion::of_rigid(&t)));
        self.stretches.clear();
        self.stretches.resize(transforms.len(), shared.map());
        Ok(())
    }

    /// Factors each transform as T = (rigid motion) · (stretch about the bone's pivot c). M = R S is the polar
    /// decomposition of the linear part. The stretch is v → S (v − c) + c, and the rigid motion v → R v + T c − R c.
    /// These are the two phases of Kavan et al. 2008. A scale that all bones share acts first, about the origin. A
    /// singular M has the rotation of [`Polar::of_singular`], so its bone collapses as in linear blending.
    pub(super) fn stretched(
        transforms: &[Affine3A],
        pivots: &[Vec3],
        bones: usize,
    ) -> Result<Self, SkinningError> {
        let mut motions = Self::default();
        motions.set_stretched(transforms, pivots, bones)?;
        Ok(motions)
    }

    /// As [`stretched`](Self::stretched), in the memory of this object, which an error leaves unchanged.
    pub(super) fn set_stretched(
        &mut self,
        transforms: &[Affine3A],
        pivots: &[Vec3],
        bones: usize,
    ) -> Result<(), SkinningError> {
        check(transforms, bones)?;
        SizeMismatch::check("pivots", pivots.len(), bones)?;
        let shared = SharedScale::of_transforms(transforms, &mut self.scales);
        let (old, old_stretches) = (self.rigid.len(), self.stretches.len());
        for (bone, (transform, pivot)) in transforms.iter().zip(pivots).enumerate() {
            match factor_transform(transform, *pivot, shared) {
                Ok((rigid, stretch)) => {
                    self.rigid.push(DualQuaternion::of_rigid(&rigid));
                    self.stretches.push(stretch);
                }
                Err(error) => {
                    self.rigid.truncate(old);
                    self.stretches.truncate(old_stretches);
                    return Err(error(bone));
                }
            }
        }
        self.rigid.drain(..old);
        self.stretches.drain(..old_stretches);
        Ok(())
    }

    /// Σ_j w_j (stretch of bone j); `None` if no bone stretches.
    pub(super) fn stretch(
        &self,
        influences: impl Iterator<Item = (usize, f32)>,
    ) -> Option<Affine3A> {
        if self.stretches.is_empty() {
            return None;
        }
        let mut sum = Affine3A::ZERO;
        for (bone, weight) in influences {
            if let Some(stretch) = self.stretches.get(bone) {
                sum.matrix3 += stretch.matrix3 * weight;
                sum.translation += stretch.translation * weight;
            }
        }
        Some(sum)
    }
}

/// Factors a transform into a stretch about the pivot, after the shared scale, and a rigid motion. An error is a
/// function of the bone index.
fn factor_transform(
    transform: &Affine3A,
    pivot: Vec3,
    shared: Option<SharedScale>,
) -> Result<(Affine3A, Affine3A), fn(usize) -> SkinningError> {
    let (transform, pivot) = match shared {
        None => (*transform, pivot),
        Some(shared) => (
            shared.remaining(transform),
            shared.map().transform_point3(pivot),
        ),
    };
    if !pivot.is_finite() {
        return Err(|bone| SkinningError::NonFinitePivot { bone });
    }
    let Some(polar) = polar(&transform.matrix3) else {
        return Err(|bone| SkinningError::NonFiniteTransform { bone });
    };
    if polar.thickness < -RANK_TOLERANCE && polar.middle > RANK_TOLERANCE {
        return Err(|bone| SkinningError::Mirrored { bone });
    }
    let [rotation, stretch] = [polar.rotation, polar.stretch].map(single_precision_matrix);
    let pivot = Vec3A::from(pivot);
    let rigid = Affine3A {
        matrix3: rotation,
        translation: transform.transform_point3a(pivot) - rotation * pivot,
    };
    let stretch = Affine3A {
        matrix3: stretch,
        translation: pivot - stretch * pivot,
    };
    let stretch = shared.map_or(stretch, |shared| stretch * shared.map());
    Ok((rigid, stretch))
}

/// Ratio to the largest stretch up to which a stretch is 0 up to rounding in single precision.
const RANK_TOLERANCE: f64 = 1e-5;
/// Largest ratio of the smallest to the largest stretch at which the determinant has no reliable sign in double
/// precision.
const MIN_STRETCH_RATIO: f64 = 1e-9;

/// M = R S with a rotation R. S is symmetric up to rounding. `None` for a matrix that is not finite.
fn polar(matrix: &Mat3A) -> Option<Polar> {
    let entries = matrix.to_cols_array().map(f64::from);
    let matrix = na::Matrix3::from_column_slice(&entries);
    let polar = Polar::new(&matrix)?;
    let is_flat = (-RANK_TOLERANCE..=MIN_STRETCH_RATIO).contains(&polar.thickness);
    match is_flat || polar.middle <= RANK_TOLERANCE {
        true => Polar::of_singular(&matrix, RANK_TOLERANCE),
        false => Some(polar),
    }
}

fn single_precision_matrix(matrix: na::Matrix3<f64>) -> Mat3A {
    Mat3A::from(DMat3::from_cols_slice(matrix.as_slice()).as_mat3())
}
