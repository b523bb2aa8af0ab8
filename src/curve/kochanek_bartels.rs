//! Kochanek-Bartels (TCB) tangents.
//!
//! Kochanek & Bartels 1984, "Interpolating splines with local tension, continuity, and bias control", with the
//! correction of speed for keys at uneven times.

use super::CurveValue;

/// Tension, continuity and bias at a key, usually within [−1, 1]. All zero is Catmull-Rom.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TensionContinuityBias {
    /// Tension: 1 gives zero tangents, −1 doubles the tangents.
    pub tension: f32,
    /// Continuity: non-zero values make a corner; −1 gives straight segments at the key.
    pub continuity: f32,
    /// Bias: 1 overshoots the key in the incoming direction, −1 turns before it.
    pub bias: f32,
}

impl TensionContinuityBias {
    /// Rates per unit of time at which a curve arrives at and leaves a key. `since` and `to_next` are the changes from
    /// the previous and to the next key, `time` the time between those keys.
    #[must_use]
    pub fn rates<V: CurveValue>(self, since: V, to_next: V, time: V::Real) -> [V; 2] {
        let [one, t, c, b] = [1.0, self.tension, self.continuity, self.bias].map(V::Real::from);
        let factor = (one - t) / time;
        let mix = |c: V::Real| {
            since * (factor * (one + c) * (one + b)) + to_next * (factor * (one - c) * (one - b))
        };
        [mix(-c), mix(c)]
    }
}
