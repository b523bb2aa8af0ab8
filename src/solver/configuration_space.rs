//! The space that x is from: the one place that knows how it is moved and bounded.

use super::rotation_sets::{self, RotationSets, Swing};

/// Which end of a joint's range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Side {
    /// The lower limit.
    Lower,
    /// The upper limit, or the edge of a cone.
    Upper,
}

/// How variables are moved by a step, compared, and kept within their bounds.
///
/// Every variable is a number within its bounds. Beside those, three may be a rotation vector, of which
/// one by more than half a turn is replaced by a shorter one, and two a ball joint's swing, within an ellipse:
/// on its edge a step has for the first of them what leads across it, outward, and for the second what leads
/// along, so that on an edge as on a bound one variable is held and the others are free.
#[derive(Clone, Copy, Debug)]
pub struct ConfigurationSpace<'a> {
    lower: &'a [f64],
    upper: &'a [f64],
    rotations: &'a RotationSets,
}

impl<'a> ConfigurationSpace<'a> {
    /// The box between bounds, one each a variable.
    #[must_use]
    pub fn new(lower: &'a [f64], upper: &'a [f64]) -> Self {
        Self {
            lower,
            upper,
            rotations: const { &RotationSets::NONE },
        }
    }

    /// The same with variables that turn ball joints.
    pub(crate) fn with_rotations(self, rotations: &'a RotationSets) -> Self {
        Self { rotations, ..self }
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
        for (swing, [across, along]) in self.edges(x) {
            let [out, on] = [0, 1].map(|k| share * step[swing.first + k]);
            to[swing.first] = x[swing.first] + across * out - along * on;
            to[swing.first + 1] = x[swing.first + 1] + along * out + across * on;
        }
    }

    /// The swings at their edges, with the outward normals there.
    fn edges(&self, x: &[f64]) -> impl Iterator<Item = (&'a Swing, [f64; 2])> {
        let swings = self.rotations.swings.iter();
        swings.filter_map(move |swing| Some((swing, swing.normal(x)?)))
    }

    /// Turns derivatives by the variables into derivatives by a step's components: the columns of a Jacobian
    /// of so many rows, or with one row a gradient.
    pub(crate) fn by_steps(&self, x: &[f64], rows: usize, derivatives: &mut [f64]) {
        for (swing, [across, along]) in self.edges(x) {
            let from = swing.first * rows;
            let Some(pair) = derivatives.get_mut(from..from + 2 * rows) else {
                return;
            };
            let (first, second) = pair.split_at_mut(rows);
            for (first, second) in first.iter_mut().zip(second) {
                let (out, on) = (
                    across * *first + along * *second,
                    across * *second - along * *first,
                );
                (*first, *second) = (out, on);
            }
        }
    }

    /// Moves one component of `to` to where x is after a step along it alone, bounds aside. Returns the step
    /// that was really taken, after rounding.
    #[inline]
    pub fn integrate_one(&self, x: &[f64], component: usize, step: f64, to: &mut [f64]) -> f64 {
        if let Some(swing) = self.rotations.swing_of(component)
            && let Some([across, along]) = swing.normal(x)
        {
            let (first, second) = match component == swing.first {
                true => (across, along),
                false => (-along, across),
            };
            to[swing.first] = x[swing.first] + first * step;
            to[swing.first + 1] = x[swing.first + 1] + second * step;
            return step;
        }
        to[component] = x[component] + step;
        to[component] - x[component]
    }

    /// Puts what moved with one component back to where x is.
    #[inline]
    pub fn return_one(&self, x: &[f64], component: usize, to: &mut [f64]) {
        to[component] = x[component];
        if let Some(swing) = self.rotations.swing_of(component) {
            let pair = swing.first..swing.first + 2;
            to[pair.clone()].copy_from_slice(&x[pair]);
        }
    }

