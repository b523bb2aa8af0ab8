//! What the linear model leaves out: Σ r_k ∇²r_k, learnt from how gradients change.
//!
//! Where the residual stays large (a target out of reach, tasks that contradict each other) JᵀJ alone
//! is a poor Hessian and Levenberg-Marquardt creeps. The structured secant update of Dennis, Gay &
//! Welsch (1981, "An adaptive nonlinear least-squares algorithm", ACM TOMS 7, 348-368, section 3)
//! adds a symmetric S with S s = y# for the last step s, and as there the model that foretold the
//! last step better makes the next one.

use nalgebra::DMatrix;

use super::linear::{add_scaled, dot, multiply_symmetric, quadratic};

/// A step that leaves more than this share of the cost is slow; after so many in a row the learning
/// begins. Problems whose targets are reached never pay for it.
const SLOW: f64 = 0.5;
const SLOW_STEPS: usize = 6;

/// yᵀs below this share of ‖y‖‖s‖ is taken for zero.
const NEGLIGIBLE_COSINE: f64 = 1e-10;

/// S, and what the next update of it needs.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "argmin", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Curvature {
    /// S, n × n, symmetric, row by row; empty until the learning begins.
    matrix: Vec<f64>,
    /// Whether S foretold the last step better than S = 0.
    in_use: bool,
    slow_steps: usize,
    /// Whether the four below tell of a step that S has not learnt from.
    pending: bool,
    step: Vec<f64>,
    gradient_before: Vec<f64>,
    /// J₋ᵀ r₊: the old Jacobian under the new residual.
    crossed: Vec<f64>,
    /// y# − S s.
    missing: Vec<f64>,
}

impl Curvature {
    /// Forgets everything and makes room for n variables.
    pub(super) fn reset(&mut self, n: usize) {
        self.in_use = false;
        self.slow_steps = 0;
        self.pending = false;
        self.matrix.clear();
        self.matrix.reserve(n * n);
        for vector in [
            &mut self.step,
            &mut self.gradient_before,
            &mut self.crossed,
            &mut self.missing,
        ] {
            vector.clear();
            vector.resize(n, 0.0);
        }
    }

    /// Whether this is of a search over n variables.
    #[cfg(feature = "argmin")]
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

    /// S where it makes the next step.
    pub(super) fn in_use(&self) -> Option<&[f64]> {
        self.in_use.then_some(self.matrix.as_slice())
    }

    /// ½ sᵀ S s where S makes the step: what it adds to the cost foretold.
    pub(super) fn bend_in_use(&self, step: &[f64]) -> f64 {
        self.in_use().map_or(0.0, |s| 0.5 * quadratic(s, step))
    }

    /// Notes an accepted step, before x moves and J is evaluated anew. `linear` is the cost that JᵀJ
    /// foretold for it.
    pub(super) fn note(
        &mut self,
        jacobian: &DMatrix<f64>,
        gradient: &[f64],
        step: &[f64],
        new_residual: &[f64],
        (linear, old_cost, new_cost): (f64, f64, f64),
    ) {
        let bent = linear + 0.5 * quadratic(&self.matrix, step);
        self.in_use =
            !self.matrix.is_empty() && (bent - new_cost).abs() < (linear - new_cost).abs();
        let slow = new_cost > SLOW * old_cost;
        self.slow_steps = if slow { self.slow_steps + 1 } else { 0 };
        self.pending = self.slow_steps >= SLOW_STEPS || !self.matrix.is_empty();
        if !self.pending {
            return;
        }
        self.step.copy_from_slice(step);
        self.gradient_before.copy_from_slice(gradient);
        let columns = jacobian.as_slice().chunks_exact(new_residual.len().max(1));
        for (entry, column) in self.crossed.iter_mut().zip(columns) {
            *entry = dot(column, new_residual);
        }
    }

    /// Learns from the noted step, now that the gradient after it is known.
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
        // yᵀs divides: a step that hardly changed the slope teaches nothing.
        let along = dot(change, &self.step);
        let negligible =
            NEGLIGIBLE_COSINE * (dot(change, change) * dot(&self.step, &self.step)).sqrt();
        if along.is_nan() || along <= negligible {
            return;
        }
        // Sizing (section 4 there): S must shrink with the residual.
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
