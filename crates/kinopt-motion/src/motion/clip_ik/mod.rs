//! Inverse kinematics over an animation clip: targets of bones over spans, and foot plants.
//!
//! Each frame keeps as close to the clip as its targets allow. The root moves only where limbs would be too short.
//! [`ClipIk`] has the targets and options; [`solve`](ClipIk::solve) returns an [`EditedClip`]. [`ground_speed`]
//! measures the speed of the ground below feet that walk on the spot. [`KeyframeIk`] edits the existing keys of a rig
//! instead.

mod clip_solver;
mod edited;
mod effector;
mod error;
mod foot_drift;
mod frame_solver;
mod ground_speed;
mod keyframes;
mod plan;
mod posed_bones;
mod root;
mod root_bone;
mod sampling;
mod solved_samples;
mod solving;
mod splice;

pub use clip_solver::ClipIk;
pub use edited::{EditReport, EditedClip, FootPlant, ReachResult};
pub use effector::Reach;
pub use error::ClipIkError;
pub use ground_speed::ground_speed;
pub use keyframes::{BeyondLimit, EditedKeys, KeyframeIk};
