//! Length limit at one sample, as a bound of the interior-point method.
//!
//! The slack s = (m² − ‖ρ‖²) / (2m) is smooth and concave, and approximates the distance from the limit near it. Its
//! curvature is part of a step's model: with multiplier z it adds (z/m) JᵀJ to the Hessian of the Lagrangian.

use super::block_banded::BlockBanded;
use super::length_limits::{LengthLimit, Measured};
use kinopt_kinematics::spatial::Vector3;

/// One length limit at one sample.
#[derive(Clone, Debug)]
pub(super) struct LengthBound<'a> {
    pub(super) limit: &'a LengthLimit,
    pub(super) frame: usize,
    /// Index of the sample's first variable, and of the sample that it is measured from.
    to: usize,
    from: usize,
    stride: usize,
    /// Result of the last [`update`](Self::update).
    measured: Measured,
}

impl<'a> LengthBound<'a> {
    pub(super) fn new(limit: &'a LengthLimit, frame: usize, stride: usize) -> Self {
        let to = frame * stride;
        let from = if limit.limits_displacement() {
            to - stride
        } else {
            to
        };
        Self {
            limit,
            frame,
            to,
            from,
            stride,
            measured: Measured::default(),
        }
    }

    fn frames<'x>(&self, x: &'x [f64]) -> [&'x [f64]; 2] {
        [self.from, self.to].map(|start| &x[start..start + self.stride])
    }

    /// Returns the index of one of its variables.
    pub(super) fn index(&self) -> usize {
        self.to + self.limit.variables[0]
    }

    pub(super) fn slack(&self, x: &[f64]) -> f64 {
        let [from, to] = self.frames(x);
        self.limit.slack(self.limit.rho(from, to))
    }

    /// Computes ρ and its derivatives at x. Returns the slack.
    pub(super) fn update(&mut self, x: &[f64]) -> f64 {
        let [from, to] = self.frames(x);
        self.measured = self.limit.measure(from, to);
        self.limit.slack(self.measured.rho)
    }

    /// Returns the linear change of ρ by a step.
    fn rho_change(&self, step: &[f64]) -> Vector3<f64> {
        let [from, to] = [self.from, self.to].map(|start| {
            let [a, b, c] = self.limit.variables.map(|variable| step[start + variable]);
            Vector3::new(a, b, c)
        });
        let rho_change = self.measured.by_to * to;
        match self.limit.limits_displacement() {
            true => rho_change + self.measured.by_from * from,
            false => rho_change,
        }
    }

    /// Returns (a, b) such that the slack changes by α a − α² b along a fraction α of a step.
    pub(super) fn along(&self, step: &[f64]) -> (f64, f64) {
        let rho_change = self.rho_change(step);
        let max_length = self.limit.max_length;
        (
            -self.measured.rho.dot(rho_change) / max_length,
            0.5 * rho_change.norm_squared() / max_length,
        )
    }

    /// Returns ∂s by the variables of the sample, and by those of the sample before.
    fn slopes(&self) -> [[f64; 3]; 2] {
        let inward = self.measured.rho * (-1.0 / self.limit.max_length);
        [self.measured.by_to, self.measured.by_from]
            .map(|jacobian| jacobian.transpose_mul(inward).to_array())
    }

    /// Adds an inward force of size `push` to the right-hand side of a step.
    pub(super) fn add_force(&self, push: f64, rhs: &mut [f64]) {
        let [by_to, by_from] = self.slopes();
        for (k, variable) in self.limit.variables.into_iter().enumerate() {
            rhs[self.to + variable] += push * by_to[k];
            if self.limit.limits_displacement() {
                rhs[self.from + variable] += push * by_from[k];
            }
        }
    }

    /// Adds stiff · ∂s ∂sᵀ + (z/m) JᵀJ to the Hessian.
    pub(super) fn add_to(&self, stiff: f64, multiplier: f64, hessian: &mut BlockBanded) {
        let [slope_to, slope_from] = self.slopes();
        let curvature = multiplier / self.limit.max_length;
        let columns =
            |matrix: kinopt_kinematics::spatial::Matrix3<f64>| [matrix.x, matrix.y, matrix.z];
        let (to, from) = (columns(self.measured.by_to), columns(self.measured.by_from));
        let frame = self.frame;
        for (i, a) in self.limit.variables.into_iter().enumerate() {
            for (j, b) in self.limit.variables.into_iter().enumerate() {
                let current = stiff * slope_to[i] * slope_to[j] + curvature * to[i].dot(to[j]);
                if i <= j {
                    hessian.add(frame, 0, a, b, current);
                }
                if self.limit.limits_displacement() {
                    let before =
                        stiff * slope_from[i] * slope_from[j] + curvature * from[i].dot(from[j]);
                    let across =
                        stiff * slope_from[i] * slope_to[j] + curvature * from[i].dot(to[j]);
                    if i <= j {
                        hessian.add(frame - 1, 0, a, b, before);
                    }
                    hessian.add(frame - 1, 1, a, b, across);
                }
            }
        }
    }
}
