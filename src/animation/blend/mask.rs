//! How much of each bone a layer may move.

use crate::animation::{Armature, Pose, SizeMismatch};
use crate::skeleton::BoneId;

/// Why a mask cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MaskError {
    /// A bone or morph target of another armature.
    #[error("{what} {index} does not exist; there are {count}")]
    Unknown {
        /// "bone" or "morph target".
        what: &'static str,
        /// Which, from 0.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A share that is not within [0, 1].
    #[error("{what} {index}: the share {share} is not within [0, 1]")]
    BadShare {
        /// "bone" or "morph target".
        what: &'static str,
        /// Which, from 0.
        index: usize,
        /// The share.
        share: f32,
    },
    /// An armature with another number of bones.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
}

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

    /// Sets one bone's share.
    ///
    /// # Errors
    /// A bone of another armature, or a share that is not within [0, 1].
    pub fn with_bone(mut self, bone: BoneId, share: f32) -> Result<Self, MaskError> {
        set(&mut self.bones, "bone", bone.index(), share)?;
        Ok(self)
    }

    /// Sets the share of a bone and of all that hang on it.
    ///
    /// # Errors
    /// As [`with_bone`](Self::with_bone); an armature of another size.
    pub fn with_subtree(
        mut self,
        armature: &Armature,
        root: BoneId,
        share: f32,
    ) -> Result<Self, MaskError> {
        set(&mut self.bones, "bone", root.index(), share)?;
        SizeMismatch::check("bones in the mask", self.bones.len(), armature.bones())?;
        let mut inside = vec![false; armature.bones()];
        inside[root.index()] = true;
        // Parents come first, so theirs is decided already.
        for index in root.index()..armature.bones() {
            let parent = armature.parent(BoneId::new(index));
            inside[index] |= parent.is_some_and(|parent| inside[parent.index()]);
            if inside[index] {
                self.bones[index] = share;
            }
        }
        Ok(self)
    }

    /// Sets one morph target's share.
    ///
    /// # Errors
    /// A target that the armature does not have, or a share that is not within [0, 1].
    pub fn with_morph_target(mut self, target: usize, share: f32) -> Result<Self, MaskError> {
        set(&mut self.morph_targets, "morph target", target, share)?;
        Ok(self)
    }

    getters! {
        /// The bones' shares.
        pub fn bones(&self) -> &[f32] = &self.bones;
        /// The morph targets' shares.
        pub fn morph_targets(&self) -> &[f32] = &self.morph_targets;
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

fn set(shares: &mut [f32], what: &'static str, index: usize, share: f32) -> Result<(), MaskError> {
    let count = shares.len();
    let own = shares.get_mut(index);
    let own = own.ok_or(MaskError::Unknown { what, index, count })?;
    if !(0.0..=1.0).contains(&share) {
        return Err(MaskError::BadShare { what, index, share });
    }
    *own = share;
    Ok(())
}

/// The nearest number within [0, 1]; 0 for NaN.
pub(in crate::animation) fn within(share: f32) -> f32 {
    if share > 0.0 { share.min(1.0) } else { 0.0 }
}

/// The number; 0 for one that is not finite.
pub(in crate::animation) fn finite_or_0(number: f32) -> f32 {
    if number.is_finite() { number } else { 0.0 }
}
