//! What a run tells while it goes on.

use crate::animation::Event;

/// An event of a clip that a state machine went by.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct StateEvent<'a> {
    /// The name of the state whose clip it is; in a cross-fade, the one that is left or the one that
    /// is entered.
    pub state: &'a str,
    /// The name of the clip.
    pub clip: &'a str,
    /// The event.
    pub event: &'a Event,
    /// How much of the pose was that clip's at that moment, within [0, 1]: a footstep of a clip that
    /// hardly shows need not be heard.
    pub weight: f32,
}
