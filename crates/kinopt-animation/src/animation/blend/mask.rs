//! Bone masks: weights of bones and morph targets in a layer.

use crate::animation::{Armature, LayerError, Pose, SizeMismatch};
use kinopt_kinematics::skeleton::BoneId;

/// Weight within [0, 1] for each bone and morph target of an armature.
#[derive(Clone, Debug, PartialEq)]
pub struct BoneMask {
    bones: Vec<f32>,
    morph_targets: Vec<f32>,
}

impl BoneMask {
    /// Mask with weight 1 everywhere.
    #[must_use]
    pub fn all(armature: &Armature) -> Self {
        Self::uniform(armature, 1.0)
    }

    /// Mask with weight 0 everywhere.
    #[must_use]
    pub fn none(armature: &Armature) -> Self {
        Self::uniform(armature, 0.0)
    }

    fn uniform(armature: &Armature, weight: f32) -> Self {
        Self {
            bones: vec![weight; armature.bones()],
            morph_targets: vec![weight; armature.morph_targets().len()],
        }
    }

    /// Sets the weight of one bone.
    ///
    /// # Errors
    /// The bone is of another armature, or the weight is outside [0, 1].
    pub fn with_bone(mut self, bone: BoneId, share: f32) -> Result<Self, LayerError> {
        set(&mut self.bones, "bone", bone.index(), share)?;
        Ok(self)
    }

    /// Sets the weight of a bone and all its descendants.
    ///
    /// # Errors
    /// As [`with_bone`](Self::with_bone); also an armature of another size.
    pub fn with_subtree(
        mut self,
        armature: &Armature,
        root: BoneId,
        share: f32,
    ) -> Result<Self, LayerError> {
        set(&mut self.bones, "bone", root.index(), share)?;
        SizeMismatch::check("bones in the mask", self.bones.len(), armature.bones())?;
        let mut inside = vec![false; armature.bones()];
        inside[root.index()] = true;
        // Parents precede their children, so a parent's membership is already known.
        for index in root.index()..armature.bones() {
            let parent = armature.parent(BoneId::new(index));
            inside[index] |= parent.is_some_and(|parent| inside[parent.index()]);
            if inside[index] {
                self.bones[index] = share;
            }
        }
        Ok(self)
    }

    /// Sets the weight of one morph target.
    ///
    /// # Errors
    /// The armature does not have the target, or the weight is outside [0, 1].
    pub fn with_morph_target(mut self, target: usize, share: f32) -> Result<Self, LayerError> {
        set(&mut self.morph_targets, "morph target", target, share)?;
        Ok(self)
    }

    /// Weights of the bones.
    #[must_use]
    pub fn bones(&self) -> &[f32] {
        &self.bones
    }

    /// Weights of the morph targets.
    #[must_use]
    pub fn morph_targets(&self) -> &[f32] {
        &self.morph_targets
    }

    pub(super) fn check(&self, pose: &Pose) -> Result<(), SizeMismatch> {
        SizeMismatch::check("bones in the mask", self.bones.len(), pose.bones())?;
        let targets = pose.morph_weights.len();
        SizeMismatch::check(
            "morph targets in the mask",
            self.morph_targets.len(),
            targets,
        )
    }
}

fn set(
    weights: &mut [f32],
    what: &'static str,
    index: usize,
    share: f32,
) -> Result<(), LayerError> {
    let count = weights.len();
    let entry = weights.get_mut(index);
    let entry = entry.ok_or(LayerError::UnknownIndex { what, index, count })?;
    if !(0.0..=1.0).contains(&share) {
        return Err(LayerError::BadShare { what, index, share });
    }
    *entry = share;
    Ok(())
}

/// Clamps to [0, 1]; 0 for NaN.
pub(in crate::animation) fn clamp_to_unit(weight: f32) -> f32 {
    if weight > 0.0 { weight.min(1.0) } else { 0.0 }
}

/// Returns the number, or 0 if it is not finite.
pub(in crate::animation) fn finite_or_0(number: f32) -> f32 {
    if number.is_finite() { number } else { 0.0 }
}
