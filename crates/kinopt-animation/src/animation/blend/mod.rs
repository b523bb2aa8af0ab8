//! Pose blending: cross-fades, weighted means, masks and layers.

mod cross_fade;
mod layer;
mod mask;
mod slerp_weights;
mod weighted;

pub use layer::{Layer, LayerMode};
pub use mask::BoneMask;
pub(super) use mask::{clamp_to_unit, finite_or_0};
pub use weighted::blend_poses;
