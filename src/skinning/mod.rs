//! Skinning: moving a mesh with the bones it is bound to.

mod linear_blend;
mod weights;

pub use linear_blend::{LinearBlend, SkinningError, single_precision_transform};
pub use weights::{Influence, ROW_SUM_TOLERANCE, SkinWeights, SkinWeightsBuilder, WeightsError};