    /// Writes the step that leads from one configuration to another: to ⊖ from.
    #[inline]
    pub fn difference(&self, to: &[f64], from: &[f64], step: &mut [f64]) {
        for ((step, &to), &from) in step.iter_mut().zip(to).zip(from) {
            *step = to - from;
        }
        for &first in &self.rotations.vectors {
            rotation_sets::shorten(&mut step[first..first + 3], &to[first..first + 3]);
        }
        self.by_steps(from, 1, step);
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
        for &first in &self.rotations.vectors {
            // Within bounds of its own, as those of a move, it may not change its sign.
            if self.lower[first..first + 3]
                .iter()
                .all(|low| *low == f64::NEG_INFINITY)
            {
                rotation_sets::shortest(&mut x[first..first + 3]);
            }
        }
        for swing in &self.rotations.swings {
            swing.project(x, self.lower, self.upper);
        }
    }

    /// How far x may go down and up along one component.
    #[inline]
    #[must_use]
    pub fn room(&self, x: &[f64], component: usize) -> (f64, f64) {
        if let Some(out) = self.room_on_edge(x, component) {
            return (f64::INFINITY, out);
        }
        let value = x[component];
        (value - self.lower[component], self.upper[component] - value)
    }

    /// The step to the bound that a step along one component would cross, if it crosses one.
    #[must_use]
    pub fn stopped_step(&self, x: &[f64], component: usize, step: f64) -> Option<f64> {
        if let Some(out) = self.room_on_edge(x, component) {
            return (step > out).then_some(out);
        }
        let to = x[component] + step;
        let (lower, upper) = (self.lower[component], self.upper[component]);
        let within = lower <= to && to <= upper;
        (!within).then(|| to.clamp(lower, upper) - x[component])
    }

    /// How far a component of a swing at its edge may go up: nowhere across it.
    #[inline]
    fn room_on_edge(&self, x: &[f64], component: usize) -> Option<f64> {
        let swing = self.rotations.swing_of(component)?;
        let near = swing.normal(x).is_some();
        near.then_some(match component == swing.first && swing.is_on(x) {
            true => 0.0,
            false => f64::INFINITY,
        })
    }

    /// Which bound holds one component of x, if one does: it stands there, and a slope of more than
    /// `negligible` pushes it outward.
    #[inline]
    #[must_use]
    pub fn held_at(
        &self,
        x: &[f64],
        component: usize,
        slope: f64,
        negligible: f64,
    ) -> Option<Side> {
        if let Some(out) = self.room_on_edge(x, component) {
            return (out == 0.0 && slope < -negligible).then_some(Side::Upper);
        }
        self.bound_holding(x[component], component, slope, negligible)
    }

    /// Which bound holds a variable of its own.
    #[inline(always)]
    fn bound_holding(
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

    /// Whether a bound holds one component of x: as [`held_at`](Self::held_at).
    #[inline]
    #[must_use]
    pub fn holds(&self, x: &[f64], component: usize, slope: f64, negligible: f64) -> bool {
        self.held_at(x, component, slope, negligible).is_some()
    }

    /// Lists the variables that are free to move: all but those on a bound whose gradient pushes
    /// outward. A full step over all variables, clamped, is no descent method (Bertsekas 1982,
    /// "Projected Newton methods for optimization problems with simple constraints").
    pub(super) fn list_free(&self, x: &[f64], gradient: &[f64], free: &mut Vec<usize>) {
        let moves = |j: &usize| self.lower[*j] < self.upper[*j];
        free.clear();
        // What no edge can hold, a bound can: most models have no swings.
        match self.rotations.swings.is_empty() {
            true => {
                free.extend((0..x.len()).filter(|&j| {
                    moves(&j) && self.bound_holding(x[j], j, gradient[j], 0.0).is_none()
                }))
            }
            false => free
                .extend((0..x.len()).filter(|&j| moves(&j) && !self.holds(x, j, gradient[j], 0.0))),
        }
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
        for swing in &self.rotations.swings {
            // What the box has said of a swing at its edge was of other components.
            if swing.normal(x).is_some() {
                return self.projected_gradient_norm_at_edges(x, gradient, curvature);
            }
        }
        largest
    }

    fn projected_gradient_norm_at_edges(&self, x: &[f64], gradient: &[f64], curvature: f64) -> f64 {
        let lengths = gradient.iter().enumerate().map(|(j, slope)| {
            let (down, up) = self.room(x, j);
            let room = if *slope > 0.0 { down } else { up };
            (slope.abs() / curvature).min(room)
        });
        lengths.fold(0.0, f64::max)
    }
}
