//! Skinning: moving a mesh with the bones it is bound to.

mod bone_motions;
mod bone_transform;
mod deformation;
mod directions;
mod dual_quaternion;
mod dual_quaternion_blend;
mod error;
mod linear_blend;
mod method;
mod vertices;
mod weights;

pub use bone_transform::single_precision_transform;
pub use deformation::Deformation;
pub use dual_quaternion::DualQuaternion;
pub use dual_quaternion_blend::DualQuaternionBlend;
pub use error::SkinningError;
pub use linear_blend::LinearBlend;
pub use method::{SkinningMethod, UnknownSkinning};
pub use vertices::{PosedVertices, RestVertices};
pub use weights::{Influence, ROW_SUM_TOLERANCE, SkinWeights, SkinWeightsBuilder, WeightsError};
