//! The last steps to the closest configuration, where a target is out of reach.
//!
//! Far from its target an arm has a large residual, and Gauss-Newton steps, which know nothing of
//! its curvature, creep. Newton's method on the free joints (Bertsekas 1982, "Projected Newton
//! methods for optimization problems with simple constraints") arrives in a few steps; its matrix
//! is taken from differences of the exact gradient.

use std::time::Instant;

use nalgebra::{DMatrix, DVectorViewMut};

use super::workspace::Workspace;
use crate::solver::negligible_slope;

/// Most steps; each takes one gradient a joint and one more.
const STEPS: usize = 60;
/// Most dampings tried in one step.
const DAMPINGS: usize = 8;
/// Difference that gradients are taken over, radians; slides by the metres that weigh as much.
const DIFFERENCE: f64 = 1e-6;

impl Workspace {
    /// Goes on from x to where no free joint can lower the cost; whether it came there, and the
    /// gradients that took.
    pub(super) fn finish_by_newton(&mut self, deadline: Option<Instant>) -> (bool, usize) {
        let n = self.x.len();
        let mut gradients = 0;
        let mut damping = 0.0;
        let mut x = std::mem::take(&mut self.x);
        let mut stationary = false;
        for _ in 0..STEPS {
            let cost = self.slope(&x);
            gradients += 1;
            stationary = self.projected_gradient(&x) <= self.negligible(cost);
            if stationary || deadline.is_some_and(|at| Instant::now() >= at) {
                break;
            }
            let free: Vec<usize> = (0..n).filter(|&i| !self.is_blocked(&x, i)).collect();
            let slope: Vec<f64> = free.iter().map(|&i| self.gradient[i]).collect();
            let hessian = self.hessian(&mut x, &free, &slope);
            gradients += free.len();
            let size = hessian.diagonal().amax().max(f64::MIN_POSITIVE);
            let mut lower = false;
            for _ in 0..DAMPINGS {
                if self.newton_step(&x, &free, &slope, &hessian, damping * size) {
                    let trial = std::mem::take(&mut self.trial);
                    let now = self.cost_at(&trial);
                    self.trial = trial;
                    // The last steps change the cost by less than its rounding.
                    lower = now <= cost * (1.0 + 4.0 * f64::EPSILON);
                }
                if lower {
                    damping *= 0.1;
                    break;
                }
                damping = (10.0 * damping).max(1e-3);
            }
            if !lower {
                break;
            }
            x.copy_from_slice(&self.trial);
        }
        self.x = x;
        (stationary, gradients)
    }

    /// Half the squared residual.
    fn cost_at(&mut self, x: &[f64]) -> f64 {
        let residual = self.residual(x);
        0.5 * residual.iter().map(|v| v * v).sum::<f64>()
    }

    /// Takes the gradient at x; the cost there.
    fn slope(&mut self, x: &[f64]) -> f64 {
        let residual = self.linearise(x);
        for (slope, column) in self.gradient.iter_mut().zip(self.jacobian.column_iter()) {
            *slope = column.iter().zip(&residual).map(|(j, r)| j * r).sum();
        }
        0.5 * residual.iter().map(|v| v * v).sum::<f64>()
    }

    /// Takes the gradient at the workspace's own x; the slope that counts as none there.
    pub(super) fn take_slope(&mut self) -> f64 {
        let x = std::mem::take(&mut self.x);
        let cost = self.slope(&x);
        self.x = x;
        self.negligible(cost)
    }

    /// The slope that counts as none at a place of this cost, by the core's measure; the Jacobian is
    /// here.
    fn negligible(&self, cost: f64) -> f64 {
        let columns = self.jacobian.column_iter().map(|column| column.norm());
        negligible_slope(
            columns.fold(0.0, f64::max),
            cost,
            &super::workspace::stopping(),
        )
    }

    /// ‖proj(x − g) − x‖∞ by the gradient that is here.
    pub(super) fn projected_gradient(&self, x: &[f64]) -> f64 {
        let bounds = self.lower.iter().zip(&self.upper);
        let moves = x.iter().zip(&self.gradient).zip(bounds);
        let moves =
            moves.map(|((x, g), (lower, upper))| ((x - g).max(*lower).min(*upper) - x).abs());
        moves.fold(0.0, f64::max)
    }

    /// Whether a joint stands on a bound that the gradient pushes it against.
    fn is_blocked(&self, x: &[f64], i: usize) -> bool {
        let g = self.gradient[i];
        x[i] <= self.lower[i] && g > 0.0 || x[i] >= self.upper[i] && g < 0.0
    }

    /// Second derivatives by the free joints, where the gradient is `slope`.
    fn hessian(&mut self, x: &mut [f64], free: &[usize], slope: &[f64]) -> DMatrix<f64> {
        let mut hessian = DMatrix::zeros(free.len(), free.len());
        for (column, &i) in free.iter().enumerate() {
            let at = x[i];
            let unit = self.units[i];
            x[i] = at + DIFFERENCE * unit;
            self.slope(x);
            x[i] = at;
            for (row, &k) in free.iter().enumerate() {
                hessian[(row, column)] = (self.gradient[k] - slope[row]) / (DIFFERENCE * unit);
            }
        }
        0.5 * (&hessian + hessian.transpose())
    }

    /// Puts the end of a damped step into the trial; false where the damped matrix is not positive.
    fn newton_step(
        &mut self,
        x: &[f64],
        free: &[usize],
        slope: &[f64],
        hessian: &DMatrix<f64>,
        damping: f64,
    ) -> bool {
        let mut damped = hessian.clone();
        for k in 0..free.len() {
            damped[(k, k)] += damping;
        }
        let Some(factor) = damped.cholesky() else {
            return false;
        };
        let mut step = slope.to_vec();
        factor.solve_mut(&mut DVectorViewMut::from_slice(&mut step, free.len()));
        self.trial.copy_from_slice(x);
        for (&i, step) in free.iter().zip(&step) {
            self.trial[i] = (x[i] - step).max(self.lower[i]).min(self.upper[i]);
        }
        true
    }
}
