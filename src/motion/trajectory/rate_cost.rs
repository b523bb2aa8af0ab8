//! Costs of velocities, accelerations and jerks.

use super::block_banded::BlockBanded;
use super::space::FrameSpace;
use crate::bad_option::{BadOption, NOT_NEGATIVE};
use crate::model::UnknownName;
use crate::problem::Problem;

/// Cost of the k-th difference of a trajectory's variables x over its samples: ½ Σ ‖w Δᵏx / Δtᵏ‖², with the time step
/// Δt.
///
/// Rotations are compared in the rotated frame: Δx of a ball joint is log(R_tᵀ R_{t+1}), radians. Δx of a free joint's
/// position is in metres along the parent's axes. A mimic joint counts with its source joint.
#[derive(Clone, Debug, PartialEq)]
pub struct RateCost {
    order: usize,
    weight: f64,
    by_joint: Vec<(String, f64)>,
}

impl RateCost {
    /// Creates a cost of velocities. The weight is per rad/s or m/s.
    #[must_use]
    pub fn velocity(weight: f64) -> Self {
        Self::of_order(1, weight)
    }

    /// Creates a cost of accelerations. The weight is per rad/s² or m/s².
    #[must_use]
    pub fn acceleration(weight: f64) -> Self {
        Self::of_order(2, weight)
    }

    /// Creates a cost of jerks. The weight is per rad/s³ or m/s³.
    #[must_use]
    pub fn jerk(weight: f64) -> Self {
        Self::of_order(3, weight)
    }

    fn of_order(order: usize, weight: f64) -> Self {
        Self {
            order,
            weight,
            by_joint: Vec::new(),
        }
    }

    /// Multiplies the weight of one joint. A free joint has components, as `root_joint/x` and
    /// `root_joint/rotation`.
    #[must_use]
    pub fn scale(mut self, joint: impl Into<String>, factor: f64) -> Self {
        self.by_joint.push((joint.into(), factor));
        self
    }

    /// Computes the weights by variable for a time step, seconds.
    pub(super) fn compile(
        &self,
        problem: &Problem,
        time_step_s: f64,
    ) -> Result<CompiledRateCost, RateCostError> {
        BadOption::check("the weight of a rate cost", self.weight, NOT_NEGATIVE)?;
        let per_second = (0..self.order).fold(1.0, |product, _| product / time_step_s);
        let mut weights = vec![self.weight * per_second; problem.variables()];
        let joints = &problem.names().joints;
        for (name, factor) in &self.by_joint {
            BadOption::check("the factor of a rate cost", *factor, NOT_NEGATIVE)?;
            let mut is_known = false;
            for (weight, _) in weights
                .iter_mut()
                .zip(joints)
                .filter(|(_, joint)| *joint == name)
            {
                *weight *= factor;
                is_known = true;
            }
            if !is_known {
                let names = joints.iter().map(String::as_str);
                return Err(UnknownName::new("moving joint", name, names).into());
            }
        }
        Ok(CompiledRateCost {
            order: self.order,
            weights,
        })
    }
}

