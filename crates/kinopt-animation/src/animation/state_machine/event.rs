//! Events reported by a run.

use crate::animation::Event;

/// Clip event passed by a state machine.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct StateEvent<'a> {
    /// Name of the state of the clip; in a cross-fade, the state being left or entered.
    pub state: &'a str,
    /// Name of the clip.
    pub clip: &'a str,
    /// The event.
    pub event: &'a Event,
    /// Weight of the clip in the pose at that time, within [0, 1]. It can suppress, for example, footsteps of a clip
    /// with a small weight.
    pub weight: f32,
}
