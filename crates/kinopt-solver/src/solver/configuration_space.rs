//! Configuration space of a solver: integration, difference, bounds and projection.

use super::ball_joints::{RotationSets, TurnLimit, shorten_rotation_step, shorten_rotation_vector};
use super::linear::largest;

/// End of a joint's range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Side {
    /// Lower limit.
    Lower,
    /// Upper limit, or the edge of a cone.
    Upper,
}

/// Configuration space: integrates steps, compares configurations, and keeps them within bounds.
///
/// Every variable is a number within its bounds. In addition, variables may form groups:
/// - Three may be a rotation vector, which is replaced by a shorter one beyond half a revolution.
/// - Two may be the swing of a ball joint, within an ellipse.
/// - Three may be a ball joint within an angle of some rotation.
///
/// At the edge of a group, one component of a step points across the edge, outward. All other components point along
/// the edge. An edge thus holds one component, as a bound does, and the rest are free.
#[derive(Clone, Copy, Debug)]
pub struct ConfigurationSpace<'a> {
    pub(super) lower: &'a [f64],
    pub(super) upper: &'a [f64],
    pub(super) rotations: &'a RotationSets,
    /// Limits of the angles of ball joints from their start.
    pub(super) moves: &'a [TurnLimit],
}

impl<'a> ConfigurationSpace<'a> {
    /// Box between bounds, one pair per variable.
    #[must_use]
    pub fn new(lower: &'a [f64], upper: &'a [f64]) -> Self {
        Self {
            lower,
            upper,
            rotations: const { &RotationSets::NONE },
            moves: &[],
        }
    }

    /// The same space with ball joints and limits of their motion.
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

    /// Returns true if there are lower and upper bounds for this number of variables.
    #[must_use]
    pub fn is_of(&self, variables: usize) -> bool {
        self.lower.len() == variables && self.upper.len() == variables
    }

    /// Writes x ⊕ step, regardless of bounds.
    #[inline]
    pub fn integrate(&self, x: &[f64], step: &[f64], to: &mut [f64]) {
        self.integrate_share(x, 1.0, step, to);
    }

    /// Writes x ⊕ fraction · step, regardless of bounds.
    #[inline]
    pub fn integrate_share(&self, x: &[f64], fraction: f64, step: &[f64], to: &mut [f64]) {
        for ((to, &x), &step) in to.iter_mut().zip(x).zip(step) {
            *to = x + fraction * step;
        }
        for frame in self.frames(x) {
            frame.integrate(x, fraction, step, to);
        }
    }

    /// Writes x, moved by a step along one component, to the variables of `to` that it moves, regardless of bounds.
    ///
    /// Returns the step after rounding.
    #[inline]
    pub fn integrate_one(&self, x: &[f64], component: usize, step: f64, to: &mut [f64]) -> f64 {
        if let Some(frame) = self.frame_of(x, component) {
            frame.integrate_one(x, component, step, to);
            return step;
        }
        to[component] = x[component] + step;
        to[component] - x[component]
    }

    /// Resets the variables of `to` that one component moves to those of x.
    #[inline]
    pub fn return_one(&self, x: &[f64], component: usize, to: &mut [f64]) {
        to[component] = x[component];
        if let Some(frame) = self.frame_of(x, component) {
            to[frame.variables()].copy_from_slice(&x[frame.variables()]);
        }
    }

    /// Writes the step from one configuration to another: to ⊖ from.
    #[inline]
    pub fn difference(&self, to: &[f64], from: &[f64], step: &mut [f64]) {
        for ((step, &to), &from) in step.iter_mut().zip(to).zip(from) {
            *step = to - from;
        }
        for &first in &self.rotations.vectors {
            shorten_rotation_step(&mut step[first..first + 3], &to[first..first + 3]);
        }
        for frame in self.frames(from) {
            frame.components(step);
        }
    }

    /// ‖to ⊖ from‖∞; `step` is a buffer for the [`difference`](Self::difference).
    #[must_use]
    pub fn distance(&self, to: &[f64], from: &[f64], step: &mut [f64]) -> f64 {
        self.difference(to, from, step);
        largest(step)
    }

    /// Projects x to the nearest point within the bounds; NaN stays NaN.
    #[inline]
    pub fn project(&self, x: &mut [f64]) {
        // Before the box, whose corners have other nearest points on an ellipse. And after it, as the box of a bounded
        // motion may be anywhere.
        for swing in &self.rotations.swings {
            swing.project(x);
        }
        for ((value, &lower), &upper) in x.iter_mut().zip(self.lower).zip(self.upper) {
            if *value < lower {
                *value = lower;
            } else if *value > upper {
                *value = upper;
            }
        }
        for &first in &self.rotations.vectors {
            // Within bounds, as those of a motion, the vector must not change its sign.
            if self.lower[first..first + 3]
                .iter()
                .all(|lower| *lower == f64::NEG_INFINITY)
            {
                shorten_rotation_vector(&mut x[first..first + 3]);
            }
        }
        for swing in &self.rotations.swings {
            swing.project(x);
        }
        for (turn, is_move) in self.turns() {
            turn.project(x, |values| self.keeps(turn.first, values, is_move));
        }
    }

    /// Largest decrease and increase of x along one component.
    #[inline]
    #[must_use]
    pub fn room(&self, x: &[f64], component: usize) -> (f64, f64) {
        if let Some(max_increase) = self.max_increase_on_edge(x, component) {
            return (f64::INFINITY, max_increase);
        }
        let value = x[component];
        (value - self.lower[component], self.upper[component] - value)
    }

    /// Returns true if one component of x may both increase and decrease.
    pub(crate) fn is_between_bounds(&self, x: &[f64], component: usize) -> bool {
        let (max_decrease, max_increase) = self.room(x, component);
        max_decrease > 0.0 && max_increase > 0.0
    }

    /// Step to the bound that a step along one component would cross; `None` if it crosses none.
    #[must_use]
    pub fn stopped_step(&self, x: &[f64], component: usize, step: f64) -> Option<f64> {
        if let Some(max_increase) = self.max_increase_on_edge(x, component) {
            return (step > max_increase).then_some(max_increase);
        }
        let end = x[component] + step;
        let (lower, upper) = (self.lower[component], self.upper[component]);
        let is_within = lower <= end && end <= upper;
        (!is_within).then(|| end.clamp(lower, upper) - x[component])
    }
}
