//! A skeleton in a pose: where each bone went, and the transforms that carry skin along.

use super::{BoneId, Skeleton, SkeletonError};
use crate::kinematics::{ForwardKinematics, KinematicsError};
use crate::model::{FrameId, Model};
use crate::spatial::{Placement, Vector3};

/// Where every bone of a skeleton stands in one pose.
#[derive(Clone, Debug, PartialEq)]
pub struct BonePlacements {
    /// W_i: canonical bone i → posed model, by bone index.
    pub model_from_bone: Vec<Placement<f64>>,
}

impl BonePlacements {
    /// A bone's tail in the pose.
    ///
    /// # Errors
    /// A bone that is not in it.
    pub fn tail(&self, bone: BoneId) -> Result<Vector3<f64>, SkeletonError> {
        Ok(self.of(bone)?.translation)
    }

    /// A bone's tip in the pose of its skeleton.
    ///
    /// # Errors
    /// A bone that is not in both.
    pub fn tip(&self, skeleton: &Skeleton, bone: BoneId) -> Result<Vector3<f64>, SkeletonError> {
        let own = skeleton.bones().get(bone.index());
        let own = own.ok_or_else(|| foreign(bone, skeleton.bones().len()))?;
        Ok(self.of(bone)?.apply(Vector3::new(own.length, 0.0, 0.0)))
    }

    fn of(&self, bone: BoneId) -> Result<&Placement<f64>, SkeletonError> {
        let posed = self.model_from_bone.get(bone.index());
        posed.ok_or_else(|| foreign(bone, self.model_from_bone.len()))
    }

    /// The same pose with the root placed generally in a larger scene: W_i → P W_i, and so T_i → P T_i
    /// for the skin.
    #[must_use]
    pub fn placed(mut self, scene_from_model: impl Into<Placement<f64>>) -> Self {
        let scene_from_model = scene_from_model.into();
        for posed in &mut self.model_from_bone {
            *posed = scene_from_model * *posed;
        }
        self
    }

    /// The skinning transforms T_i = W_i T̂_i⁻¹ by bone index: rest model → posed model.
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

/// Poses one skeleton again and again, in memory of its own.
#[derive(Clone, Debug)]
pub struct Posing {
    kinematics: ForwardKinematics,
    placements: BonePlacements,
}

impl Posing {
    /// Memory for posing `skeleton`. Every angle is read, also one whose limits lock it.
    #[must_use]
    pub fn new(skeleton: &Skeleton) -> Self {
        Self::of_model(
            skeleton.model(),
            skeleton.bone_ids().map(|b| skeleton.tail(b)),
        )
    }

    /// The same for the tails of the bones of another model.
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

    /// Where the bones stand for the stacked angles `q`, in radians, or the configuration of balls.
    ///
    /// # Errors
    /// Another number of them than the skeleton has, or one that is not finite.
    pub fn pose(&mut self, q: &[f64]) -> Result<&BonePlacements, KinematicsError> {
        let placed = self.kinematics.place(q)?;
        self.placements.model_from_bone.copy_from_slice(placed);
        Ok(&self.placements)
    }
}

impl Skeleton {
    /// Where the bones stand for the stacked angles `q`, in radians. [`Posing`] does the same
    /// without allocating each time.
    ///
    /// # Errors
    /// As [`Posing::pose`].
    pub fn pose(&self, q: &[f64]) -> Result<BonePlacements, KinematicsError> {
        let mut posing = Posing::new(self);
        posing.pose(q)?;
        Ok(posing.placements)
    }
}

fn foreign(bone: BoneId, bones: usize) -> SkeletonError {
    let bone = bone.index();
    SkeletonError::ForeignBone { bone, bones }
}
