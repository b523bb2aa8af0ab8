//! Cubic Bézier curves.

use super::{CurveValue, Real, lerp};

/// Cubic Bézier curve from the first to the last of four control points. It leaves towards the second, arrives from the
/// third, and stays within their convex hull.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubicBezier<V> {
    /// P₀, P₁, P₂, P₃.
    pub points: [V; 4],
}

impl<V: CurveValue> CubicBezier<V> {
    /// Curve with these control points.
    #[must_use]
    pub fn new(points: [V; 4]) -> Self {
        Self { points }
    }

    /// B(u) for u in [0, 1], by de Casteljau's algorithm.
    #[must_use]
    pub fn position(&self, u: V::Real) -> V {
        let (_, [left, right]) = self.de_casteljau(u);
        lerp(left, right, u)
    }

    /// Derivative dB/du = 3 (1−u)² (P₁−P₀) + 6 (1−u) u (P₂−P₁) + 3 u² (P₃−P₂). Computed as three times the difference
    /// of the last two points of de Casteljau's algorithm.
    #[must_use]
    pub fn tangent(&self, u: V::Real) -> V {
        let (_, [left, right]) = self.de_casteljau(u);
        (right - left) * V::Real::from(3.0)
    }

    /// Splits the curve at u; each part is over [0, 1].
    #[must_use]
    pub fn split(&self, u: V::Real) -> [Self; 2] {
        let ([first, _, last], [left, right]) = self.de_casteljau(u);
        let [start, .., end] = self.points;
        let middle = lerp(left, right, u);
        [
            Self::new([start, first, left, middle]),
            Self::new([middle, right, last, end]),
        ]
    }

    /// Points of de Casteljau's first and second round.
    fn de_casteljau(&self, u: V::Real) -> ([V; 3], [V; 2]) {
        let [p0, p1, p2, p3] = self.points;
        let first @ [a, b, c] = [lerp(p0, p1, u), lerp(p1, p2, u), lerp(p2, p3, u)];
        (first, [lerp(a, b, u), lerp(b, c, u)])
    }
}

impl CubicBezier<f64> {
    /// Parameter in [0, 1] at which a non-decreasing scalar curve from 0 to 1 takes the value `number`. Newton's method
    /// within a bracket; a step outside it becomes a bisection.
    pub(super) fn parameter_at(&self, number: f64) -> f64 {
        let (mut low, mut high, mut u) = (0.0, 1.0, number);
        for _ in 0..60 {
            let error = self.position(u) - number;
            if error.abs() < 1e-12 {
                break;
            }
            if error > 0.0 {
                high = u;
            } else {
                low = u;
            }
            let newton = u - error / self.tangent(u);
            u = if low < newton && newton < high {
                newton
            } else {
                0.5 * (low + high)
            };
        }
        u
    }

    /// Slope of `values` over this scalar curve at u: the quotient of the tangents. u is clamped to
    /// [1e-6, 1 − 1e-6], because a coincident handle makes both tangents zero at an end.
    pub(super) fn slope_of<V: CurveValue>(&self, values: &CubicBezier<V>, u: f64) -> V {
        const END_MARGIN: f64 = 1e-6;
        let u = u.clamp(END_MARGIN, 1.0 - END_MARGIN);
        let run = self.tangent(u).max(f64::from(f32::MIN_POSITIVE));
        values.tangent(V::Real::from_f64(u)) * V::Real::from_f64(1.0 / run)
    }
}
