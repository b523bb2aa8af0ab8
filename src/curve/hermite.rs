//! Cubic Hermite segments: two end values and two tangents.

use super::CurveValue;

/// Cubic over u in [0, 1] with end values and tangents. Tangents are per unit of u; multiply a rate per second by the
/// segment's duration in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hermite<V> {
    /// Value at u = 0.
    pub start: V,
    /// Derivative by u at 0.
    pub leaving: V,
    /// Value at u = 1.
    pub end: V,
    /// Derivative by u at 1.
    pub arriving: V,
}

impl<V: CurveValue> Hermite<V> {
    /// Value at u: (2u³−3u²+1) p₀ + (u³−2u²+u) m₀ + (3u²−2u³) p₁ + (u³−u²) m₁. With equal ends and zero tangents the
    /// result is exactly that value.
    #[inline]
    #[must_use]
    pub fn position(&self, u: V::Real) -> V {
        let [one, two, three] = [1.0, 2.0, 3.0].map(V::Real::from);
        let rest = one - u;
        let toward_end = u * u * (three - two * u);
        let along = self.leaving * rest - self.arriving * u;
        self.start + (self.end - self.start) * toward_end + along * (u * rest)
    }

    /// Derivative by u.
    #[must_use]
    pub fn tangent(&self, u: V::Real) -> V {
        let [one, two, three, six] = [1.0, 2.0, 3.0, 6.0].map(V::Real::from);
        let rest = one - u;
        (self.end - self.start) * (six * u * rest)
            + self.leaving * (rest * (one - three * u))
            + self.arriving * (u * (three * u - two))
    }
}
