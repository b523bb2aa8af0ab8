//! Trajectories and paths: Cartesian paths, clips, retargeting and contact detection. Posing of characters.

pub mod clip_ik;
mod contact;
pub mod posing;
pub mod retarget;
pub mod score;
#[cfg(feature = "collision")]
mod skin_capsules;
pub mod trajectory;

pub use contact::ContactDetection;
#[cfg(feature = "collision")]
pub use skin_capsules::{ball_skin_capsules, skin_capsules};
