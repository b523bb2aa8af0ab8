//! The true second derivative of the cost over the free variables, H = JᵀJ + Σ rᵢ ∇²rᵢ.
//!
//! JᵀJ alone is good where residuals are small. At the minimum of a target out of reach they are not,
//! and steps by JᵀJ then come closer by the same small share each time, or by less (Nocedal & Wright
//! 2006, section 10.3, "large-residual problems"). Differences of the exact gradient give H at the
//! price of one gradient a variable, and steps by H converge quadratically to rounding.

use nalgebra::DMatrix;

use super::LeastSquares;
use super::linear::{dot, factorise, substitute};

/// The difference in x, relative to max(1, |x|): ∛ε bears gradients that are differences themselves.
const RELATIVE_STEP: f64 = 6.055_454_452_393_343e-6;
/// How often damping may grow in search of a positive definite system.
const MOST_RAISES: usize = 40;
/// Where the damping of an indefinite system begins, as a share of the largest diagonal entry.
const FIRST_RAISE: f64 = 1e-6;

/// H and room to solve with it.
#[derive(Clone, Debug, Default)]
pub(super) struct Curvature {
    /// H over the free variables, row by row.
    matrix: Vec<f64>,
    is_fresh: bool,
    factor: Vec<f64>,
    pivot_column: Vec<f64>,
    unknown: Vec<f64>,
    x: Vec<f64>,
    residual: Vec<f64>,
    gradient: Vec<f64>,
    gradient_here: Vec<f64>,
}

impl Curvature {
    /// Makes room for every problem of this shape, whatever is free.
    pub(super) fn reserve(&mut self, rows: usize, columns: usize) {
        for (vector, room) in [
            (&mut self.matrix, columns * columns),
            (&mut self.factor, columns * columns),
            (&mut self.pivot_column, columns),
            (&mut self.unknown, columns),
        ] {
            vector.clear();
            vector.reserve(room);
        }
        for (vector, length) in [
            (&mut self.x, columns),
            (&mut self.residual, rows),
            (&mut self.gradient, columns),
            (&mut self.gradient_here, columns),
        ] {
            vector.clear();
            vector.resize(length, 0.0);
        }
        self.is_fresh = false;
    }

    /// x or the free set has changed.
    pub(super) fn forget(&mut self) {
        self.is_fresh = false;
    }

    /// Fills H in at x, unless it is there. `jacobian` is memory to use. Returns how many gradients
    /// that took.
    pub(super) fn differentiate(
        &mut self,
        problem: &mut dyn LeastSquares,
        x: &[f64],
        free: &[usize],
        jacobian: &mut DMatrix<f64>,
    ) -> usize {
        if self.is_fresh {
            return 0;
        }
        let order = free.len();
        self.matrix.clear();
        self.matrix.resize(order * order, 0.0);
        self.x.copy_from_slice(x);
        // By the same route as the others, so that what rounding does cancels: the gradient in memory
        // may be Jᵀr.
        problem.residual(x, &mut self.residual);
        problem.gradient(x, &self.residual, &mut self.gradient_here, jacobian);
        for (row, &j) in self.matrix.chunks_exact_mut(order.max(1)).zip(free) {
            let step = RELATIVE_STEP * x[j].abs().max(1.0);
            // Into the bounds, where the problem is defined; a range narrower than that is crossed.
            let room_above = problem.upper()[j] - x[j];
            let room_below = x[j] - problem.lower()[j];
            self.x[j] = if room_above >= room_below {
                x[j] + step.min(room_above)
            } else {
                x[j] - step.min(room_below)
            };
            let taken = self.x[j] - x[j];
            problem.residual(&self.x, &mut self.residual);
            problem.gradient(&self.x, &self.residual, &mut self.gradient, jacobian);
            for (entry, &k) in row.iter_mut().zip(free) {
                *entry = (self.gradient[k] - self.gradient_here[k]) / taken;
            }
            self.x[j] = x[j];
        }
        for a in 0..order {
            for b in 0..a {
                let mean = 0.5 * (self.matrix[a * order + b] + self.matrix[b * order + a]);
                self.matrix[a * order + b] = mean;
                self.matrix[b * order + a] = mean;
            }
        }
        self.is_fresh = true;
        order + 1
    }

    /// Writes the Δ of (H + λI) Δ = −g at the free variables of `step`, with λ raised as far as the
    /// system needs to be positive definite. Returns that λ.
    pub(super) fn solve(
        &mut self,
        slope: &[f64],
        free: &[usize],
        damping: f64,
        step: &mut [f64],
    ) -> f64 {
        let order = free.len();
        let diagonal = (0..order).map(|k| self.matrix[k * order + k].abs());
        let largest = diagonal.fold(0.0, f64::max);
        let mut damping = damping;
        for _ in 0..MOST_RAISES {
            self.factor.clear();
            self.factor.extend_from_slice(&self.matrix);
            for k in 0..order {
                self.factor[k * order + k] += damping;
            }
            factorise(&mut self.factor, order, &mut self.pivot_column);
            if (0..order).all(|k| self.factor[k * order + k] > 0.0) {
                break;
            }
            damping = (4.0 * damping).max(FIRST_RAISE * largest);
        }
        self.unknown.clear();
        self.unknown.extend(free.iter().map(|&j| -slope[j]));
        substitute(&self.factor, order, &mut self.unknown);
        for (&j, &value) in free.iter().zip(&self.unknown) {
            step[j] = value;
        }
        damping
    }

    /// −gᵀΔ − ½ΔᵀHΔ: by how much the cost should fall.
    pub(super) fn promised(&mut self, slope: &[f64], free: &[usize], step: &[f64]) -> f64 {
        self.unknown.clear();
        self.unknown.extend(free.iter().map(|&j| step[j]));
        let rows = self.matrix.chunks_exact(free.len().max(1));
        let falls = rows.zip(free).zip(&self.unknown);
        falls
            .map(|((row, &j), own)| -own * (slope[j] + 0.5 * dot(row, &self.unknown)))
            .sum()
    }
}
