//! Poses of a skeleton: bone placements and skinning transforms.

use super::{BoneId, Skeleton};
use crate::kinematics::{ForwardKinematics, KinematicsError};
use crate::model::ModelError;
use crate::model::{FrameId, Model};
use crate::spatial::{Placement, Vector3};

/// Placements of all bones of a skeleton in one pose.
#[derive(Clone, Debug, PartialEq)]
pub struct BonePlacements {
    /// W_i: canonical bone i → posed model, by bone index.
    pub model_from_bone: Vec<Placement<f64>>,
}

impl BonePlacements {
    /// Position of a bone's tail in the pose, in model coordinates.
    ///
    /// # Errors
    /// A bone outside the pose.
    pub fn tail(&self, bone: BoneId) -> Result<Vector3<f64>, ModelError> {
        Ok(self.placement(bone)?.translation)
    }

    /// Position of a bone's tip in a pose of `skeleton`, in model coordinates.
    ///
    /// # Errors
    /// A bone outside the pose or the skeleton.
    pub fn tip(&self, skeleton: &Skeleton, bone: BoneId) -> Result<Vector3<f64>, ModelError> {
        let rest_bone = skeleton.bones().get(bone.index());
        let rest_bone = rest_bone.ok_or_else(|| foreign_bone(bone, skeleton.bones().len()))?;
        Ok(self
            .placement(bone)?
            .apply(Vector3::new(rest_bone.length, 0.0, 0.0)))
    }

    fn placement(&self, bone: BoneId) -> Result<&Placement<f64>, ModelError> {
        let posed = self.model_from_bone.get(bone.index());
        posed.ok_or_else(|| foreign_bone(bone, self.model_from_bone.len()))
    }

    /// The pose moved as a whole into a scene: W_i → P W_i, and therefore T_i → P T_i for skinning.
    #[must_use]
    pub fn placed(mut self, scene_from_model: impl Into<Placement<f64>>) -> Self {
        let scene_from_model = scene_from_model.into();
        for posed in &mut self.model_from_bone {
            *posed = scene_from_model * *posed;
        }
        self
    }

    /// Skinning transforms T_i = W_i T̂_i⁻¹ by bone index: rest model → posed model.
    pub fn skinning_transforms<'a>(
        &'a self,
        skeleton: &'a Skeleton,
    ) -> impl Iterator<Item = Placement<f64>> + 'a {
        self.model_from_bone
            .iter()
            .zip(skeleton.bones())
            .map(|(posed, bone)| *posed * bone.model_from_rest.inverse())
    }
}

/// Poses one skeleton repeatedly in reused memory.
#[derive(Clone, Debug)]
pub struct Posing {
    kinematics: ForwardKinematics,
    placements: BonePlacements,
}

impl Posing {
    /// A workspace for posing `skeleton`. All angles are used, including locked ones.
    #[must_use]
    pub fn new(skeleton: &Skeleton) -> Self {
        Self::of_model(
            skeleton.model(),
            skeleton.bone_ids().map(|b| skeleton.tail(b)),
        )
    }

    /// A workspace for the tails of the bones of another model.
    pub(super) fn of_model(model: &Model, tails: impl Iterator<Item = FrameId>) -> Self {
        let frames: Vec<FrameId> = tails.collect();
        let kinematics = ForwardKinematics::of_configurations(model, &frames);
        let placements = BonePlacements {
            model_from_bone: kinematics.placements().to_vec(),
        };
        Self {
            kinematics,
            placements,
        }
    }

    /// The placements of the bones for the joint angles `q` (radians), or for a configuration of ball joints.
    ///
    /// # Errors
    /// A different number of values, or a value that is not finite.
    pub fn pose(&mut self, q: &[f64]) -> Result<&BonePlacements, KinematicsError> {
        let placed = self.kinematics.place(q)?;
        self.placements.model_from_bone.copy_from_slice(placed);
        Ok(&self.placements)
    }
}

impl Skeleton {
    /// The placements of the bones for the joint angles `q` (radians). [`Posing`] avoids the allocations.
    ///
    /// # Errors
    /// As [`Posing::pose`].
    pub fn pose(&self, q: &[f64]) -> Result<BonePlacements, KinematicsError> {
        let mut posing = Posing::new(self);
        posing.pose(q)?;
        Ok(posing.placements)
    }
}

fn foreign_bone(bone: BoneId, bones: usize) -> ModelError {
    let bone = bone.index();
    ModelError::ForeignBone { bone, bones }
}
