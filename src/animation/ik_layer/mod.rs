//! Inverse kinematics as a layer over animated poses: limbs and aims in closed form, and the
//! optimiser for everything else.

mod aim;
mod armature_skeleton;
mod bridge;
mod held;
mod limb;
mod placed;
mod reach;
mod reach_error;
mod stance;

pub use aim::{Aim, AimError, AimGoal};
pub use bridge::PoseBridge;
pub use limb::{EndRotation, Limb, LimbError, LimbGoal};
pub use reach::{NoEffector, ReachLayer};
pub use reach_error::ReachError;
