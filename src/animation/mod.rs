//! Motion over time: keyframes and what is between them.

mod catmull_rom;
mod euler_clip;

pub use catmull_rom::{Playback, SampleError};
pub use euler_clip::{ClipError, EulerClip, EulerKey, EulerTrack};
