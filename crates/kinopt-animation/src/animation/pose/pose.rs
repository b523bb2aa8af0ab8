//! Poses: local transforms of all bones of an armature.

use glam::{Quat, Vec3A};

use super::LocalTransform;
use crate::animation::ClipError;
use kinopt_kinematics::SizeMismatch;
use kinopt_kinematics::skeleton::BoneId;

/// Local transform of each bone and weight of each morph target. Stored by property, because most clips and blends
/// change rotations only.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "super::serialised::PoseParts"))]
pub struct Pose {
    pub(crate) translations: Vec<Vec3A>,
    pub(crate) rotations: Vec<Quat>,
    pub(crate) scales: Vec<Vec3A>,
    pub(crate) morph_weights: Vec<f32>,
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

    /// Number of bones.
    #[must_use]
    pub fn bones(&self) -> usize {
        self.rotations.len()
    }

    /// Translations of the bones in their parents, in the model's unit.
    #[must_use]
    pub fn translations(&self) -> &[Vec3A] {
        &self.translations
    }

    /// Rotations of the bones in their parents, unit quaternions.
    #[must_use]
    pub fn rotations(&self) -> &[Quat] {
        &self.rotations
    }

    /// Scales of the bones along their own axes.
    #[must_use]
    pub fn scales(&self) -> &[Vec3A] {
        &self.scales
    }

    /// Weights of the morph targets.
    #[must_use]
    pub fn morph_weights(&self) -> &[f32] {
        &self.morph_weights
    }

    /// Mutable weights of the morph targets.
    #[must_use]
    pub fn morph_weights_mut(&mut self) -> &mut [f32] {
        &mut self.morph_weights
    }

    /// Local transform of a bone.
    ///
    /// # Errors
    /// The bone is not in the pose.
    pub fn local(&self, bone: BoneId) -> Result<LocalTransform, ClipError> {
        let (bone, bones) = (bone.index(), self.bones());
        match bone < bones {
            true => Ok(self.local_of(BoneId::new(bone))),
            false => Err(ClipError::UnknownPoseBone { bone, bones }),
        }
    }

    /// Appends a bone.
    #[cfg(feature = "gltf")]
    pub(super) fn push(&mut self, local: LocalTransform) {
        self.translations.push(local.translation);
        self.rotations.push(local.rotation);
        self.scales.push(local.scale);
    }

    /// [`local`](Self::local) of a bone known to be in the pose.
    #[doc(hidden)]
    pub fn local_of(&self, bone: BoneId) -> LocalTransform {
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

    /// Sets the local transform of a bone; the rotation is normalised. The pose does not change on an error.
    ///
    /// # Errors
    /// A [`ClipError`]: the bone is not in the pose, a number is not finite, or the rotation is zero.
    pub fn set_local(&mut self, bone: BoneId, local: LocalTransform) -> Result<(), ClipError> {
        let (bone, bones) = (bone.index(), self.bones());
        if bone >= bones {
            return Err(ClipError::UnknownPoseBone { bone, bones });
        }
        let finite = local.translation.is_finite() && local.scale.is_finite();
        if !(finite && local.rotation.is_finite()) {
            return Err(ClipError::NonFiniteTransform { bone });
        }
        let rotation = unit(local.rotation).ok_or(ClipError::ZeroRotation { bone })?;
        self.translations[bone] = local.translation;
        self.rotations[bone] = rotation;
        self.scales[bone] = local.scale;
        Ok(())
    }

    /// Sets the local rotation of a bone, normalised; its translation and scale do not change.
    /// [`Armature::set_model_rotation`](super::Armature::set_model_rotation) sets the rotation in the model.
    ///
    /// # Errors
    /// As [`set_local`](Self::set_local).
    pub fn set_rotation(&mut self, bone: BoneId, rotation: Quat) -> Result<(), ClipError> {
        let local = self.local(bone)?;
        self.set_local(bone, LocalTransform { rotation, ..local })
    }

    /// Sets the local translation of a bone, in the model's unit; its rotation and scale do not change.
    ///
    /// # Errors
    /// As [`set_local`](Self::set_local).
    pub fn set_translation(&mut self, bone: BoneId, translation: Vec3A) -> Result<(), ClipError> {
        let local = self.local(bone)?;
        let local = LocalTransform {
            translation,
            ..local
        };
        self.set_local(bone, local)
    }

    /// Sets the scale of a bone along its own axes; its translation and rotation do not change.
    ///
    /// # Errors
    /// As [`set_local`](Self::set_local).
    pub fn set_scale(&mut self, bone: BoneId, scale: Vec3A) -> Result<(), ClipError> {
        let local = self.local(bone)?;
        self.set_local(bone, LocalTransform { scale, ..local })
    }

    /// Copies another pose; does not allocate if the sizes are equal.
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

/// The normalised quaternion, unchanged if it has unit length; `None` for zero.
fn unit(q: Quat) -> Option<Quat> {
    if q.is_normalized() {
        return Some(q);
    }
    // Double precision, because the square of a small single-precision number underflows.
    let q = q.as_dquat();
    let length = q.length();
    (length > 0.0).then(|| (q / length).as_quat())
}
