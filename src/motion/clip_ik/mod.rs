//! Inverse kinematics over a clip: bones that reach over spans of it, and feet that stand where it has them stand.
//!
//! Each frame keeps as near to the clip as its goals allow, and the root moves only where limbs would be too short. A
//! [`ClipIk`] says what is asked, its [`solve`](ClipIk::solve) makes an [`EditedClip`]; [`ground_speed`] tells how fast
//! the ground passes under feet that walk on the spot. A [`KeyframeIk`] solves for a rig's own keys instead.

mod clip_solver;
mod edited;
mod effector;
mod error;
mod foot_drift;
mod frame_solver;
mod ground_speed;
mod keyframes;
mod plan;
mod planting;
mod posed_bones;
mod root;
mod root_bone;
mod sampling;
mod solved_moments;
mod solving;
mod splice;

pub use clip_solver::ClipIk;
pub use edited::{EditedClip, FootPlant, ReachResult};
pub use effector::Reach;
pub use error::ClipIkError;
pub use ground_speed::ground_speed;
pub use keyframes::{BeyondLimit, EditedKeys, KeyframeIk};
