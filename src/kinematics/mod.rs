//! From configurations to placements, and their derivatives.
//!
//! [`ForwardKinematics`] places the frames of a model, a [`Jacobian`] (of one frame:
//! [`frame_jacobian`]) says how they move. Inside, a tree is a model compiled for one
//! purpose: the joints that move the frames asked for, with everything constant folded in. Who
//! compiles one has checked ids and sizes, so its loops need not.

mod centre_of_mass;
mod composites;
mod forward_kinematics;
mod forward_pass;
mod geometric_jacobian;
mod jacobian;
mod joint_axis;
mod joint_rotations;
mod motion;
mod reverse;
mod tree;

pub use centre_of_mass::{CentreOfMassError, centre_of_mass, centre_of_mass_jacobian};
pub(crate) use composites::Composites;
pub use forward_kinematics::{ForwardKinematics, KinematicsError};
pub(crate) use forward_pass::TreeState;
pub(crate) use geometric_jacobian::Partials;
pub use jacobian::{Jacobian, frame_jacobian};
pub(crate) use joint_axis::JointAxis;
pub(crate) use joint_rotations::joint_rotations;
pub(crate) use reverse::{Wrench, Wrenches};
pub(crate) use tree::{FrameSlot, Tree, TreeMemory};
