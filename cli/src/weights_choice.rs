//! Methods of automatic skin weights.

use kinopt::mesh::TriangleMesh;
use kinopt::skeleton::Skeleton;
use kinopt::skinning::{AutomaticWeights, HeatWeights, SkinWeights, SkinningError};

use crate::problem::WeightsChoice;

impl WeightsChoice {
    pub(crate) fn made(
        self,
        mesh: &TriangleMesh,
        skeleton: &Skeleton,
    ) -> Result<SkinWeights, SkinningError> {
        match self {
            Self::Heat => HeatWeights::default().for_skeleton(mesh, skeleton),
            Self::Distance => AutomaticWeights::default().for_skeleton(mesh, skeleton),
        }
    }

    /// Rule of the method, which completes "each vertex follows …".
    pub(crate) fn follows(self) -> &'static str {
        match self {
            Self::Heat => "the bones that heat it along the skin",
            Self::Distance => "the bones nearest to it",
        }
    }
}