/// Error of a rate cost.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(super) enum RateCostError {
    #[error(transparent)]
    Option(#[from] BadOption),
    #[error(transparent)]
    Name(#[from] UnknownName),
}

/// Coefficients of consecutive sample differences in a difference of each order.
const STEP_COEFFICIENTS: [&[f64]; 3] = [&[1.0], &[-1.0, 1.0], &[1.0, -2.0, 1.0]];
/// Coefficients of consecutive samples in a difference of each order.
const FRAME_COEFFICIENTS: [&[f64]; 3] = [&[-1.0, 1.0], &[1.0, -2.0, 1.0], &[-1.0, 3.0, -3.0, 1.0]];

/// Rate cost of one problem.
#[derive(Clone, Debug)]
pub(super) struct CompiledRateCost {
    pub(super) order: usize,
    /// Weight of each variable.
    weights: Vec<f64>,
}

impl CompiledRateCost {
    /// Returns one unweighted difference, from the `order` sample differences at the start of `differences`.
    fn difference(&self, differences: &[f64], variable: usize) -> f64 {
        let n = self.weights.len();
        let parts = STEP_COEFFICIENTS[self.order - 1].iter().enumerate();
        parts
            .map(|(k, coefficient)| coefficient * differences[k * n + variable])
            .sum()
    }

    /// Returns the cost of the differences that begin at samples from `first` on. `differences` are the sample
    /// differences.
    pub(super) fn cost(&self, differences: &[f64], first: usize) -> f64 {
        let n = self.weights.len();
        let frames = differences.len() / n + 1;
        let mut sum = 0.0;
        for frame in first..frames.saturating_sub(self.order) {
            let differences = &differences[frame * n..];
            for (variable, weight) in self.weights.iter().enumerate() {
                let row = weight * self.difference(differences, variable);
                sum += row * row;
            }
        }
        0.5 * sum
    }

    /// Adds the gradient and JᵀJ of that cost. `differences` are the differences between the samples x.
    pub(super) fn add_to(
        &self,
        space: &FrameSpace,
        x: &[f64],
        differences: &[f64],
        first: usize,
        hessian: &mut BlockBanded,
        gradient: &mut [f64],
    ) {
        let n = self.weights.len();
        let frames = differences.len() / n + 1;
        let coefficients = FRAME_COEFFICIENTS[self.order - 1];
        let numbers: Vec<usize> = (0..n)
            .filter(|&variable| space.is_number(variable))
            .collect();
        for frame in first..frames.saturating_sub(self.order) {
            let differences = &differences[frame * n..];
            for &variable in &numbers {
                let squared = self.weights[variable] * self.weights[variable];
                let pull = squared * self.difference(differences, variable);
                for (a, coefficient) in coefficients.iter().enumerate() {
                    gradient[(frame + a) * n + variable] += coefficient * pull;
                    for (ahead, other) in coefficients[a..].iter().enumerate() {
                        hessian.add(
                            frame + a,
                            ahead,
                            variable,
                            variable,
                            coefficient * other * squared,
                        );
                    }
                }
            }
            self.add_balls(space, x, differences, frame, hessian, gradient);
        }
    }

    /// Adds the terms of rotations, whose differences are nonlinear in both ends.
    fn add_balls(
        &self,
        space: &FrameSpace,
        x: &[f64],
        differences: &[f64],
        frame: usize,
        hessian: &mut BlockBanded,
        gradient: &mut [f64],
    ) {
        let n = self.weights.len();
        let coefficients = STEP_COEFFICIENTS[self.order - 1];
        let mut slopes = [const { Vec::new() }; 3];
        for (k, slopes) in slopes.iter_mut().enumerate().take(self.order) {
            let [from, to] = [frame + k, frame + k + 1].map(|index| &x[index * n..(index + 1) * n]);
            slopes.extend(space.slopes(&differences[k * n..(k + 1) * n], [from, to]));
        }
        for (ball, first) in slopes[0].iter().map(|ball| ball.first).enumerate() {
            let squared = self.weights[first] * self.weights[first];
            let rows = [0, 1, 2].map(|k| self.difference(differences, first + k));
            // Derivatives of the combined difference by a step of each sample.
            let mut by_frame = [[[0.0; 3]; 3]; 4];
            for (k, coefficient) in coefficients.iter().enumerate() {
                let derivative = &slopes[k][ball];
                for (row, column) in (0..9).map(|entry| (entry / 3, entry % 3)) {
                    by_frame[k][row][column] += coefficient * derivative.by_from[row][column];
                    by_frame[k + 1][row][column] += coefficient * derivative.by_to[row][column];
                }
            }
            for a in 0..=self.order {
                for i in 0..3 {
                    let along: f64 = (0..3).map(|row| by_frame[a][row][i] * rows[row]).sum();
                    gradient[(frame + a) * n + first + i] += squared * along;
                    for b in a..=self.order {
                        for j in if a == b { i..3 } else { 0..3 } {
                            let entry: f64 = (0..3)
                                .map(|row| by_frame[a][row][i] * by_frame[b][row][j])
                                .sum();
                            hessian.add(frame + a, b - a, first + i, first + j, squared * entry);
                        }
                    }
                }
            }
        }
    }
}
