//! The space that x is from: the one place that knows how it is moved and bounded.

/// How variables are moved by a step, compared, and kept within their bounds.
///
/// Every variable is a plain number today, so that a step has as many numbers as x. Joints whose
/// configuration and velocity differ in length (a free base, a ball) change what is here, not its callers.
#[derive(Clone, Copy, Debug)]
pub struct ConfigurationSpace<'a> {
    lower: &'a [f64],
    upper: &'a [f64],
}

impl<'a> ConfigurationSpace<'a> {
    /// The box between bounds, one each a variable.
    #[must_use]
    pub fn new(lower: &'a [f64], upper: &'a [f64]) -> Self {
        Self { lower, upper }
    }

    /// Whether there is a bound on either side for each of so many variables.
    #[must_use]
    pub fn is_of(&self, variables: usize) -> bool {
        self.lower.len() == variables && self.upper.len() == variables
    }

    /// Writes x ⊕ step, bounds aside.
    #[inline]
    pub fn integrate(&self, x: &[f64], step: &[f64], to: &mut [f64]) {
        self.integrate_share(x, 1.0, step, to);
    }

    /// Writes x ⊕ share · step, bounds aside.
    #[inline]
    pub fn integrate_share(&self, x: &[f64], share: f64, step: &[f64], to: &mut [f64]) {
        for ((to, &x), &step) in to.iter_mut().zip(x).zip(step) {
            *to = x + share * step;
        }
    }

    /// Moves one component of `to` to where x is after a step along it alone, bounds aside. Returns the step
    /// that was really taken, after rounding.
    #[inline]
    pub fn integrate_one(&self, x: &[f64], component: usize, step: f64, to: &mut [f64]) -> f64 {
        to[component] = x[component] + step;
        to[component] - x[component]
    }

    /// Writes the step that leads from one configuration to another: to ⊖ from.
    #[inline]
    pub fn difference(&self, to: &[f64], from: &[f64], step: &mut [f64]) {
        for ((step, &to), &from) in step.iter_mut().zip(to).zip(from) {
            *step = to - from;
        }
    }

    /// ‖to ⊖ from‖∞.
    #[must_use]
    pub fn distance(&self, to: &[f64], from: &[f64]) -> f64 {
        let moves = to.iter().zip(from).map(|(to, from)| (to - from).abs());
        moves.fold(0.0, f64::max)
    }

    /// Moves x to the nearest place within the bounds; NaN stays NaN.
    #[inline]
    pub fn project(&self, x: &mut [f64]) {
        for ((value, &low), &high) in x.iter_mut().zip(self.lower).zip(self.upper) {
            if *value < low {
                *value = low;
            } else if *value > high {
                *value = high;
            }
        }
    }

    /// How far x may go down and up along one component.
    #[inline]
    #[must_use]
    pub fn room(&self, x: &[f64], component: usize) -> (f64, f64) {
        let value = x[component];
        (value - self.lower[component], self.upper[component] - value)
    }

    /// The step to the bound that a step along one component would cross, if it crosses one.
    #[must_use]
    pub fn stopped_step(&self, x: &[f64], component: usize, step: f64) -> Option<f64> {
        let to = x[component] + step;
        let (lower, upper) = (self.lower[component], self.upper[component]);
        let within = lower <= to && to <= upper;
        (!within).then(|| to.clamp(lower, upper) - x[component])
    }

    /// Whether a variable that stands at `value` is held by a bound: a slope of more than `negligible` pushes
    /// it outward.
    #[inline]
    #[must_use]
    pub fn holds(&self, variable: usize, value: f64, slope: f64, negligible: f64) -> bool {
        (value <= self.lower[variable] && slope > negligible)
            || (value >= self.upper[variable] && slope < -negligible)
    }

    /// Lists the variables that are free to move: all but those on a bound whose gradient pushes
    /// outward. A full step over all variables, clamped, is no descent method (Bertsekas 1982,
    /// "Projected Newton methods for optimization problems with simple constraints").
    pub(super) fn list_free(&self, x: &[f64], gradient: &[f64], free: &mut Vec<usize>) {
        free.clear();
        free.extend(
            (0..x.len()).filter(|&j| {
                self.lower[j] < self.upper[j] && !self.holds(j, x[j], gradient[j], 0.0)
            }),
        );
    }

    /// ‖proj(x − g/c) − x‖∞ for a curvature c: zero exactly at the stationary points of the bounded
    /// problem, NaN where the gradient is not finite.
    #[must_use]
    pub fn projected_gradient_norm(&self, x: &[f64], gradient: &[f64], curvature: f64) -> f64 {
        let bounds = self.lower.iter().zip(self.upper);
        let mut largest = 0.0_f64;
        for ((&x, &slope), (&lower, &upper)) in x.iter().zip(gradient).zip(bounds) {
            if !slope.is_finite() {
                // `min` and `max` would drop a NaN.
                return f64::NAN;
            }
            let room = if slope > 0.0 { x - lower } else { upper - x };
            largest = largest.max((slope.abs() / curvature).min(room));
        }
        largest
    }
}
