//! Forward kinematics and Jacobians.
//!
//! [`ForwardKinematics`] computes the placements of a model's frames, and [`Jacobian`] their derivatives (for one
//! frame: [`frame_jacobian`]). Internally, a `Tree` is a model compiled for one list of frames. It holds the joints
//! that move these frames, with constants folded in. The code that compiles a tree checks ids and lengths, so its loops
//! do not.

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

pub use centre_of_mass::{centre_of_mass, centre_of_mass_jacobian};
#[doc(hidden)]
pub use composites::Composites;
pub use forward_kinematics::{ForwardKinematics, KinematicsError};
#[doc(hidden)]
pub use forward_pass::TreeState;
#[doc(hidden)]
pub use geometric_jacobian::Partials;
pub use jacobian::{Jacobian, frame_jacobian};
#[doc(hidden)]
pub use joint_axis::JointAxis;
#[doc(hidden)]
pub use joint_rotations::joint_rotations;
#[doc(hidden)]
pub use reverse::{Wrench, Wrenches};
#[doc(hidden)]
pub use tree::{FrameSlot, Tree, TreeWorkspace};
