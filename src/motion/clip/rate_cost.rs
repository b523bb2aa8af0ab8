//! What it costs that joints move, change their velocity, or change their acceleration.

use super::block_banded::BlockBanded;
use super::space::FrameSpace;
use crate::bad_option::{BadOption, NOT_NEGATIVE};
use crate::model::UnknownName;
use crate::problem::Problem;

/// The k-th difference of a motion's variables x over its frames, as a cost: ½ Σ ‖w Δᵏx / Δtᵏ‖², where Δt is the time
/// between two frames.
///
/// Rotations are compared in their turned axes: Δx of a ball is log(R_tᵀ R_{t+1}), radians, and of a free joint's place
/// metres along the parent's axes. A joint that follows another is counted with that one.
#[derive(Clone, Debug, PartialEq)]
pub struct RateCost {
    order: usize,
    weight: f64,
    by_joint: Vec<(String, f64)>,
}

impl RateCost {
    /// Velocities, per rad/s or m/s.
    #[must_use]
    pub fn velocity(weight: f64) -> Self {
        Self::of_order(1, weight)
    }

    /// Accelerations, per rad/s² or m/s².
    #[must_use]
    pub fn acceleration(weight: f64) -> Self {
        Self::of_order(2, weight)
    }

    /// Jerks, per rad/s³ or m/s³.
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

    setters! {
        /// Multiplies the weight of one joint, by name; of a free joint its parts have names of their own, as
        /// `root_joint/x` and `root_joint/rotation`.
        pub fn times(mut self, joint: impl Into<String>, factor: f64) {
            self.by_joint.push((joint.into(), factor));
        }
    }

    /// With its weights by variable, for frames so many seconds apart.
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
            let mut found = false;
            for (weight, _) in weights
                .iter_mut()
                .zip(joints)
                .filter(|(_, own)| *own == name)
            {
                *weight *= factor;
                found = true;
            }
            if !found {
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

/// What can be wrong with a rate cost.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(super) enum RateCostError {
    #[error(transparent)]
    Option(#[from] BadOption),
    #[error(transparent)]
    Name(#[from] UnknownName),
}

/// Of so many ways between frames, their difference.
const OF_WAYS: [&[f64]; 3] = [&[1.0], &[-1.0, 1.0], &[1.0, -2.0, 1.0]];
/// The same of frames.
const OF_FRAMES: [&[f64]; 3] = [&[-1.0, 1.0], &[1.0, -2.0, 1.0], &[-1.0, 3.0, -3.0, 1.0]];

/// A rate cost of one problem.
#[derive(Clone, Debug)]
pub(super) struct CompiledRateCost {
    pub(super) order: usize,
    /// By variable.
    weights: Vec<f64>,
}

impl CompiledRateCost {
    /// One difference, in units of the weights: of the `order` ways that begin at a frame.
    fn difference(&self, ways: &[f64], variable: usize) -> f64 {
        let n = self.weights.len();
        let parts = OF_WAYS[self.order - 1].iter().enumerate();
        parts.map(|(k, by)| by * ways[k * n + variable]).sum()
    }

    /// The cost of the ways (one after the other) that begin at all frames from `first` on.
    pub(super) fn cost(&self, ways: &[f64], first: usize) -> f64 {
        let n = self.weights.len();
        let frames = ways.len() / n + 1;
        let mut sum = 0.0;
        for frame in first..frames.saturating_sub(self.order) {
            let ways = &ways[frame * n..];
            for (variable, weight) in self.weights.iter().enumerate() {
                let row = weight * self.difference(ways, variable);
                sum += row * row;
            }
        }
        0.5 * sum
    }

    /// Adds the gradient and JᵀJ of that cost, for the frames x between which those ways are.
    pub(super) fn add_to(
        &self,
        space: &FrameSpace,
        x: &[f64],
        ways: &[f64],
        first: usize,
        hessian: &mut BlockBanded,
        gradient: &mut [f64],
    ) {
        let n = self.weights.len();
        let frames = ways.len() / n + 1;
        let of_frames = OF_FRAMES[self.order - 1];
        let numbers: Vec<usize> = (0..n)
            .filter(|&variable| space.is_number(variable))
            .collect();
        for frame in first..frames.saturating_sub(self.order) {
            let ways = &ways[frame * n..];
            for &variable in &numbers {
                let squared = self.weights[variable] * self.weights[variable];
                let pull = squared * self.difference(ways, variable);
                for (a, by) in of_frames.iter().enumerate() {
                    gradient[(frame + a) * n + variable] += by * pull;
                    for (ahead, other) in of_frames[a..].iter().enumerate() {
                        hessian.add(frame + a, ahead, variable, variable, by * other * squared);
                    }
                }
            }
            self.add_balls(space, x, ways, frame, hessian, gradient);
        }
    }

    /// The same of rotations, whose difference bends with both ends of each way.
    fn add_balls(
        &self,
        space: &FrameSpace,
        x: &[f64],
        ways: &[f64],
        frame: usize,
        hessian: &mut BlockBanded,
        gradient: &mut [f64],
    ) {
        let n = self.weights.len();
        let of_ways = OF_WAYS[self.order - 1];
        let mut slopes = [const { Vec::new() }; 3];
        for (k, slopes) in slopes.iter_mut().enumerate().take(self.order) {
            let [from, to] = [frame + k, frame + k + 1].map(|at| &x[at * n..(at + 1) * n]);
            slopes.extend(space.slopes(&ways[k * n..(k + 1) * n], [from, to]));
        }
        for (ball, first) in slopes[0].iter().map(|ball| ball.first).enumerate() {
            let squared = self.weights[first] * self.weights[first];
            let rows = [0, 1, 2].map(|k| self.difference(ways, first + k));
            // ∂(Σ c_k way_k) by a step of each frame.
            let mut by_frame = [[[0.0; 3]; 3]; 4];
            for (k, by) in of_ways.iter().enumerate() {
                let own = &slopes[k][ball];
                for (row, column) in (0..9).map(|entry| (entry / 3, entry % 3)) {
                    by_frame[k][row][column] += by * own.by_from[row][column];
                    by_frame[k + 1][row][column] += by * own.by_to[row][column];
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
