//! Layers over a base pose: other motion for some bones, or motion added to what is there.

use glam::{Quat, Vec3A};

use super::{BoneMask, finite_or_0};
use crate::animation::rotation::slerp;
use crate::animation::{Pose, SizeMismatch};

/// How a layer goes onto what is below.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum LayerMode {
    /// In its place, by cross-fade: an upper body that waves while the legs walk.
    Override,
    /// On top, as the difference from a reference pose: breathing, a lean, a recoil. Often the
    /// reference is the first pose of the layer's clip, or the armature's rest.
    Additive {
        /// The pose that adds nothing.
        reference: Pose,
    },
}

/// What is put over a base pose: how, how much, and where.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// In place of the base or on top of it.
    pub mode: LayerMode,
    /// Within [0, 1] for an override; any finite number for an additive layer, where 1 adds the
    /// whole difference. NaN adds nothing.
    pub weight: f32,
    /// Which bones and morph targets it moves.
    pub mask: BoneMask,
}

impl Layer {
    /// Puts the layer's pose over a base pose.
    ///
    /// # Errors
    /// Poses or mask are of different armatures.
    pub fn apply(&self, base: &mut Pose, layer: &Pose) -> Result<(), SizeMismatch> {
        match &self.mode {
            LayerMode::Override => base.cross_fade_masked(layer, self.weight, &self.mask),
            LayerMode::Additive { reference } => self.add(base, layer, reference),
        }
    }

    /// Translation t + w (tₗ − tᵣ), rotation q slerp(1, qᵣ⁻¹ qₗ, w), scale s lerp(1, sₗ/sᵣ, w), each
    /// with w = weight · mask.
    fn add(&self, base: &mut Pose, layer: &Pose, reference: &Pose) -> Result<(), SizeMismatch> {
        base.check_same_size(layer)?;
        base.check_same_size(reference)?;
        self.mask.check(base)?;
        let weight = finite_or_0(self.weight);
        let shares = || self.mask.bones().iter().map(|own| own * weight);
        let differences = layer.translations.iter().zip(&reference.translations);
        for ((own, (to, from)), share) in
            base.translations.iter_mut().zip(differences).zip(shares())
        {
            *own += (*to - *from) * share;
        }
        let ratios = layer.scales.iter().zip(&reference.scales);
        for ((own, (to, from)), share) in base.scales.iter_mut().zip(ratios).zip(shares()) {
            // A scale of nothing has no ratio; such an axis is left alone.
            let ratio = Vec3A::select(from.cmpeq(Vec3A::ZERO), Vec3A::ONE, *to / *from);
            *own *= Vec3A::ONE + (ratio - Vec3A::ONE) * share;
        }
        let turns = layer.rotations.iter().zip(&reference.rotations);
        for ((own, (to, from)), share) in base.rotations.iter_mut().zip(turns).zip(shares()) {
            if share != 0.0 {
                let turn = slerp(Quat::IDENTITY, from.conjugate() * *to, share);
                *own = (*own * turn).normalize();
            }
        }
        let weights = layer.morph_weights.iter().zip(&reference.morph_weights);
        let targets = self.mask.morph_targets().iter();
        for ((own, (to, from)), target) in base.morph_weights.iter_mut().zip(weights).zip(targets) {
            *own += (to - from) * weight * target;
        }
        Ok(())
    }
}
