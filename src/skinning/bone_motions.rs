//! The transforms of a pose as dual quaternions, with what they stretch apart.

use glam::{Affine3A, DMat3, Mat3A, Vec3, Vec3A};
use nalgebra as na;

use super::bone_transform::{check, is_rotation};
use super::shared_scale::SharedScale;
use super::{DualQuaternion, SkinningError};
use crate::SizeMismatch;
use crate::spatial::Polar;

/// Each bone's rigid motion, and where a pose stretches, what is done before it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct BoneMotions {
    pub(super) rigid: Vec<DualQuaternion>,
    /// Empty, or by bone the stretch at rest.
    pub(super) stretches: Vec<Affine3A>,
    /// Scratch memory.
    scales: Vec<f32>,
}

impl BoneMotions {
    /// Motions that rotate and translate only, but for a scale that all bones share.
    pub(super) fn rigid(transforms: &[Affine3A], bones: usize) -> Result<Self, SkinningError> {
        let mut motions = Self::default();
        motions.set_rigid(transforms, bones)?;
        Ok(motions)
    }

    /// As [`rigid`](Self::rigid), in the same memory.
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
        let Some(shared) = SharedScale::of(transforms, &mut self.scales) else {
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

    /// T = (rigid motion) · (stretch about the bone's pivot): with the polar decomposition M = R S of
    /// the linear part and the pivot c, the stretch is v → S (v − c) + c and the rigid motion is
    /// v → R v + T c − R c (the two phases of Kavan et al. 2008). A scale that all bones share acts before both, about the origin.
    pub(super) fn stretched(
        transforms: &[Affine3A],
        pivots: &[Vec3],
        bones: usize,
    ) -> Result<Self, SkinningError> {
        let mut motions = Self::default();
        motions.set_stretched(transforms, pivots, bones)?;
        Ok(motions)
    }

    /// As [`stretched`](Self::stretched), in the same memory; not changed by an error.
    pub(super) fn set_stretched(
        &mut self,
        transforms: &[Affine3A],
        pivots: &[Vec3],
        bones: usize,
    ) -> Result<(), SkinningError> {
        check(transforms, bones)?;
        SizeMismatch::check("pivots", pivots.len(), bones)?;
        let shared = SharedScale::of(transforms, &mut self.scales);
        let (old, old_stretches) = (self.rigid.len(), self.stretches.len());
        for (bone, (transform, pivot)) in transforms.iter().zip(pivots).enumerate() {
            match two_phases(transform, *pivot, shared) {
                Ok((rigid, stretch)) => {
                    self.rigid.push(DualQuaternion::of_rigid(&rigid));
                    self.stretches.push(stretch);
                }
                Err(wrong) => {
                    self.rigid.truncate(old);
                    self.stretches.truncate(old_stretches);
                    return Err(wrong(bone));
                }
            }
        }
        self.rigid.drain(..old);
        self.stretches.drain(..old_stretches);
        Ok(())
    }

    /// Σ_j w_j (stretch of bone j); `None` where nothing stretches.
    pub(super) fn stretch(&self, shares: impl Iterator<Item = (usize, f32)>) -> Option<Affine3A> {
        if self.stretches.is_empty() {
            return None;
        }
        let mut sum = Affine3A::ZERO;
        for (bone, weight) in shares {
            if let Some(stretch) = self.stretches.get(bone) {
                sum.matrix3 += stretch.matrix3 * weight;
                sum.translation += stretch.translation * weight;
            }
        }
        Some(sum)
    }
}

/// A transform as a rigid motion after a stretch about the pivot after the shared scale, or the error of a bone.
fn two_phases(
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
    let Some((rotation, stretch)) = polar(&transform.matrix3) else {
        return Err(|bone| SkinningError::Mirrored { bone });
    };
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

/// A smallest stretch below this share of the largest is none: the map is flat.
const FLAT: f64 = 1e-9;

/// M = R S with R a rotation and S symmetric; `None` for a map that is flat or mirrors.
fn polar(matrix: &Mat3A) -> Option<(Mat3A, Mat3A)> {
    let wide = matrix.to_cols_array().map(f64::from);
    let polar = Polar::new(&na::Matrix3::from_column_slice(&wide))?;
    let narrow = |m: na::Matrix3<f64>| Mat3A::from(DMat3::from_cols_slice(m.as_slice()).as_mat3());
    (polar.thickness > FLAT).then(|| (narrow(polar.rotation), narrow(polar.stretch)))
}
