//! The space that x is from: the one place that knows how it is moved and bounded.

use super::ball_joints::{RotationSets, TurnLimit, shorten, shortest};
use super::linear::largest;

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
            shorten(&mut step[first..first + 3], &to[first..first + 3]);
        }
        for frame in self.frames(from) {
            frame.components(step);
        }
    }

    /// ‖to ⊖ from‖∞; `step` is room for the [`difference`](Self::difference).
    #[must_use]
    pub fn distance(&self, to: &[f64], from: &[f64], step: &mut [f64]) -> f64 {
        self.difference(to, from, step);
        largest(step)
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
                shortest(&mut x[first..first + 3]);
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
}
