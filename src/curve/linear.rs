//! Linear interpolation.

use super::CurveValue;

/// (1 − u) a + u b: exactly `a` at u = 0 and `b` at u = 1.
#[inline]
#[must_use]
pub fn lerp<V: CurveValue>(a: V, b: V, u: V::Real) -> V {
    let one = V::Real::from(1.0);
    a * (one - u) + b * u
}
