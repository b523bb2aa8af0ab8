//! Layers that override or add to a base pose.

use glam::{Quat, Vec3A};

use super::{BoneMask, finite_or_0};
use crate::animation::rotation::slerp;
use crate::animation::{Pose, SizeMismatch};

/// Combination of a layer with the base pose.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum LayerMode {
    /// Replaces the base by cross-fade, such as a wave of the upper body over walking legs.
    Override,
    /// Adds the difference from a reference pose, such as breathing or recoil. Usual references are the first pose of
    /// the layer's clip and the rest pose.
    Additive {
        /// Pose that adds nothing.
        reference: Pose,
    },
}

/// Layer on a base pose: mode, weight and mask.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Override or additive.
    pub mode: LayerMode,
    /// Weight, within [0, 1] in override mode. In additive mode any finite number; 1 adds the whole difference. NaN
    /// counts as 0.
    pub weight: f32,
    /// Weights of the bones and morph targets that the layer moves.
    pub mask: BoneMask,
}

impl Layer {
    /// Applies the layer's pose to a base pose.
    ///
    /// # Errors
    /// The poses or the mask are of different armatures.
    pub fn apply(&self, base: &mut Pose, layer: &Pose) -> Result<(), SizeMismatch> {
        match &self.mode {
            LayerMode::Override => base.cross_fade_masked(layer, self.weight, &self.mask),
            LayerMode::Additive { reference } => self.add(base, layer, reference),
        }
    }

    /// Translation t + w (tₗ − tᵣ), rotation q slerp(1, qᵣ⁻¹ qₗ, w), scale s lerp(1, sₗ/sᵣ, w), each with w = weight ·
    /// mask.
    fn add(&self, base: &mut Pose, layer: &Pose, reference: &Pose) -> Result<(), SizeMismatch> {
        base.check_same_size(layer)?;
        base.check_same_size(reference)?;
        self.mask.check(base)?;
        let weight = finite_or_0(self.weight);
        let bone_weights = || {
            self.mask
                .bones()
                .iter()
                .map(|mask_weight| mask_weight * weight)
        };
        let differences = layer.translations.iter().zip(&reference.translations);
        for ((translation, (to, from)), bone_weight) in base
            .translations
            .iter_mut()
            .zip(differences)
            .zip(bone_weights())
        {
            *translation += (*to - *from) * bone_weight;
        }
        let ratios = layer.scales.iter().zip(&reference.scales);
        for ((scale, (to, from)), bone_weight) in
            base.scales.iter_mut().zip(ratios).zip(bone_weights())
        {
            // A zero scale has no ratio; such an axis does not change.
            let ratio = Vec3A::select(from.cmpeq(Vec3A::ZERO), Vec3A::ONE, *to / *from);
            *scale *= Vec3A::ONE + (ratio - Vec3A::ONE) * bone_weight;
        }
        let rotations = layer.rotations.iter().zip(&reference.rotations);
        for ((rotation, (to, from)), bone_weight) in
            base.rotations.iter_mut().zip(rotations).zip(bone_weights())
        {
            if bone_weight != 0.0 {
                let difference = slerp(Quat::IDENTITY, from.conjugate() * *to, bone_weight);
                *rotation = (*rotation * difference).normalize();
            }
        }
        let weights = layer.morph_weights.iter().zip(&reference.morph_weights);
        let targets = self.mask.morph_targets().iter();
        for ((morph_weight, (to, from)), target) in
            base.morph_weights.iter_mut().zip(weights).zip(targets)
        {
            *morph_weight += (to - from) * weight * target;
        }
        Ok(())
    }
}
