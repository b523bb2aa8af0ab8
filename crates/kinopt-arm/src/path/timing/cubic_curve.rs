//! Piecewise cubic joint curve with continuous second derivative.

/// Curve q(s) of several joints: cubic between knots, twice continuously differentiable.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct CubicCurve {
    pub(super) joints: usize,
    /// Curve parameters of the knots, ascending.
    pub(super) knots: Vec<f64>,
    /// Joint values at the knots, one row per knot.
    pub(super) values: Vec<f64>,
    /// Second derivatives at the knots, one row per knot.
    pub(super) second_derivatives: Vec<f64>,
}

/// Value and derivatives of one joint at one curve parameter.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Jet {
    pub(super) value: f64,
    pub(super) first: f64,
    pub(super) second: f64,
    pub(super) third: f64,
}

/// Largest ratio of the two outermost knot distances for not-a-knot end conditions.
const MAX_END_RATIO: f64 = 4.0;

impl CubicCurve {
    /// Interpolates rows of `joints` values by a cubic spline with not-a-knot ends (de Boor 1978, "A practical guide to
    /// splines", ch. IV).
    ///
    /// Two rows give a line, three a parabola. If the outermost knot distances differ by more than a factor of four,
    /// the second derivative is constant in the end piece instead.
    pub(super) fn through(knots: Vec<f64>, values: Vec<f64>, joints: usize) -> Self {
        let count = knots.len();
        let mut curve = Self {
            joints,
            second_derivatives: vec![0.0; values.len()],
            knots,
            values,
        };
        if count < 3 {
            return curve;
        }
        let step = |k: usize| curve.knots[k + 1] - curve.knots[k];
        // Second divided differences, times six.
        let mut rhs = vec![0.0; (count - 2) * joints];
        for k in 1..count - 1 {
            let (before, after) = (step(k - 1).recip(), step(k).recip());
            for j in 0..joints {
                let value = |k: usize| curve.values[k * joints + j];
                rhs[(k - 1) * joints + j] =
                    6.0 * ((value(k + 1) - value(k)) * after - (value(k) - value(k - 1)) * before);
            }
        }
        if count == 3 {
            let factor = (3.0 * (step(0) + step(1))).recip();
            for row in curve.second_derivatives.chunks_exact_mut(joints) {
                for (bend, side) in row.iter_mut().zip(&rhs) {
                    *bend = side * factor;
                }
            }
            return curve;
        }
        // Coefficients (a, b) of the end's second derivative: a · M of the next knot + b · M of the one after.
        let end = |outer: f64, inner: f64| {
            let ratio = outer / inner;
            match (MAX_END_RATIO.recip()..=MAX_END_RATIO).contains(&ratio) {
                true => (1.0 + ratio, -ratio),
                false => (1.0, 0.0),
            }
        };
        let first = end(step(0), step(1));
        let last = end(step(count - 2), step(count - 3));
        let inner = count - 2;
        let (mut lower, mut diagonal, mut upper) =
            (vec![0.0; inner], vec![0.0; inner], vec![0.0; inner]);
        for k in 0..inner {
            let (before, after) = (step(k), step(k + 1));
            (lower[k], diagonal[k], upper[k]) = (before, 2.0 * (before + after), after);
        }
        diagonal[0] += lower[0] * first.0;
        upper[0] += lower[0] * first.1;
        diagonal[inner - 1] += upper[inner - 1] * last.0;
        lower[inner - 1] += upper[inner - 1] * last.1;
        for k in 1..inner {
            let factor = lower[k] / diagonal[k - 1];
            diagonal[k] -= factor * upper[k - 1];
            let (done, rest) = rhs.split_at_mut(k * joints);
            for (side, above) in rest.iter_mut().zip(&done[(k - 1) * joints..]) {
                *side -= factor * above;
            }
        }
        for k in (0..inner).rev() {
            let pivot = diagonal[k].recip();
            for j in 0..joints {
                let after = match k + 1 < inner {
                    true => upper[k] * curve.second_derivatives[(k + 2) * joints + j],
                    false => 0.0,
                };
                curve.second_derivatives[(k + 1) * joints + j] =
                    (rhs[k * joints + j] - after) * pivot;
            }
        }
        for j in 0..joints {
            let bend = |k: usize| curve.second_derivatives[k * joints + j];
            let ends = [
                first.0 * bend(1) + first.1 * bend(2),
                last.0 * bend(count - 2) + last.1 * bend(count - 3),
            ];
            curve.second_derivatives[j] = ends[0];
            curve.second_derivatives[(count - 1) * joints + j] = ends[1];
        }
        curve
    }

    /// First curve parameter.
    pub(super) fn start(&self) -> f64 {
        self.knots.first().copied().unwrap_or(0.0)
    }

    /// Last curve parameter.
    pub(super) fn end(&self) -> f64 {
        self.knots.last().copied().unwrap_or(0.0)
    }

    /// Returns the index of the piece that contains a curve parameter.
    pub(super) fn piece(&self, s: f64) -> usize {
        let after = self.knots.partition_point(|knot| *knot <= s);
        after.clamp(1, self.knots.len().max(2) - 1) - 1
    }

    /// Returns value and derivatives of every joint at `s`, from the polynomials of one piece. The curve needs two
    /// knots.
    pub(super) fn jets(&self, piece: usize, s: f64) -> impl Iterator<Item = Jet> + '_ {
        let n = self.joints;
        let (from, to) = (self.knots[piece], self.knots[piece + 1]);
        let step = to - from;
        let (b, a) = ((s - from) / step, (to - s) / step);

        let (low, high) = (piece * n, (piece + 1) * n);
        (0..n).map(move |j| {
            let (y0, y1) = (self.values[low + j], self.values[high + j]);
            let (m0, m1) = (
                self.second_derivatives[low + j],
                self.second_derivatives[high + j],
            );
            Jet {
                value: a * y0
                    + b * y1
                    + step * step / 6.0 * (a * (a * a - 1.0) * m0 + b * (b * b - 1.0) * m1),
                first: (y1 - y0) / step
                    + step / 6.0 * ((3.0 * b * b - 1.0) * m1 - (3.0 * a * a - 1.0) * m0),
                second: a * m0 + b * m1,
                third: (m1 - m0) / step,
            }
        })
    }

    /// Appends a knot.
    pub(super) fn push(
        &mut self,
        s: f64,
        values: impl IntoIterator<Item = f64>,
        second_derivatives: impl IntoIterator<Item = f64>,
    ) {
        self.knots.push(s);
        self.values.extend(values);
        self.second_derivatives.extend(second_derivatives);
    }
}
