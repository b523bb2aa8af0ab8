//! Poses combined: cross-fades, weighted means, masks and layers.

mod cross_fade;
mod layer;
mod mask;
mod slerp_weights;
mod weighted;

pub use layer::{Layer, LayerMode};
pub(super) use mask::within;
pub use mask::{BoneMask, MaskError};
pub use weighted::{BlendError, blend_poses};
