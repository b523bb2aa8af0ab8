//! Barrier of the bounds of a trajectory: slacks, multipliers and their contributions to a step.

use super::block_banded::BlockBanded;
use super::bounds::FrameBounds;
use super::length_bounds::LengthBound;
use crate::scalar::elementary;

/// Largest fraction of the step to the first zero slack or multiplier that is taken.
const TO_THE_BOUNDARY: f64 = 0.995;
/// Number of slacks that are multiplied before one logarithm is taken.
const TOGETHER: usize = 8;

/// Bound sign · (x[at] − x[before]) ≤ limit, with slack s ≥ 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bound {
    pub(super) at: usize,
    /// Index of the same variable one sample before, for a bound on a displacement.
    pub(super) before: Option<usize>,
    /// Sign of the bound: 1 for an upper bound, −1 for a lower one.
    pub(super) sign: f64,
    room: f64,
    /// Scale of the bounded quantity: a range or a displacement.
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

/// All bounds of some samples, with slacks s and multipliers z.
#[derive(Clone, Debug, Default)]
pub(super) struct Barrier<'a> {
    pub(super) bounds: Vec<Bound>,
    /// Bounds of lengths. Their slacks and multipliers follow those of `bounds`.
    pub(super) lengths: Vec<LengthBound<'a>>,
    pub(super) slacks: Vec<f64>,
    pub(super) multipliers: Vec<f64>,
    /// Linear changes of the slacks by a step.
    slack_steps: Vec<f64>,
    /// Quadratic decreases of the slacks of lengths by a full step.
    bends: Vec<f64>,
    /// Part of `bends` that the current step compensates.
    allowed: Vec<f64>,
    multiplier_steps: Vec<f64>,
}

impl<'a> Barrier<'a> {
    /// Creates the bounds of consecutive samples. Bounds between fixed samples are left out.
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

    /// Number of bounds.
    pub(super) fn len(&self) -> usize {
        self.slacks.len()
    }

    /// Computes the slacks at x. Returns a variable of the first bound without positive slack, if there is one.
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

    /// Sets the multipliers to s z = μ.
    pub(super) fn centre(&mut self, mu: f64) {
        for (multiplier, slack) in self.multipliers.iter_mut().zip(&self.slacks) {
            *multiplier = mu / slack;
        }
    }

    /// Returns the complementarity gap Σ s z, a bound on the remaining decrease for a linear cost.
    pub(super) fn gap(&self) -> f64 {
        let pairs = self.slacks.iter().zip(&self.multipliers);
        pairs.map(|(slack, multiplier)| slack * multiplier).sum()
    }

    /// Returns −Σ ln s at x; infinity beyond a bound.
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

    /// Returns the bounds of lengths with their slacks and multipliers.
    pub(super) fn with_lengths(&self) -> impl Iterator<Item = (&LengthBound<'a>, f64, f64)> {
        let pairs = self.slacks.iter().zip(&self.multipliers);
        let own = self.lengths.iter().zip(pairs.skip(self.bounds.len()));
        own.map(|(bound, (slack, multiplier))| (bound, *slack, *multiplier))
    }

    /// Adds Σ (z/s) a aᵀ and the curvature of the lengths to the Hessian.
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

    /// Adds the barrier gradient for μ to the right-hand side of a step.
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

    /// Computes the steps of slacks and multipliers for a step of x towards s z = μ.
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

    /// Stores the curvature of lengths along the last step. Returns whether there is any.
    pub(super) fn bend(&mut self) -> bool {
        self.allowed.copy_from_slice(&self.bends);
        self.allowed.iter().any(|bend| *bend > 0.0)
    }

    /// Clears the stored curvature.
    pub(super) fn forget_bends(&mut self) {
        self.allowed.fill(0.0);
    }

    /// Adds the stored curvature of lengths to the right-hand side of a step, as an inward force.
    pub(super) fn add_bends(&self, downhill: &mut [f64]) {
        for ((bound, slack, multiplier), bend) in self.with_lengths().zip(&self.allowed) {
            bound.add_push(multiplier * bend / slack, downhill);
        }
    }

    /// Returns the largest fractions of the step for slacks and for multipliers.
    pub(super) fn longest(&self) -> (f64, f64) {
        let (of_slacks, of_multipliers) = self.longest_straight();
        let plain = self.bounds.len();
        let steps = self.slacks[plain..].iter().zip(&self.slack_steps[plain..]);
        // Fraction α at which the allowed part of the slack is used up: s + α ds − α² bend = (1 − 0.995) s.
        let ends = steps.zip(&self.bends).map(|((slack, by), bend)| {
            let root = (by * by + 4.0 * bend * TO_THE_BOUNDARY * slack).sqrt();
            // The form without cancellation.
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

    /// Returns Σ s z after fractions of the step.
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

    /// Moves the multipliers by a fraction of their step.
    pub(super) fn move_multipliers(&mut self, share: f64) {
        for (multiplier, step) in self.multipliers.iter_mut().zip(&self.multiplier_steps) {
            *multiplier += share * step;
        }
    }
}
