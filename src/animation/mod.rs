//! Motion over time: keyframes and what is between them.

mod affine;
pub mod curve;
mod easing;
mod euler_clip;
mod euler_sampling;
mod playback;
pub mod rotation;

pub use affine::{Decomposition, NotFinite, interpolate_affine};
pub use easing::{BezierEasing, Easing, HandleError};
pub use euler_clip::{ClipError, EulerClip, EulerKey, EulerTrack};
pub use euler_sampling::SampleError;
pub use playback::Playback;
