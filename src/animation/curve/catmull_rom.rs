//! Catmull-Rom segments: a curve through points whose tangents come from their neighbours.
//!
//! Catmull & Rom 1974, "A class of local interpolating splines"; the pyramid for any knots is
//! Barry & Goldman 1988, "A recursive evaluation algorithm for a class of Catmull-Rom splines"; the
//! centripetal choice of knots neither cusps nor loops within a segment (Yuksel, Schaefer & Keyser
//! 2011, "Parameterization and applications of Catmull-Rom curves").

use super::{CurveValue, Hermite, Real};

/// How far apart in the parameter neighbouring points are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Knots {
    /// One each: the classic matrix.
    Uniform,
    /// The square root of their distance.
    #[default]
    Centripetal,
    /// Their distance.
    Chordal,
}

impl Knots {
    /// The parameters of the points, the first at 0. Points that coincide get the same one.
    #[must_use]
    pub fn of<V: CurveValue, const N: usize>(self, points: &[V; N]) -> [V::Real; N] {
        let mut at = V::Real::from(0.0);
        let mut previous: Option<V> = None;
        points.map(|point| {
            if let Some(previous) = previous {
                let distance = (point - previous).length();
                at = at
                    + match self {
                        Self::Uniform => V::Real::from(1.0),
                        Self::Centripetal => distance.power(V::Real::from(0.5)),
                        Self::Chordal => distance,
                    };
            }
            previous = Some(point);
            at
        })
    }
}

/// The uniform segment from `points[1]` to `points[2]` at u in [0, 1]: the Hermite segment with
/// tangents (P_{i+1} − P_{i−1}) / 2.
#[must_use]
pub fn catmull_rom<V: CurveValue>(points: [V; 4], u: V::Real) -> V {
    let half = V::Real::from(0.5);
    let [before, start, end, after] = points;
    let segment = Hermite {
        start,
        leaving: (end - before) * half,
        end,
        arriving: (after - start) * half,
    };
    segment.position(u)
}

/// The segment from `points[1]` to `points[2]` for any knots, at u in [0, 1] of the way between
/// their knots. Where two knots coincide the points do not differ there, and that tangent is the
/// segment's own chord.
#[must_use]
pub fn catmull_rom_at_knots<V: CurveValue>(points: [V; 4], knots: [V::Real; 4], u: V::Real) -> V {
    let [before, start, end, after] = points;
    let [t0, t1, t2, t3] = knots;
    let zero = V::Real::from(0.0);
    let length = t2 - t1;
    let one = V::Real::from(1.0);
    let slope = |from: V, to: V, time: V::Real| {
        // A neighbour at the same knot says nothing about direction.
        let usable = time > zero;
        usable.then(|| (to - from) * (one / time))
    };
    let Some(own) = slope(start, end, length) else {
        return start;
    };
    // The derivative of Barry and Goldman's pyramid at the two inner knots.
    let tangent = |outer: Option<V>, over: Option<V>| match (outer, over) {
        (Some(outer), Some(over)) => outer - over + own,
        _ => own,
    };
    let segment = Hermite {
        start,
        leaving: tangent(slope(before, start, t1 - t0), slope(before, end, t2 - t0)) * length,
        end,
        arriving: tangent(slope(end, after, t3 - t2), slope(start, after, t3 - t1)) * length,
    };
    segment.position(u)
}
