//! Posing of characters: hinges of knees and elbows, and drags of a body on its feet.

mod body_axes;
mod body_limb;
mod hinge_guess;
mod leg_cones;
mod limb_chains;
mod segment_masses;
mod standing_drag;
mod support;

pub use hinge_guess::{GuessedHinge, HingeSource, guess_hinges};
pub use standing_drag::{StandingDrag, StandingDragBuilder, StandingDragError};
