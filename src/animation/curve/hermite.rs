//! Cubic Hermite segments: two ends and the tangents there.

use super::CurveValue;

/// A cubic over u in [0, 1] that leaves `start` with tangent `leaving` and arrives at `end` with
/// tangent `arriving`; tangents are per unit of u (multiply a rate per second by the segment's
/// seconds).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hermite<V> {
    /// The value at u = 0.
    pub start: V,
    /// The derivative by u at 0.
    pub leaving: V,
    /// The value at u = 1.
    pub end: V,
    /// The derivative by u at 1.
    pub arriving: V,
}

impl<V: CurveValue> Hermite<V> {
    /// The value at u: (2u³−3u²+1) p₀ + (u³−2u²+u) m₀ + (3u²−2u³) p₁ + (u³−u²) m₁, written so that
    /// equal ends without tangents give that value exactly.
    #[inline]
    #[must_use]
    pub fn position(&self, u: V::Real) -> V {
        let [one, two, three] = [1.0, 2.0, 3.0].map(V::Real::from);
        let rest = one - u;
        let toward_end = u * u * (three - two * u);
        let along = self.leaving * rest - self.arriving * u;
        self.start + (self.end - self.start) * toward_end + along * (u * rest)
    }

    /// The derivative by u.
    #[must_use]
    pub fn tangent(&self, u: V::Real) -> V {
        let [one, two, three, six] = [1.0, 2.0, 3.0, 6.0].map(V::Real::from);
        let rest = one - u;
        (self.end - self.start) * (six * u * rest)
            + self.leaving * (rest * (one - three * u))
            + self.arriving * (u * (three * u - two))
    }
}
