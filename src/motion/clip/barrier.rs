//! The bounds of a motion as an interior method sees them: slacks, their multipliers, and what they add to a step.

use super::block_banded::BlockBanded;
use super::bounds::FrameBounds;
use super::length_bounds::LengthBound;
use crate::scalar::elementary;

/// A step goes at most so much of the way to where the first slack or multiplier would be zero.
const TO_THE_BOUNDARY: f64 = 0.995;
/// So many slacks are multiplied before their logarithm is taken.
const TOGETHER: usize = 8;

/// One bound: 0 ≤ s = room − sign · (x[at] − x[before]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bound {
    pub(super) at: usize,
    /// The same variable a frame before, for a bound on a move.
    pub(super) before: Option<usize>,
    /// 1 where it holds from above, −1 where from below.
    pub(super) sign: f64,
    room: f64,
    /// How large what it bounds is: a range, or a move.
    pub(super) size: f64,
}

impl Bound {
    fn way(&self, x: &[f64]) -> f64 {
        match self.before {
            None => x[self.at],
            Some(before) => x[self.at] - x[before],
        }
    }

    pub(super) fn slack(&self, x: &[f64]) -> f64 {
        self.room - self.sign * self.way(x)
    }
}

/// Every bound of some frames, with its slack s and its multiplier z.
#[derive(Clone, Debug, Default)]
pub(super) struct Barrier<'a> {
    pub(super) bounds: Vec<Bound>,
    /// Those of lengths, whose slacks and multipliers come after the others'.
    pub(super) lengths: Vec<LengthBound<'a>>,
    pub(super) slacks: Vec<f64>,
    pub(super) multipliers: Vec<f64>,
    /// How the slacks change by a step.
    slack_steps: Vec<f64>,
    /// By how much less than that those of lengths do, all the way.
    bends: Vec<f64>,
    /// How much of that a step already allows for.
    allowed: Vec<f64>,
    multiplier_steps: Vec<f64>,
}

