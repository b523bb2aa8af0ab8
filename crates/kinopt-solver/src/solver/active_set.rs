//! Active set: variables that limits hold, free variables, and stationarity within limits.

use super::{ConfigurationSpace, Side};

impl ConfigurationSpace<'_> {
    /// Bound that holds one component of x, if any.
    ///
    /// A bound holds a component that is at it while a slope of more than `negligible` pushes the component outward.
    #[inline]
    #[must_use]
    pub fn held_at(
        &self,
        x: &[f64],
        component: usize,
        slope: f64,
        negligible: f64,
    ) -> Option<Side> {
        if let Some(max_increase) = self.max_increase_on_edge(x, component) {
            return (max_increase == 0.0 && slope < -negligible).then_some(Side::Upper);
        }
        self.holding_bound(x[component], component, slope, negligible)
    }

    /// Bound that holds a variable by its interval, if any.
    #[inline(always)]
    fn holding_bound(
        &self,
        value: f64,
        variable: usize,
        slope: f64,
        negligible: f64,
    ) -> Option<Side> {
        if value <= self.lower[variable] && slope > negligible {
            Some(Side::Lower)
        } else if value >= self.upper[variable] && slope < -negligible {
            Some(Side::Upper)
        } else {
            None
        }
    }

    /// Returns true if a bound holds one component of x, as [`held_at`](Self::held_at).
    #[inline]
    #[must_use]
    pub fn holds(&self, x: &[f64], component: usize, slope: f64, negligible: f64) -> bool {
        self.held_at(x, component, slope, negligible).is_some()
    }

    /// Lists the variables that are free to move: all but those at a bound whose descent direction points outward.
    ///
    /// A full step over all variables, clamped, is no descent method (Bertsekas 1982, "Projected Newton methods for
    /// optimization problems with simple constraints").
    pub(super) fn list_free(&self, x: &[f64], gradient: &[f64], free: &mut Vec<usize>) {
        let is_movable = |j: &usize| self.lower[*j] < self.upper[*j];
        free.clear();
        // Without ball joint limits, which most models do not have, intervals suffice.
        match !self.has_edges() {
            true => free.extend((0..x.len()).filter(|&j| {
                is_movable(&j) && self.holding_bound(x[j], j, gradient[j], 0.0).is_none()
            })),
            false => free.extend(
                (0..x.len()).filter(|&j| is_movable(&j) && !self.holds(x, j, gradient[j], 0.0)),
            ),
        }
    }

    /// ‖proj(x − g/c) − x‖∞ for a curvature c.
    ///
    /// It is zero exactly at the stationary points of the bounded problem, and NaN if the gradient is not finite.
    #[must_use]
    pub fn projected_gradient_norm(&self, x: &[f64], gradient: &[f64], curvature: f64) -> f64 {
        let bounds = self.lower.iter().zip(self.upper);
        let mut max_step = 0.0_f64;
        for ((&value, &slope), (&lower, &upper)) in x.iter().zip(gradient).zip(bounds) {
            if !slope.is_finite() {
                // `min` and `max` would drop a NaN.
                return f64::NAN;
            }
            let slack = if slope > 0.0 {
                value - lower
            } else {
                upper - value
            };
            max_step = max_step.max((slope.abs() / curvature).min(slack));
        }
        // At the edge of a ball joint's limits, components are not variables.
        match self.frames(x).next() {
            Some(_) => self.projected_gradient_norm_at_edges(x, gradient, curvature),
            None => max_step,
        }
    }

    fn projected_gradient_norm_at_edges(&self, x: &[f64], gradient: &[f64], curvature: f64) -> f64 {
        let lengths = gradient.iter().enumerate().map(|(j, slope)| {
            let (max_decrease, max_increase) = self.room(x, j);
            let slack = if *slope > 0.0 {
                max_decrease
            } else {
                max_increase
            };
            (slope.abs() / curvature).min(slack)
        });
        lengths.fold(0.0, f64::max)
    }
}
