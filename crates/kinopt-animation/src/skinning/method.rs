//! Skinning methods by name.

use std::fmt;
use std::str::FromStr;

use glam::Affine3A;

use super::{Deformation, DualQuaternionBlend, LinearBlend, SkinWeights, SkinningError};
use kinopt_mesh::mesh::TriangleMesh;

/// Skinning method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum SkinningMethod {
    /// `lbs`, linear blend skinning: fastest, and takes any transforms. Skin collapses at twisted joints.
    #[default]
    LinearBlend,
    /// `dqs`, dual quaternion skinning: keeps its volume at twisted joints and bulges slightly at bent ones.
    DualQuaternion,
}

/// Error for a name of no skinning method.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown skinning `{0}`; valid: lbs (linear blend), dqs (dual quaternion)")]
pub struct UnknownSkinning(pub String);

impl SkinningMethod {
    /// All methods.
    pub const ALL: [Self; 2] = [Self::LinearBlend, Self::DualQuaternion];

    /// Name of the method: `lbs` or `dqs`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::LinearBlend => "lbs",
            Self::DualQuaternion => "dqs",
        }
    }

    /// The posed mesh with any number of influences: positions, and normals if the mesh has them. There is one
    /// transform per bone, rest model → posed model. For many poses of one mesh [`MeshWeights`](super::MeshWeights) are
    /// faster.
    ///
    /// # Errors
    /// Counts differ, a number is not finite, or a transform is not rigid (dual quaternions only).
    pub fn mesh(
        self,
        rest: &TriangleMesh,
        weights: &SkinWeights,
        transforms: &[Affine3A],
    ) -> Result<TriangleMesh, SkinningError> {
        match self {
            Self::LinearBlend => LinearBlend::new(weights, transforms)?.mesh(rest),
            Self::DualQuaternion => DualQuaternionBlend::new(weights, transforms)?.mesh(rest),
        }
    }
}

impl fmt::Display for SkinningMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for SkinningMethod {
    type Err = UnknownSkinning;

    fn from_str(name: &str) -> Result<Self, UnknownSkinning> {
        let method = Self::ALL.into_iter().find(|method| method.name() == name);
        method.ok_or_else(|| UnknownSkinning(name.to_owned()))
    }
}
