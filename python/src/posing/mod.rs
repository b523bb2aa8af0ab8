//! Posing of characters: hinges, held parts, and drags of a body on its feet.

mod held;
mod hinges;
mod standing_drag;

pub(crate) use self::held::{hold_parameters, hold_postures};
pub(crate) use self::hinges::{guessed, hinges_of, named};
pub(crate) use self::standing_drag::StandingDrag;
