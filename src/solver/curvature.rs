//! Second-order part of the Hessian, Σ r_k ∇²r_k, learnt from changes of the gradient.
//!
//! If the residual stays large (an unreachable target, conflicting tasks), JᵀJ alone is a poor Hessian and
//! Levenberg-Marquardt is slow. A symmetric S with S s = y# for the last step s is therefore added. It is the
//! structured secant update of Dennis, Gay & Welsch (1981, "An adaptive nonlinear least-squares algorithm", ACM TOMS 7,
//! 348-368, section 3). The model that predicted the last step better makes the next one. A search that stays slow at a
//! large residual computes S from differences of the exact gradient, at one gradient per free variable.

use nalgebra::DMatrix;

use super::linear::{add_scaled, dot, multiply_symmetric, quadratic};
use super::{LeastSquares, SolverState};
use crate::buffer::{refill, vacate};

/// Ratio of costs above which a step is slow.
const SLOW: f64 = 0.5;
/// Number of slow steps in a row after which S is learnt, so that problems with reached targets never pay for it.
const SLOW_STEPS: usize = 6;

/// Number of slow steps in a row after which S is computed from differences; again after as many more.
const SLOWER_STEPS: usize = 10;

/// Smallest residual norm for S from differences, as a fraction of the largest column norm of J, both per radian.
///
/// Below it the residual adds at most that fraction of JᵀJ to the Hessian, and a search is slow because J is singular.
const LARGE_RESIDUAL: f64 = 1e-3;

/// Difference in x, relative to max(1, |x|): ∛ε, as gradients may be differences themselves.
const RELATIVE_STEP: f64 = 6.055_454_452_393_343e-6;

/// Smallest yᵀs, as a fraction of ‖y‖‖s‖, that counts as nonzero.
const NEGLIGIBLE_COSINE: f64 = 1e-10;

/// The matrix S and the data of its next update.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "argmin", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Curvature {
    /// S, n × n, symmetric, row by row; empty until it is learnt.
    matrix: Vec<f64>,
    /// True if S predicted the last step better than S = 0.
    in_use: bool,
    slow_steps: usize,
    /// True if the four vectors below describe a step that S has not learnt from.
    pending: bool,
    step: Vec<f64>,
    gradient_before: Vec<f64>,
    /// J₋ᵀ r₊: the previous Jacobian with the new residual.
    crossed: Vec<f64>,
    /// y# − S s.
    missing: Vec<f64>,
}

/// Buffers for S from differences of the gradient.
#[derive(Clone, Debug, Default)]
pub(super) struct Differences {
    x: Vec<f64>,
    residual: Vec<f64>,
    gradient: Vec<f64>,
    gradient_here: Vec<f64>,
    /// Scratch memory for gradients that need a Jacobian.
    jacobian: DMatrix<f64>,
}

impl Differences {
    /// Resizes the buffers for m rows and n variables.
    pub(super) fn reserve(&mut self, m: usize, n: usize) {
        for (vector, length) in [
            (&mut self.x, n),
            (&mut self.residual, m),
            (&mut self.gradient, n),
            (&mut self.gradient_here, n),
        ] {
            refill(vector, length, 0.0);
        }
        if self.jacobian.shape() != (m, n) {
            self.jacobian = DMatrix::zeros(m, n);
        }
    }

    /// Jᵀr at [`x`](Self::x).
    fn gradient(&mut self, problem: &mut dyn LeastSquares) {
        problem.residual(&self.x, &mut self.residual);
        problem.gradient(
            &self.x,
            &self.residual,
            &mut self.gradient,
            &mut self.jacobian,
        );
    }
}

impl Curvature {
    /// Clears all data and reserves memory for n variables.
    pub(super) fn reset(&mut self, n: usize) {
        self.in_use = false;
        self.slow_steps = 0;
        self.pending = false;
        vacate(&mut self.matrix, n * n);
        for vector in [
            &mut self.step,
            &mut self.gradient_before,
            &mut self.crossed,
            &mut self.missing,
        ] {
            refill(vector, n, 0.0);
        }
    }

    /// Returns true if the data belongs to a search over n variables.
    pub(super) fn fits(&self, n: usize) -> bool {
        let vectors = [
            &self.step,
            &self.gradient_before,
            &self.crossed,
            &self.missing,
        ];
        let square = self.matrix.len() == n * n || (self.matrix.is_empty() && !self.in_use);
        square && vectors.iter().all(|vector| vector.len() == n)
    }

    /// S, if the next step uses it.
    pub(super) fn in_use(&self) -> Option<&[f64]> {
        self.in_use.then_some(self.matrix.as_slice())
    }

    /// ½ sᵀ S s if steps use S, else 0: the second-order part of the predicted cost.
    pub(super) fn bend_in_use(&self, step: &[f64]) -> f64 {
        self.in_use().map_or(0.0, |s| 0.5 * quadratic(s, step))
    }