impl<'a> Barrier<'a> {
    /// The bounds of frames in a row; those of frames that are fixed bind nothing.
    pub(super) fn new(limits: &'a FrameBounds, fixed: &[bool]) -> Self {
        let n = limits.most.len();
        let mut bounds = Vec::new();
        for frame in 0..fixed.len() {
            let moves = |variable: &usize| !limits.still[*variable];
            for variable in (0..n).filter(moves) {
                let at = frame * n + variable;
                let range = limits.upper[variable] - limits.lower[variable];
                let range = if range.is_finite() { range } else { 1.0 };
                let mut add = |before: Option<usize>, sign: f64, room: f64| {
                    if room.is_finite() {
                        bounds.push(Bound {
                            at,
                            before,
                            sign,
                            room,
                            size: before.map_or(range, |_| limits.most[variable]),
                        });
                    }
                };
                if !fixed[frame] {
                    add(None, -1.0, -limits.lower[variable]);
                    add(None, 1.0, limits.upper[variable]);
                }
                if frame > 0 && !(fixed[frame] && fixed[frame - 1]) {
                    add(Some(at - n), -1.0, limits.most[variable]);
                    add(Some(at - n), 1.0, limits.most[variable]);
                }
            }
        }
        let mut lengths = Vec::new();
        for limit in &limits.lengths {
            let first = usize::from(limit.is_of_move());
            let moves = |frame: &usize| !(fixed[*frame] && (first == 0 || fixed[frame - 1]));
            let frames = (first..fixed.len()).filter(moves);
            lengths.extend(frames.map(|frame| LengthBound::new(limit, frame, n)));
        }
        let zero = vec![0.0; bounds.len() + lengths.len()];
        Self {
            bends: vec![0.0; lengths.len()],
            allowed: vec![0.0; lengths.len()],
            lengths,
            slacks: zero.clone(),
            multipliers: zero.clone(),
            slack_steps: zero.clone(),
            multiplier_steps: zero,
            bounds,
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.slacks.is_empty()
    }

    /// How many bounds there are.
    pub(super) fn len(&self) -> usize {
        self.slacks.len()
    }

    /// Takes the slacks of x; a variable of the first bound that has none, if any.
    pub(super) fn look(&mut self, x: &[f64]) -> Option<usize> {
        let (slacks, of_lengths) = self.slacks.split_at_mut(self.bounds.len());
        for (slack, bound) in slacks.iter_mut().zip(&self.bounds) {
            *slack = bound.slack(x);
        }
        for (slack, bound) in of_lengths.iter_mut().zip(&mut self.lengths) {
            *slack = bound.look(x);
        }
        let broken = self
            .slacks
            .iter()
            .position(|slack| *slack <= 0.0 || slack.is_nan());
        broken.map(|k| match self.bounds.get(k) {
            Some(bound) => bound.at,
            None => self.lengths[k - self.bounds.len()].at(),
        })
    }

    /// Takes multipliers of which all have s z = μ.
    pub(super) fn centre(&mut self, mu: f64) {
        for (multiplier, slack) in self.multipliers.iter_mut().zip(&self.slacks) {
            *multiplier = mu / slack;
        }
    }

    /// Σ s z: how much lower the cost can be at most, but for its bending.
    pub(super) fn gap(&self) -> f64 {
        let pairs = self.slacks.iter().zip(&self.multipliers);
        pairs.map(|(slack, multiplier)| slack * multiplier).sum()
    }

    /// −Σ ln s at a place; infinite beyond a bound.
    pub(super) fn cost(&self, x: &[f64]) -> f64 {
        let mut sum = 0.0;
        for bounds in self.bounds.chunks(TOGETHER) {
            let mut product = 1.0;
            for bound in bounds {
                let slack = bound.slack(x);
                if slack <= 0.0 || slack.is_nan() {
                    return f64::INFINITY;
                }
                product *= slack;
            }
            sum -= elementary::ln(product);
        }
        for bound in &self.lengths {
            let slack = bound.slack(x);
            if slack <= 0.0 || slack.is_nan() {
                return f64::INFINITY;
            }
            sum -= elementary::ln(slack);
        }
        sum
    }

    /// The bounds of lengths with their slacks and multipliers.
    pub(super) fn with_lengths(&self) -> impl Iterator<Item = (&LengthBound<'a>, f64, f64)> {
        let pairs = self.slacks.iter().zip(&self.multipliers);
        let own = self.lengths.iter().zip(pairs.skip(self.bounds.len()));
        own.map(|(bound, (slack, multiplier))| (bound, *slack, *multiplier))
    }

    /// Adds Σ (z/s) a aᵀ, and how lengths bend.
    pub(super) fn add_to(&self, variables: usize, hessian: &mut BlockBanded) {
        let stiffness = self.multipliers.iter().zip(&self.slacks);
        for (bound, (multiplier, slack)) in self.bounds.iter().zip(stiffness) {
            let stiff = multiplier / slack;
            let (frame, variable) = (bound.at / variables, bound.at % variables);
            hessian.add(frame, 0, variable, variable, stiff);
            if bound.before.is_some() {
                hessian.add(frame - 1, 0, variable, variable, stiff);
                hessian.add(frame - 1, 1, variable, variable, -stiff);
            }
        }
        for (bound, slack, multiplier) in self.with_lengths() {
            bound.add_to(multiplier / slack, multiplier, hessian);
        }
    }

    /// Adds to what a step goes by: the push inward of a barrier of this μ.
    pub(super) fn add_push(&self, mu: f64, downhill: &mut [f64]) {
        for (bound, slack) in self.bounds.iter().zip(&self.slacks) {
            let push = bound.sign * mu / slack;
            downhill[bound.at] -= push;
            if let Some(before) = bound.before {
                downhill[before] += push;
            }
        }
        for (bound, slack, _) in self.with_lengths() {
            bound.add_push(mu / slack, downhill);
        }
    }

    /// Takes the steps of slacks and multipliers that go with a step of x towards s z = μ.
    pub(super) fn take_step(&mut self, step: &[f64], mu: f64) {
        for (k, bound) in self.bounds.iter().enumerate() {
            let (slack, multiplier) = (self.slacks[k], self.multipliers[k]);
            let by = -bound.sign * bound.way(step);
            self.slack_steps[k] = by;
            self.multiplier_steps[k] = (mu - multiplier * by) / slack - multiplier;
        }
        let plain = self.bounds.len();
        for (k, bound) in self.lengths.iter().enumerate() {
            let (slack, multiplier) = (self.slacks[plain + k], self.multipliers[plain + k]);
            let (by, bend) = bound.along(step);
            self.slack_steps[plain + k] = by;
            self.bends[k] = bend;
            let allowed = by - self.allowed[k];
            self.multiplier_steps[plain + k] = (mu - multiplier * allowed) / slack - multiplier;
        }
    }

    /// Takes note of how lengths bend along the last step; whether any do.
    pub(super) fn bend(&mut self) -> bool {
        self.allowed.copy_from_slice(&self.bends);
        self.allowed.iter().any(|bend| *bend > 0.0)
    }

    /// Lets go of that.
    pub(super) fn forget_bends(&mut self) {
        self.allowed.fill(0.0);
    }

    /// Adds to what a step goes by: as much inward as lengths bend.
    pub(super) fn add_bends(&self, downhill: &mut [f64]) {
        for ((bound, slack, multiplier), bend) in self.with_lengths().zip(&self.allowed) {
            bound.add_push(multiplier * bend / slack, downhill);
        }
    }

    /// How much of the step slacks and multipliers may go.
    pub(super) fn longest(&self) -> (f64, f64) {
        let (of_slacks, of_multipliers) = self.longest_straight();
        let plain = self.bounds.len();
        let steps = self.slacks[plain..].iter().zip(&self.slack_steps[plain..]);
        // The share α of a step at which all of the slack that may go is gone: s + α ds − α² bend = (1 − 0.995) s.
        let ends = steps.zip(&self.bends).map(|((slack, by), bend)| {
            let root = (by * by + 4.0 * bend * TO_THE_BOUNDARY * slack).sqrt();
            // Whichever of both forms loses no digits.
            match *by < 0.0 {
                true => 2.0 * TO_THE_BOUNDARY * slack / (root - by),
                false => (root + by) / (2.0 * bend),
            }
        });
        (ends.fold(of_slacks, f64::min), of_multipliers)
    }

    fn longest_straight(&self) -> (f64, f64) {
        let most = |values: &[f64], steps: &[f64]| {
            let ends = values.iter().zip(steps).filter(|(_, step)| **step < 0.0);
            ends.map(|(value, step)| -TO_THE_BOUNDARY * value / step)
                .fold(1.0, f64::min)
        };
        (
            most(&self.slacks, &self.slack_steps),
            most(&self.multipliers, &self.multiplier_steps),
        )
    }

    /// Σ s z after shares of the step.
    pub(super) fn gap_after(&self, of_slacks: f64, of_multipliers: f64) -> f64 {
        let slacks = self.slacks.iter().zip(&self.slack_steps);
        let multipliers = self.multipliers.iter().zip(&self.multiplier_steps);
        let straight: f64 = slacks
            .zip(multipliers)
            .map(|((s, ds), (z, dz))| (s + of_slacks * ds) * (z + of_multipliers * dz))
            .sum();
        let plain = self.bounds.len();
        let multipliers = self.multipliers[plain..].iter();
        let multipliers = multipliers.zip(&self.multiplier_steps[plain..]);
        let bent = self
            .bends
            .iter()
            .zip(multipliers)
            .map(|(bend, (z, dz))| of_slacks * of_slacks * bend * (z + of_multipliers * dz));
        straight - bent.sum::<f64>()
    }

    /// Moves the multipliers by a share of their step.
    pub(super) fn move_multipliers(&mut self, share: f64) {
        for (multiplier, step) in self.multipliers.iter_mut().zip(&self.multiplier_steps) {
            *multiplier += share * step;
        }
    }
}
