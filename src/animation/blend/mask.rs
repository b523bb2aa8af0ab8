//! How much of each bone a layer may move.

use crate::animation::{Armature, Pose, SizeMismatch};
use crate::skeleton::BoneId;

/// A share within [0, 1] for each bone and each morph target of an armature.
#[derive(Clone, Debug, PartialEq)]
pub struct BoneMask {
    bones: Vec<f32>,
    morph_targets: Vec<f32>,
}

impl BoneMask {
    /// The whole armature.
    #[must_use]
    pub fn all(armature: &Armature) -> Self {
        Self::uniform(armature, 1.0)
    }

    /// None of it, to add parts to.
    #[must_use]
    pub fn none(armature: &Armature) -> Self {
        Self::uniform(armature, 0.0)
    }

    fn uniform(armature: &Armature, share: f32) -> Self {
        Self {
            bones: vec![share; armature.bones()],
            morph_targets: vec![share; armature.morph_targets().len()],
        }
    }

    /// Sets one bone's share, taken into [0, 1]; NaN counts as 0. A bone of another armature, which
    /// this one does not have, changes nothing.
    #[must_use]
    pub fn with_bone(mut self, bone: BoneId, share: f32) -> Self {
        if let Some(own) = self.bones.get_mut(bone.index()) {
            *own = within(share);
        }
        self
    }

    /// Sets the share of a bone and of all that hang on it.
    #[must_use]
    pub fn with_subtree(mut self, armature: &Armature, root: BoneId, share: f32) -> Self {
        let mut inside = vec![false; armature.bones()];
        for index in root.index()..armature.bones() {
            let parent = armature
                .bone_at(index)
                .and_then(|bone| armature.parent(bone));
            // Parents come first, so theirs is decided already.
            inside[index] = index == root.index() || parent.is_some_and(|p| inside[p.index()]);
            if inside[index] {
                self = self.with_bone(BoneId::new(index), share);
            }
        }
        self
    }

    /// Sets one morph target's share, taken into [0, 1]; NaN counts as 0. A target that the armature
    /// does not have changes nothing.
    #[must_use]
    pub fn with_morph_target(mut self, target: usize, share: f32) -> Self {
        if let Some(own) = self.morph_targets.get_mut(target) {
            *own = within(share);
        }
        self
    }

    /// The bones' shares.
    #[must_use]
    pub fn bones(&self) -> &[f32] {
        &self.bones
    }

    /// The morph targets' shares.
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

/// The nearest number within [0, 1]; 0 for NaN.
pub(in crate::animation) fn within(share: f32) -> f32 {
    if share > 0.0 { share.min(1.0) } else { 0.0 }
}
