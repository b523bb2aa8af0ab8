//! Motion of the SMPL family of body models: SMPL, SMPL-H and SMPL-X, as in AMASS.
//!
//! A file has rotations only; the rest joints come from the first of these sources that exists:
//!
//! 1. `jtr` of the file: rest joints of shape (joints, 3), or posed joints of shape (frames, joints, 3);
//! 2. a [`BodyModel`], with the shape parameters `betas` of the file;
//! 3. a default skeleton for a given height, with a note. Its proportions are those of Drillis & Contini (1966).
//!
//! The result has an armature with the joint names of the family (`pelvis`, `left_hip`, …) in metres, and a clip with
//! the rotations. The rest pose is the T-pose. It is upright along the axis of the motion: z in AMASS, y in many other
//! files.
//!
//! Source of the format: Loper et al. 2015, "SMPL: A skinned multi-person linear model"; Pavlakos et al. 2019,
//! "Expressive body capture" (SMPL-X); Mahmood et al. 2019, "AMASS".

mod arrays;
mod body_model;
mod default_skeleton;
mod error;
#[cfg(feature = "npz")]
mod file;
mod joints;
mod motion;
mod note;

pub use arrays::SmplArrays;
pub use body_model::BodyModel;
pub use default_skeleton::{DEFAULT_HEIGHT, default_joints};
pub use error::SmplError;
#[cfg(feature = "npz")]
pub use file::{read, read_body_model};
pub use motion::{RestJoints, SmplMotion};
pub use note::SmplNote;
