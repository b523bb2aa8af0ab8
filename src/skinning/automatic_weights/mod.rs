//! Weights for a mesh that has none: by distance from the bones, or by heat that spreads from them over
//! the surface.

mod distance;
mod error;
#[cfg(feature = "heat")]
mod heat;
mod neighbours;
mod segments;
mod smooth_pruning;

pub use distance::AutomaticWeights;
pub use error::AutomaticWeightsError;
#[cfg(feature = "heat")]
pub use heat::HeatWeights;
