//! IK layers over animated poses: limbs and aims in closed form, and tasks of a general solver.

mod aim;
mod armature_skeleton;
mod ball_pose_map;
mod bone_placement;
mod euler_pose_map;
mod held_rotation;
mod limb;
mod posed_skeleton;
mod reach;
mod shear_correction;

pub use aim::{Aim, AimGoal};
pub use ball_pose_map::BallPoseMap;
pub use euler_pose_map::EulerPoseMap;
#[doc(hidden)]
pub use euler_pose_map::{bone_angles, bone_rotation};
pub use limb::{EndRotation, Limb, LimbGoal};
pub use reach::{NoEffector, ReachLayer};
#[doc(hidden)]
pub use shear_correction::{Corrected, ShearCorrection};
