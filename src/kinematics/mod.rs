//! From configurations to placements, and their derivatives.
//!
//! [`Tree`] is a model compiled for one purpose: the joints that move the frames asked for, with
//! everything constant folded in. [`TreeState`] is its scratch memory, over any scalar.

mod geometric_jacobian;
mod reverse;
mod state;
mod tree;

pub use geometric_jacobian::Partials;
pub use reverse::{Wrench, Wrenches};
pub use state::TreeState;
pub use tree::{FrameSlot, Tree};