    /// Records a step that will be accepted, before x moves and J is evaluated again.
    ///
    /// `linear` is the cost that JᵀJ predicted for it.
    pub(super) fn note(&mut self, at: &SolverState, linear: f64, new_cost: f64) {
        let bent = linear + 0.5 * quadratic(&self.matrix, &at.step);
        self.in_use =
            !self.matrix.is_empty() && (bent - new_cost).abs() < (linear - new_cost).abs();
        let slow = new_cost > SLOW * at.cost;
        self.slow_steps = if slow { self.slow_steps + 1 } else { 0 };
        self.pending = self.slow_steps >= SLOW_STEPS || !self.matrix.is_empty();
        if !self.pending {
            return;
        }
        self.step.copy_from_slice(&at.step);
        self.gradient_before.copy_from_slice(&at.gradient);
        let rows = at.trial_residual.len().max(1);
        let columns = at.jacobian.as_slice().chunks_exact(rows);
        for (entry, column) in self.crossed.iter_mut().zip(columns) {
            *entry = dot(column, &at.trial_residual);
        }
    }

    /// Returns true if S should be computed from differences.
    pub(super) fn wants_differences(&self, cost: f64, column_norm: f64) -> bool {
        self.pending
            && self.slow_steps.is_multiple_of(SLOWER_STEPS)
            && self.slow_steps > 0
            && (2.0 * cost).sqrt() > LARGE_RESIDUAL * column_norm
    }

    /// Computes S = H − JᵀJ over the free variables, with H from differences of the gradient at x.
    ///
    /// Returns the number of gradients evaluated.
    pub(super) fn take(
        &mut self,
        problem: &mut dyn LeastSquares,
        at: &SolverState,
        room: &mut Differences,
    ) -> usize {
        let SolverState {
            x, free, jacobian, ..
        } = at;
        let n = x.len();
        room.reserve(at.residual.len(), n);
        self.pending = false;
        self.in_use = true;
        refill(&mut self.matrix, n * n, 0.0);
        room.x.copy_from_slice(x);
        // Evaluated like all later gradients, so that rounding cancels: the gradient in memory may be Jᵀr.
        room.gradient(problem);
        std::mem::swap(&mut room.gradient, &mut room.gradient_here);
        let columns = |j: usize| jacobian.column(j);
        for &j in free {
            let unit = at.step_scale.get(j).copied().unwrap_or(1.0);
            let step = RELATIVE_STEP * x[j].abs().max(unit);
            // Into the bounds, where the problem is defined; a narrower range is crossed.
            let space = problem.space();
            let (below, above) = space.room(x, j);
            let step = match above >= below {
                true => step.min(above),
                false => -step.min(below),
            };
            let taken = space.integrate_one(x, j, step, &mut room.x);
            room.gradient(problem);
            problem.space().return_one(x, j, &mut room.x);
            for &k in free {
                let change = (room.gradient[k] - room.gradient_here[k]) / taken;
                let half = 0.5 * (change - columns(j).dot(&columns(k)));
                self.matrix[j * n + k] += half;
                self.matrix[k * n + j] += half;
            }
        }
        free.len() + 1
    }

    /// Updates S by the recorded step, with the gradient after it.
    pub(super) fn learn(&mut self, gradient: &[f64]) {
        if !std::mem::take(&mut self.pending) {
            return;
        }
        let n = gradient.len();
        if self.matrix.is_empty() {
            self.matrix.resize(n * n, 0.0);
        }
        // y = g₊ − g₋ and y# = J₊ᵀr₊ − J₋ᵀr₊, in place.
        let change = &mut self.gradient_before;
        let sharp = &mut self.crossed;
        for ((y, y_sharp), &g) in change.iter_mut().zip(sharp.iter_mut()).zip(gradient) {
            *y = g - *y;
            *y_sharp = g - *y_sharp;
        }
        // A step that barely changed the slope is no basis for an update.
        let along = dot(change, &self.step);
        let negligible =
            NEGLIGIBLE_COSINE * (dot(change, change) * dot(&self.step, &self.step)).sqrt();
        if along.is_nan() || along <= negligible {
            return;
        }
        // Sizing (section 4 of the same paper): S must shrink with the residual.
        let held = quadratic(&self.matrix, &self.step);
        let wanted = dot(sharp, &self.step);
        if held != 0.0 {
            let size = (wanted / held).abs().min(1.0);
            self.matrix.iter_mut().for_each(|entry| *entry *= size);
        }
        multiply_symmetric(&self.matrix, &self.step, &mut self.missing);
        for (missing, &y_sharp) in self.missing.iter_mut().zip(sharp.iter()) {
            *missing = y_sharp - *missing;
        }
        let excess = dot(&self.missing, &self.step) / (along * along);
        for (i, row) in self.matrix.chunks_exact_mut(n).enumerate() {
            add_scaled(row, self.missing[i] / along - excess * change[i], change);
            add_scaled(row, change[i] / along, &self.missing);
        }
    }
}
