//! Where all bones of an armature stand in their parents.

use glam::{Quat, Vec3A};

use super::LocalTransform;
use crate::SizeMismatch;
use crate::skeleton::BoneId;

/// A local transform for each bone and a weight for each morph target, by property: most clips and
/// blends touch rotations only.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "super::serialised::PoseParts"))]
pub struct Pose {
    pub(crate) translations: Vec<Vec3A>,
    pub(crate) rotations: Vec<Quat>,
    pub(crate) scales: Vec<Vec3A>,
    pub(crate) morph_weights: Vec<f32>,
}

/// What is wrong with a local transform, or with the bone it is for. Bones are given by index.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LocalError {
    /// A bone of another armature.
    #[error("bone {bone} does not exist; the pose has {bones}")]
    UnknownBone {
        /// The bone.
        bone: usize,
        /// How many bones there are.
        bones: usize,
    },
    /// A number that is NaN or infinite.
    #[error("bone {bone}: the local transform is not finite")]
    NotFinite {
        /// The bone.
        bone: usize,
    },
    /// The bones above leave a bone less than three dimensions, so that nothing in its parent brings it
    /// to a place in the model.
    #[error("bone {bone}: the bones above it flatten space, so no local transform places it")]
    Flattened {
        /// The bone.
        bone: usize,
    },
    /// A transform in the model that is no scale, rotation and translation in the parent.
    #[error("bone {bone}: it would have to shear in its parent, or has no size")]
    Sheared {
        /// The bone.
        bone: usize,
    },
    /// A pose of another armature.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
    /// A quaternion without direction.
    #[error("bone {bone}: the quaternion is zero and stands for no rotation")]
    ZeroRotation {
        /// The bone.
        bone: usize,
    },
}

impl Pose {
    pub(crate) fn new(locals: &[LocalTransform], morph_targets: usize) -> Self {
        Self {
            translations: locals.iter().map(|local| local.translation).collect(),
            rotations: locals.iter().map(|local| local.rotation).collect(),
            scales: locals.iter().map(|local| local.scale).collect(),
            morph_weights: vec![0.0; morph_targets],
        }
    }

    getters! {
        /// How many bones there are.
        pub fn bones(&self) -> usize = self.rotations.len();
        /// Where the bones are in their parents, in the model's own unit.
        pub fn translations(&self) -> &[Vec3A] = &self.translations;
        /// How the bones are turned in their parents: unit quaternions.
        pub fn rotations(&self) -> &[Quat] = &self.rotations;
        /// How the bones are scaled along their own axes.
        pub fn scales(&self) -> &[Vec3A] = &self.scales;
        /// The weights of the morph targets.
        pub fn morph_weights(&self) -> &[f32] = &self.morph_weights;
        /// The same, to change.
        pub fn morph_weights_mut(&mut self) -> &mut [f32] = &mut self.morph_weights;
    }

    /// A bone's place in its parent.
    ///
    /// # Errors
    /// A bone that is not in the pose.
    pub fn local(&self, bone: BoneId) -> Result<LocalTransform, LocalError> {
        let (bone, bones) = (bone.index(), self.bones());
        match bone < bones {
            true => Ok(self.local_of(BoneId::new(bone))),
            false => Err(LocalError::UnknownBone { bone, bones }),
        }
    }

    /// One more bone behind the others.
    #[cfg(feature = "gltf")]
    pub(super) fn push(&mut self, local: LocalTransform) {
        self.translations.push(local.translation);
        self.rotations.push(local.rotation);
        self.scales.push(local.scale);
    }

    /// [`local`](Self::local) of a bone that is in the pose.
    pub(crate) fn local_of(&self, bone: BoneId) -> LocalTransform {
        let index = bone.index();
        let parts = (
            self.translations.get(index),
            self.rotations.get(index),
            self.scales.get(index),
        );
        let (Some(&translation), Some(&rotation), Some(&scale)) = parts else {
            return LocalTransform::IDENTITY;
        };
        LocalTransform {
            translation,
            rotation,
            scale,
        }
    }

    /// Moves a bone in its parent. A rotation that is not of unit length is made so.
    ///
    /// # Errors
    /// A [`LocalError`]: the bone is not in the pose, a number is not finite, or the rotation is zero.
    /// Nothing is changed then.
    pub fn set_local(&mut self, bone: BoneId, local: LocalTransform) -> Result<(), LocalError> {
        let (bone, bones) = (bone.index(), self.bones());
        if bone >= bones {
            return Err(LocalError::UnknownBone { bone, bones });
        }
        let finite = local.translation.is_finite() && local.scale.is_finite();
        if !(finite && local.rotation.is_finite()) {
            return Err(LocalError::NotFinite { bone });
        }
        let rotation = unit(local.rotation).ok_or(LocalError::ZeroRotation { bone })?;
        self.translations[bone] = local.translation;
        self.rotations[bone] = rotation;
        self.scales[bone] = local.scale;
        Ok(())
    }

    /// Turns a bone in its parent; its translation and scale stay. A quaternion that is not of unit
    /// length is made so. [`Armature::set_model_rotation`](super::Armature::set_model_rotation) turns it
    /// in the model.
    ///
    /// # Errors
    /// As [`set_local`](Self::set_local).
    pub fn set_rotation(&mut self, bone: BoneId, rotation: Quat) -> Result<(), LocalError> {
        let local = self.local(bone)?;
        self.set_local(bone, LocalTransform { rotation, ..local })
    }

    /// Moves a bone's origin in its parent, in the model's own unit; its rotation and scale stay.
    ///
    /// # Errors
    /// As [`set_local`](Self::set_local).
    pub fn set_translation(&mut self, bone: BoneId, translation: Vec3A) -> Result<(), LocalError> {
        let local = self.local(bone)?;
        let local = LocalTransform {
            translation,
            ..local
        };
        self.set_local(bone, local)
    }

    /// Scales a bone along its own axes; its translation and rotation stay.
    ///
    /// # Errors
    /// As [`set_local`](Self::set_local).
    pub fn set_scale(&mut self, bone: BoneId, scale: Vec3A) -> Result<(), LocalError> {
        let local = self.local(bone)?;
        self.set_local(bone, LocalTransform { scale, ..local })
    }

    /// Makes this pose the same as another one, without allocating where both have one size.
    pub fn copy_from(&mut self, other: &Self) {
        self.translations.clone_from(&other.translations);
        self.rotations.clone_from(&other.rotations);
        self.scales.clone_from(&other.scales);
        self.morph_weights.clone_from(&other.morph_weights);
    }

    pub(crate) fn check_same_size(&self, other: &Self) -> Result<(), SizeMismatch> {
        SizeMismatch::check("bones", other.bones(), self.bones())?;
        let targets = [&other.morph_weights, &self.morph_weights].map(Vec::len);
        SizeMismatch::check("morph targets", targets[0], targets[1])
    }
}

/// The quaternion at unit length, as it is where it has that; `None` for zero.
fn unit(q: Quat) -> Option<Quat> {
    if q.is_normalized() {
        return Some(q);
    }
    // In double precision, where the square of no single-precision number vanishes.
    let q = q.as_dquat();
    let length = q.length();
    (length > 0.0).then(|| (q / length).as_quat())
}
