//! Catmull-Rom splines: curves through points, with tangents from neighbouring points.
//!
//! Catmull & Rom 1974, "A class of local interpolating splines".
//! Barry & Goldman 1988, "A recursive evaluation algorithm for a class of Catmull-Rom splines", for arbitrary knots.
//! Centripetal knots avoid cusps and loops within a segment (Yuksel, Schaefer & Keyser 2011, "Parameterization and
//! applications of Catmull-Rom curves").

use super::{CurveValue, Hermite, KeyError, KeyedCurve, Real};

/// Knot spacing between neighbouring points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum Knots {
    /// 1 for each pair: the classic matrix form.
    Uniform,
    /// Square root of the distance.
    #[default]
    Centripetal,
    /// Distance.
    Chordal,
}

impl Knots {
    /// Knots of the points, the first at 0. Coincident points get equal knots.
    #[must_use]
    pub fn of<V: CurveValue, const N: usize>(self, points: &[V; N]) -> [V::Real; N] {
        let mut knot = V::Real::from(0.0);
        let mut previous: Option<V> = None;
        points.map(|point| {
            if let Some(previous) = previous {
                knot = knot + self.between(previous, point);
            }
            previous = Some(point);
            knot
        })
    }

    /// Knot interval between two neighbouring points.
    fn between<V: CurveValue>(self, from: V, to: V) -> V::Real {
        let distance = (to - from).length();
        match self {
            Self::Uniform => V::Real::from(1.0),
            Self::Centripetal => distance.power(V::Real::from(0.5)),
            Self::Chordal => distance,
        }
    }
}

impl<V: CurveValue> KeyedCurve<V> {
    /// Catmull-Rom spline through points without times, such as a path. It consists of the segments of
    /// [`catmull_rom_at_knots`], with the knots as times.
    ///
    /// The times start at 0 and end at the last of [`times`](Self::times). At an end, the missing neighbour is the
    /// mirror image of the existing one. The tangent there is therefore the chord.
    ///
    /// ```
    /// use glam::DVec2;
    /// use kinopt::animation::curve::{KeyedCurve, Knots};
    ///
    /// let points = [[0.0, 0.0], [1.0, 2.0], [4.0, 2.0], [5.0, 0.0]].map(DVec2::from);
    /// let path = KeyedCurve::through(points.to_vec(), Knots::Centripetal)?;
    /// let end = path.times()[3];
    /// // Symmetric points make a symmetric path.
    /// assert!((path.at(0.5 * end).x - 2.5).abs() < 1e-12);
    /// # Ok::<(), kinopt::animation::curve::KeyError>(())
    /// ```
    ///
    /// # Errors
    /// - There are no points, or one is not finite.
    /// - Two neighbouring points coincide and the knots are not uniform.
    pub fn through(points: Vec<V>, knots: Knots) -> Result<Self, KeyError> {
        if let Some(key) = points.iter().position(|point| !point.all_finite()) {
            return Err(KeyError::NonFiniteValue { key, what: "point" });
        }
        let mut knot = V::Real::from(0.0);
        let steps = points.windows(2).map(|pair| {
            knot = knot + knots.between(pair[0], pair[1]);
            knot
        });
        let start = points.first().map(|_| V::Real::from(0.0));
        let times: Vec<V::Real> = start.into_iter().chain(steps).collect();
        // Checks the preconditions of the tangents below.
        let straight = Self::linear(times, points).map_err(|error| match error {
            KeyError::NotIncreasing { key: point, .. } => KeyError::SamePlace { point },
            other => other,
        })?;
        let (times, points) = (straight.times(), straight.values());
        let slope = |from: usize, to: usize| {
            let time = *times.get(to)? - *times.get(from)?;
            Some((*points.get(to)? - *points.get(from)?) * (V::Real::from(1.0) / time))
        };
        let tangents = (0..points.len()).map(|key| {
            let before = key.checked_sub(1);
            let [backward, across] = [
                before.and_then(|k| slope(k, key)),
                before.and_then(|k| slope(k, key + 1)),
            ];
            let rate = match (backward, across, slope(key, key + 1)) {
                (Some(backward), Some(across), Some(next)) => backward - across + next,
                (Some(only), _, _) | (_, _, Some(only)) => only,
                _ => points[key] * V::Real::from(0.0),
            };
            [rate; 2]
        });
        let tangents = tangents.collect();
        Self::cubic(times.to_vec(), points.to_vec(), tangents)
    }
}

/// Uniform segment from `points[1]` to `points[2]` at u in [0, 1]: the Hermite segment with tangents (P_{i+1} −
/// P_{i−1}) / 2.
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

/// Segment from `points[1]` to `points[2]` with arbitrary knots, at u in [0, 1] between their knots. If an outer knot
/// coincides with an inner one, the tangent there is the chord of the segment.
#[must_use]
pub fn catmull_rom_at_knots<V: CurveValue>(points: [V; 4], knots: [V::Real; 4], u: V::Real) -> V {
    let [before, start, end, after] = points;
    let [t0, t1, t2, t3] = knots;
    let zero = V::Real::from(0.0);
    let length = t2 - t1;
    let one = V::Real::from(1.0);
    let slope = |from: V, to: V, time: V::Real| {
        // A neighbour at an equal knot does not define a direction.
        let usable = time > zero;
        usable.then(|| (to - from) * (one / time))
    };
    let Some(inner) = slope(start, end, length) else {
        return start;
    };
    // Derivative of Barry and Goldman's pyramid at the two inner knots.
    let tangent = |outer: Option<V>, across: Option<V>| match (outer, across) {
        (Some(outer), Some(across)) => outer - across + inner,
        _ => inner,
    };
    let segment = Hermite {
        start,
        leaving: tangent(slope(before, start, t1 - t0), slope(before, end, t2 - t0)) * length,
        end,
        arriving: tangent(slope(end, after, t3 - t2), slope(start, after, t3 - t1)) * length,
    };
    segment.position(u)
}
