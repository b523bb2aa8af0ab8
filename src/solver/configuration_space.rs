//! The space that x is from: the one place that knows how it is moved and bounded.

use super::rotation_sets::{self, RotationSets};
use super::turn_limit::TurnLimit;

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
/// one by more than half a turn is replaced by a shorter one, two a ball joint's swing, within an ellipse, and three
/// a ball joint that turns no further than an angle from some place: on an edge a step has for one of them what
/// leads across it, outward, and for the others what leads along, so that on an edge as on a bound one variable is
/// held and the others are free.
#[derive(Clone, Copy, Debug)]
pub struct ConfigurationSpace<'a> {
    pub(super) lower: &'a [f64],
    pub(super) upper: &'a [f64],
    pub(super) rotations: &'a RotationSets,
    /// How far balls may go from where they stood.
    pub(super) moves: &'a [TurnLimit],
}

impl<'a> ConfigurationSpace<'a> {
    /// The box between bounds, one each a variable.
    #[must_use]
    pub fn new(lower: &'a [f64], upper: &'a [f64]) -> Self {
        Self {
            lower,
            upper,
            rotations: const { &RotationSets::NONE },
            moves: &[],
        }
    }

    /// The same with variables that turn ball joints, no further than these moves.
    pub(crate) fn with_rotations(
        self,
        rotations: &'a RotationSets,
        moves: &'a [TurnLimit],
    ) -> Self {
        Self {
            rotations,
            moves,
            ..self
        }
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
        for frame in self.frames(x) {
            frame.integrate(x, share, step, to);
        }
    }

    /// Moves one component of `to` to where x is after a step along it alone, bounds aside. Returns the step
    /// that was really taken, after rounding.
    #[inline]
    pub fn integrate_one(&self, x: &[f64], component: usize, step: f64, to: &mut [f64]) -> f64 {
        if let Some(frame) = self.frame_of(x, component) {
            frame.integrate_one(x, component, step, to);
            return step;
        }
        to[component] = x[component] + step;
        to[component] - x[component]
    }

    /// Puts what moved with one component back to where x is.
    #[inline]
    pub fn return_one(&self, x: &[f64], component: usize, to: &mut [f64]) {
        to[component] = x[component];
        if let Some(frame) = self.frame_of(x, component) {
            to[frame.variables()].copy_from_slice(&x[frame.variables()]);
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
        for frame in self.frames(from) {
            frame.components(step);
        }
    }

    /// ‖to ⊖ from‖∞; `step` is room for the [`difference`](Self::difference).
    #[must_use]
    pub fn distance(&self, to: &[f64], from: &[f64], step: &mut [f64]) -> f64 {
        self.difference(to, from, step);
        step.iter().fold(0.0, |most, part| most.max(part.abs()))
    }

    /// Moves x to the nearest place within the bounds; NaN stays NaN.
    #[inline]
    pub fn project(&self, x: &mut [f64]) {
        // Before its box, whose corners are nearer to other places of an ellipse; and after, as a move's box may lie anywhere.
        for swing in &self.rotations.swings {
            swing.project(x);
        }
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
            swing.project(x);
        }
        for (turn, is_move) in self.turns() {
            turn.project(x, |own| self.keeps(turn.first, own, is_move));
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

    /// Whether one component of x may go both ways.
    pub(crate) fn is_between_bounds(&self, x: &[f64], component: usize) -> bool {
        let (down, up) = self.room(x, component);
        down > 0.0 && up > 0.0
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
        match !self.has_edges() {
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
        for ((&value, &slope), (&lower, &upper)) in x.iter().zip(gradient).zip(bounds) {
            if !slope.is_finite() {
                // `min` and `max` would drop a NaN.
                return f64::NAN;
            }
            let room = if slope > 0.0 {
                value - lower
            } else {
                upper - value
            };
            largest = largest.max((slope.abs() / curvature).min(room));
        }
        // What the box has said of a ball at an edge was of other components.
        match self.frames(x).next() {
            Some(_) => self.projected_gradient_norm_at_edges(x, gradient, curvature),
            None => largest,
        }
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
