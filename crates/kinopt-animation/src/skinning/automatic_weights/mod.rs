//! Automatic skin weights: by distance from the bones, or by bone heat weighting.

mod distance;
#[cfg(feature = "heat")]
mod heat;
mod neighbours;
mod segments;
mod smooth_pruning;

pub use distance::AutomaticWeights;
#[cfg(feature = "heat")]
pub use heat::HeatWeights;
