//! Kochanek-Bartels (TCB) tangents: easing at keys by three numbers.
//!
//! Kochanek & Bartels 1984, "Interpolating splines with local tension, continuity, and bias
//! control", with the correction of speed for keys at uneven times.

use super::CurveValue;

/// How a curve passes a key. All three are usually within [−1, 1]; all zero is Catmull-Rom.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TensionContinuityBias {
    /// 1 stops at the key, −1 doubles the speed.
    pub tension: f32,
    /// Other than 0 makes a corner; −1 runs straight into and out of the key.
    pub continuity: f32,
    /// 1 overshoots the key along the way it came, −1 turns early.
    pub bias: f32,
}

impl TensionContinuityBias {
    /// The rates (per unit of time) at which a curve arrives at and leaves a key, from the changes
    /// since the key before and to the key after, and the time from the one to the other.
    #[must_use]
    pub fn rates<V: CurveValue>(self, since: V, to_next: V, time: V::Real) -> [V; 2] {
        let [one, t, c, b] = [1.0, self.tension, self.continuity, self.bias].map(V::Real::from);
        let loose = (one - t) / time;
        let mix = |c: V::Real| {
            since * (loose * (one + c) * (one + b)) + to_next * (loose * (one - c) * (one - b))
        };
        [mix(-c), mix(c)]
    }
}
