//! Clips made from others: through poses, with fewer keys, in place, without a jump where they repeat.

mod baked;
mod fewer_keys;
mod loop_seam;
mod root_motion;

pub use fewer_keys::KeyTolerance;
pub use root_motion::RootMotion;
