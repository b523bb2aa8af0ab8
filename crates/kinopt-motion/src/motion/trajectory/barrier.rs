//! Barrier of the bounds of a trajectory: slacks, multipliers and their contributions to a step.

use super::block_banded::BlockBanded;
use super::bounds::FrameBounds;
use super::length_bounds::LengthBound;
use kinopt_kinematics::scalar::elementary;

/// Largest fraction of the step to the first zero slack or multiplier that is taken.
const BOUNDARY_FRACTION: f64 = 0.995;
/// Number of slacks that are multiplied before one logarithm is taken.
const SLACKS_PER_LOGARITHM: usize = 8;

/// Bound sign · (x[at] − x[before]) ≤ limit, with slack s ≥ 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SlackBound {
    pub(super) index: usize,
    /// Index of the same variable one sample before, for a bound on a displacement.
    pub(super) before: Option<usize>,
    /// Sign of the bound: 1 for an upper bound, −1 for a lower one.
    pub(super) sign: f64,
    limit: f64,
    /// Scale of the bounded quantity: a range or a displacement.
    pub(super) size: f64,
}

impl SlackBound {
    fn value(&self, x: &[f64]) -> f64 {
        match self.before {
            None => x[self.index],
            Some(before) => x[self.index] - x[before],
        }
    }

    pub(super) fn slack(&self, x: &[f64]) -> f64 {
        self.limit - self.sign * self.value(x)
    }
}

/// All bounds of some samples, with slacks s and multipliers z.
#[derive(Clone, Debug, Default)]
pub(super) struct Barrier<'a> {
    pub(super) bounds: Vec<SlackBound>,
    /// Bounds of lengths. Their slacks and multipliers follow those of `bounds`.
    pub(super) lengths: Vec<LengthBound<'a>>,
    pub(super) slacks: Vec<f64>,
    pub(super) multipliers: Vec<f64>,
    /// Linear changes of the slacks by a step.
    slack_steps: Vec<f64>,
    /// Quadratic decreases of the slacks of lengths by a full step.
    curvatures: Vec<f64>,
    /// Part of `curvatures` that the current step compensates.
    compensated: Vec<f64>,
    multiplier_steps: Vec<f64>,
}

