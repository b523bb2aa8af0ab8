//! Motion over time: keyframes and what is between them.

mod euler_clip;

pub use euler_clip::{ClipError, EulerClip, EulerKey, EulerTrack};
