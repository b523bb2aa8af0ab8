//! Serialised skeletons: name, bones and hinges.

use serde::{Deserialize, Serialize};

use super::{Bone, Hinges, Skeleton};
use crate::model::ModelError;

/// Name, bones without hinges, and hinges. Skeletons of earlier versions have no hinges.
#[derive(Deserialize, Serialize)]
pub(super) struct SkeletonParts(String, Vec<Bone>, #[serde(default)] Hinges);

impl From<Skeleton> for SkeletonParts {
    fn from(skeleton: Skeleton) -> Self {
        let hinges = skeleton.hinges();
        let mut bones = skeleton.bones;
        for (bone, hinged) in &skeleton.hinges {
            bones[bone.index()].limits = hinged.limits;
        }
        Self(skeleton.model.name().to_owned(), bones, hinges)
    }
}

impl TryFrom<SkeletonParts> for Skeleton {
    type Error = ModelError;

    fn try_from(SkeletonParts(name, bones, hinges): SkeletonParts) -> Result<Self, ModelError> {
        let skeleton = Self::new(name, bones)?;
        match hinges.is_empty() {
            true => Ok(skeleton),
            false => skeleton.with_hinges(&hinges),
        }
    }
}