impl<'a> Barrier<'a> {
    /// Creates the bounds of consecutive samples. Bounds between fixed samples are left out.
    pub(super) fn new(limits: &'a FrameBounds, fixed: &[bool]) -> Self {
        let n = limits.max_step.len();
        let mut bounds = Vec::new();
        for frame in 0..fixed.len() {
            let moves = |variable: &usize| !limits.is_constant[*variable];
            for variable in (0..n).filter(moves) {
                let index = frame * n + variable;
                let range = limits.upper[variable] - limits.lower[variable];
                let range = if range.is_finite() { range } else { 1.0 };
                let mut add = |before: Option<usize>, sign: f64, limit: f64| {
                    if limit.is_finite() {
                        bounds.push(SlackBound {
                            index,
                            before,
                            sign,
                            limit,
                            size: before.map_or(range, |_| limits.max_step[variable]),
                        });
                    }
                };
                if !fixed[frame] {
                    add(None, -1.0, -limits.lower[variable]);
                    add(None, 1.0, limits.upper[variable]);
                }
                if frame > 0 && !(fixed[frame] && fixed[frame - 1]) {
                    add(Some(index - n), -1.0, limits.max_step[variable]);
                    add(Some(index - n), 1.0, limits.max_step[variable]);
                }
            }
        }
        let mut lengths = Vec::new();
        for limit in &limits.lengths {
            let first = usize::from(limit.limits_displacement());
            let moves = |frame: &usize| !(fixed[*frame] && (first == 0 || fixed[frame - 1]));
            let frames = (first..fixed.len()).filter(moves);
            lengths.extend(frames.map(|frame| LengthBound::new(limit, frame, n)));
        }
        let zero = vec![0.0; bounds.len() + lengths.len()];
        Self {
            curvatures: vec![0.0; lengths.len()],
            compensated: vec![0.0; lengths.len()],
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
    pub(super) fn update(&mut self, x: &[f64]) -> Option<usize> {
        let (slacks, length_slacks) = self.slacks.split_at_mut(self.bounds.len());
        for (slack, bound) in slacks.iter_mut().zip(&self.bounds) {
            *slack = bound.slack(x);
        }
        for (slack, bound) in length_slacks.iter_mut().zip(&mut self.lengths) {
            *slack = bound.update(x);
        }
        let violated = self
            .slacks
            .iter()
            .position(|slack| *slack <= 0.0 || slack.is_nan());
        violated.map(|k| match self.bounds.get(k) {
            Some(bound) => bound.index,
            None => self.lengths[k - self.bounds.len()].index(),
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
        for bounds in self.bounds.chunks(SLACKS_PER_LOGARITHM) {
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
        let lengths = self.lengths.iter().zip(pairs.skip(self.bounds.len()));
        lengths.map(|(bound, (slack, multiplier))| (bound, *slack, *multiplier))
    }

    /// Adds Σ (z/s) a aᵀ and the curvature of the lengths to the Hessian.
    pub(super) fn add_to(&self, variables: usize, hessian: &mut BlockBanded) {
        let stiffness = self.multipliers.iter().zip(&self.slacks);
        for (bound, (multiplier, slack)) in self.bounds.iter().zip(stiffness) {
            let stiff = multiplier / slack;
            let (frame, variable) = (bound.index / variables, bound.index % variables);
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
    pub(super) fn add_force(&self, mu: f64, rhs: &mut [f64]) {
        for (bound, slack) in self.bounds.iter().zip(&self.slacks) {
            let push = bound.sign * mu / slack;
            rhs[bound.index] -= push;
            if let Some(before) = bound.before {
                rhs[before] += push;
            }
        }
        for (bound, slack, _) in self.with_lengths() {
            bound.add_force(mu / slack, rhs);
        }
    }

    /// Computes the steps of slacks and multipliers for a step of x towards s z = μ.
    pub(super) fn compute_steps(&mut self, step: &[f64], mu: f64) {
        for (k, bound) in self.bounds.iter().enumerate() {
            let (slack, multiplier) = (self.slacks[k], self.multipliers[k]);
            let slack_step = -bound.sign * bound.value(step);
            self.slack_steps[k] = slack_step;
            self.multiplier_steps[k] = (mu - multiplier * slack_step) / slack - multiplier;
        }
        let first_length = self.bounds.len();
        for (k, bound) in self.lengths.iter().enumerate() {
            let (slack, multiplier) = (
                self.slacks[first_length + k],
                self.multipliers[first_length + k],
            );
            let (slack_step, curvature) = bound.along(step);
            self.slack_steps[first_length + k] = slack_step;
            self.curvatures[k] = curvature;
            let net_step = slack_step - self.compensated[k];
            self.multiplier_steps[first_length + k] =
                (mu - multiplier * net_step) / slack - multiplier;
        }
    }

    /// Stores the curvature of lengths along the last step. Returns whether there is any.
    pub(super) fn store_curvature(&mut self) -> bool {
        self.compensated.copy_from_slice(&self.curvatures);
        self.compensated.iter().any(|curvature| *curvature > 0.0)
    }

    /// Clears the stored curvature.
    pub(super) fn clear_curvature(&mut self) {
        self.compensated.fill(0.0);
    }

    /// Adds the stored curvature of lengths to the right-hand side of a step, as an inward force.
    pub(super) fn add_curvature(&self, rhs: &mut [f64]) {
        for ((bound, slack, multiplier), curvature) in self.with_lengths().zip(&self.compensated) {
            bound.add_force(multiplier * curvature / slack, rhs);
        }
    }

    /// Returns the largest fractions of the step for slacks and for multipliers.
    pub(super) fn max_fractions(&self) -> (f64, f64) {
        let (slack_fraction, multiplier_fraction) = self.max_linear_fractions();
        let first_length = self.bounds.len();
        let steps = self.slacks[first_length..]
            .iter()
            .zip(&self.slack_steps[first_length..]);
        // Fraction α at which the allowed part of the slack is used up: s + α ds − α² bend = (1 − 0.995) s.
        let ends = steps
            .zip(&self.curvatures)
            .map(|((slack, slack_step), curvature)| {
                let root =
                    (slack_step * slack_step + 4.0 * curvature * BOUNDARY_FRACTION * slack).sqrt();
                // The form without cancellation.
                match *slack_step < 0.0 {
                    true => 2.0 * BOUNDARY_FRACTION * slack / (root - slack_step),
                    false => (root + slack_step) / (2.0 * curvature),
                }
            });
        (ends.fold(slack_fraction, f64::min), multiplier_fraction)
    }

    fn max_linear_fractions(&self) -> (f64, f64) {
        let max_fraction = |values: &[f64], steps: &[f64]| {
            let ends = values.iter().zip(steps).filter(|(_, step)| **step < 0.0);
            ends.map(|(value, step)| -BOUNDARY_FRACTION * value / step)
                .fold(1.0, f64::min)
        };
        (
            max_fraction(&self.slacks, &self.slack_steps),
            max_fraction(&self.multipliers, &self.multiplier_steps),
        )
    }

    /// Returns Σ s z after fractions of the step.
    pub(super) fn gap_after(&self, slack_fraction: f64, multiplier_fraction: f64) -> f64 {
        let slacks = self.slacks.iter().zip(&self.slack_steps);
        let multipliers = self.multipliers.iter().zip(&self.multiplier_steps);
        let linear: f64 = slacks
            .zip(multipliers)
            .map(|((s, ds), (z, dz))| (s + slack_fraction * ds) * (z + multiplier_fraction * dz))
            .sum();
        let first_length = self.bounds.len();
        let multipliers = self.multipliers[first_length..].iter();
        let multipliers = multipliers.zip(&self.multiplier_steps[first_length..]);
        let curved = self
            .curvatures
            .iter()
            .zip(multipliers)
            .map(|(curvature, (z, dz))| {
                slack_fraction * slack_fraction * curvature * (z + multiplier_fraction * dz)
            });
        linear - curved.sum::<f64>()
    }

    /// Moves the multipliers by a fraction of their step.
    pub(super) fn move_multipliers(&mut self, fraction: f64) {
        for (multiplier, step) in self.multipliers.iter_mut().zip(&self.multiplier_steps) {
            *multiplier += fraction * step;
        }
    }
}
