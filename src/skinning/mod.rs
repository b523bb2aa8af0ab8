//! Skinning: moving a mesh with the bones it is bound to.

mod weights;

pub use weights::{Influence, ROW_SUM_TOLERANCE, SkinWeights, SkinWeightsBuilder, WeightsError};
