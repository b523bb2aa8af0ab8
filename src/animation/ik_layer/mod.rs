//! IK layers over animated poses: limbs and aims in closed form, and tasks of a general solver.

mod aim;
mod armature_skeleton;
mod bone_placement;
mod held_rotation;
mod limb;
mod pose_angles;
mod pose_turns;
mod reach;
mod reach_error;
mod shear_correction;
mod stance;

pub use aim::{Aim, AimError, AimGoal};
pub use limb::{EndRotation, Limb, LimbError, LimbGoal};
pub use pose_angles::EulerPoseMap;
pub(crate) use pose_angles::{bone_angles, bone_rotation};
pub use pose_turns::BallPoseMap;
pub use reach::{NoEffector, ReachLayer};
pub use reach_error::ReachError;
pub(crate) use shear_correction::{Corrected, ShearCorrection};
