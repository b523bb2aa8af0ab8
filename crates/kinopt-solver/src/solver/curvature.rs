//! Second-order part of the Hessian, Σ r_k ∇²r_k, learnt from changes of the gradient.
//!
//! If the residual stays large (an unreachable target, conflicting tasks), JᵀJ alone is a poor Hessian and
//! Levenberg-Marquardt is slow. A symmetric S with S s = y# for the last step s is therefore added. It is the
//! structured secant update of Dennis, Gay & Welsch (1981, "An adaptive nonlinear least-squares algorithm", ACM TOMS 7,
//! 348-368, section 3). The model that predicted the last step better makes the next one. A search that stays slow at a
//! large residual computes S from differences of the exact gradient, at one gradient per free variable.
//!
//! With many variables and few rows, S is [semiseparable](super::linear::Semiseparable) instead: its m numbers per
//! variable follow from differences of the gradient along m probes. A further probe checks that S has this form. If
//! it repeatedly has not, as with tasks that are no function of frames, the search continues with the n × n matrix.

use nalgebra::DMatrix;

use super::linear::{
    SecondOrder, Semiseparable, SemiseparableNormal, add_scaled, dot, multiply_symmetric, quadratic,
};
use super::{LeastSquares, SolverState};
use kinopt_kinematics::buffer::{refill, vacate};

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

/// Number of variables above which S is semiseparable.
const MANY_VARIABLES: usize = 128;
/// Smallest number of variables per row of a semiseparable S.
const VARIABLES_PER_ROW: usize = 8;
/// Sum of the differences in x of all variables along a probe, in the scales of the variables.
const PROBE_LENGTH: f64 = 1e-6;
/// Smallest column of J in the weights of a probe, relative to the largest.
const SHORT_COLUMN: f64 = 1e-3;
/// Largest error of a semiseparable S along the last probe, relative to the product.
const FORM_ERROR: f64 = 0.1;
/// Number of failed checks of the form after which S is dense.
const FORM_CHECKS: usize = 3;

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
    /// True while S is semiseparable.
    is_separable: bool,
    /// Generators of a semiseparable S, m numbers per variable; empty until they are computed.
    generators: Vec<f64>,
    /// Number of failed checks of the semiseparable form.
    failed_checks: usize,
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
    /// Buffer for m numbers.
    sum: Vec<f64>,
}

/// Returns true if S is sought in semiseparable form for m rows and n variables.
pub(super) fn is_separable(m: usize, n: usize) -> bool {
    n > MANY_VARIABLES && VARIABLES_PER_ROW * m <= n
}

/// Buffers for S from differences of the gradient.
#[derive(Clone, Debug, Default)]
pub(super) struct GradientDifferences {
    x: Vec<f64>,
    residual: Vec<f64>,
    gradient: Vec<f64>,
    gradient_at_x: Vec<f64>,
    /// Weights of the variables in a probe.
    weights: Vec<f64>,
    /// Probe, and the product of J with it.
    probe: Vec<f64>,
    image: Vec<f64>,
    /// Product of S with a probe.
    product: Vec<f64>,
    /// Scratch memory for gradients that need a Jacobian.
    jacobian: DMatrix<f64>,
}

impl GradientDifferences {
    /// Resizes the buffers for m rows and n variables.
    pub(super) fn reserve(&mut self, m: usize, n: usize) {
        for (vector, length) in [
            (&mut self.x, n),
            (&mut self.residual, m),
            (&mut self.gradient, n),
            (&mut self.gradient_at_x, n),
            (&mut self.weights, n),
            (&mut self.probe, n),
            (&mut self.image, m),
            (&mut self.product, n),
        ] {
            refill(vector, length, 0.0);
        }
        if self.jacobian.shape() != (m, n) {
            self.jacobian = DMatrix::zeros(m, n);
        }
    }

    /// Resizes the buffers, and evaluates the gradient at the x of a state.
    ///
    /// The gradient of the state may be Jᵀr. This one is evaluated like all later ones, so that rounding cancels.
    fn begin(&mut self, problem: &mut dyn LeastSquares, at: &SolverState) {
        self.reserve(at.residual.len(), at.x.len());
        self.x.copy_from_slice(&at.x);
        self.gradient(problem);
        std::mem::swap(&mut self.gradient, &mut self.gradient_at_x);
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

    /// Weights the free variables for probes: by the inverse square of their column of J.
    ///
    /// Short columns, of joints near a tip, then count as much as long ones in the equations for the generators.
    /// Variables at a bound are left out, as probes go to both sides.
    fn weight_variables(&mut self, problem: &dyn LeastSquares, at: &SolverState) {
        let min_column = SHORT_COLUMN * at.column_norm;
        let space = problem.space();
        for &j in &at.free {
            let unit = at.step_scale.get(j).copied().unwrap_or(1.0);
            let column = at.jacobian.column(j).norm() * unit;
            let (max_decrease, max_increase) = space.room(&at.x, j);
            if max_decrease.min(max_increase) > 2.0 * PROBE_LENGTH * unit {
                let length = column.max(min_column) / unit;
                self.weights[j] = 1.0 / (length * length);
            }
        }
    }

    /// Writes S times the probe: the difference of the gradient, less JᵀJ.
    fn multiply_probe(&mut self, problem: &mut dyn LeastSquares, at: &SolverState) {
        let units = at.step_scale.iter().copied().chain(std::iter::repeat(1.0));
        let parts = self.probe.iter().zip(units);
        let length: f64 = parts.map(|(part, unit)| part.abs() / unit).sum();
        self.product.fill(0.0);
        if length == 0.0 {
            return;
        }
        let fraction = PROBE_LENGTH / length;
        let space = problem.space();
        space.integrate_share(&at.x, fraction, &self.probe, &mut self.x);
        self.gradient(problem);
        self.image.fill(0.0);
        let rows = self.image.len().max(1);
        let columns = || at.jacobian.as_slice().chunks_exact(rows);
        for (column, &part) in columns().zip(&self.probe) {
            add_scaled(&mut self.image, part, column);
        }
        for &j in &at.free {
            let column = &at.jacobian.as_slice()[j * rows..(j + 1) * rows];
            let change = (self.gradient[j] - self.gradient_at_x[j]) / fraction;
            self.product[j] = change - dot(column, &self.image);
        }
    }
}

impl Curvature {
    /// Clears all data and reserves memory for m rows and n variables.
    pub(super) fn reset(&mut self, m: usize, n: usize) {
        self.is_separable = is_separable(m, n);
        self.failed_checks = 0;
        self.in_use = false;
        self.slow_steps = 0;
        self.pending = false;
        let (dense, separable) = if self.is_separable {
            (0, m * n)
        } else {
            (n * n, 0)
        };
        vacate(&mut self.matrix, dense);
        vacate(&mut self.generators, separable);
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
        let is_known = match self.is_separable {
            true => !self.generators.is_empty() && self.generators.len().is_multiple_of(n.max(1)),
            false => self.matrix.len() == n * n,
        };
        let is_empty = self.matrix.is_empty() && self.generators.is_empty() && !self.in_use;
        (is_known || is_empty) && vectors.iter().all(|vector| vector.len() == n)
    }

    /// S, if the next step uses it.
    pub(super) fn in_use(&self) -> Option<SecondOrder<'_>> {
        self.in_use.then_some(match self.is_separable {
            true => SecondOrder::Semiseparable(&self.generators),
            false => SecondOrder::Dense(&self.matrix),
        })
    }

    /// Returns true while S is semiseparable.
    pub(super) fn is_separable(&self) -> bool {
        self.is_separable
    }

    /// True until S is learnt.
    fn is_unknown(&self) -> bool {
        match self.is_separable {
            true => self.generators.is_empty(),
            false => self.matrix.is_empty(),
        }
    }

    /// ½ sᵀ S s for the last step s, 0 until S is learnt.
    fn second_order_cost(&mut self, at: &SolverState) -> f64 {
        let quadratic_form = match self.is_separable {
            true => {
                let jacobian = &at.jacobian;
                let generators = &self.generators;
                Semiseparable {
                    jacobian,
                    generators,
                }
                .quadratic(&at.step, &mut self.sum)
            }
            false => quadratic(&self.matrix, &at.step),
        };
        0.5 * quadratic_form
    }

    /// ½ sᵀ S s if steps use S, else 0: the second-order part of the predicted cost.
    pub(super) fn second_order_cost_in_use(&mut self, at: &SolverState) -> f64 {
        if self.in_use {
            self.second_order_cost(at)
        } else {
            0.0
        }
    }

    /// Records a step that will be accepted, before x moves and J is evaluated again.
    ///
    /// `linear` is the cost that JᵀJ predicted for it.
    pub(super) fn record_step(&mut self, at: &SolverState, linear: f64, new_cost: f64) {
        let curved_cost = linear + self.second_order_cost(at);
        self.in_use =
            !self.is_unknown() && (curved_cost - new_cost).abs() < (linear - new_cost).abs();
        let is_slow = new_cost > SLOW * at.cost;
        self.slow_steps = if is_slow { self.slow_steps + 1 } else { 0 };
        self.pending = self.slow_steps >= SLOW_STEPS || !self.is_unknown();
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
    pub(super) fn needs_differences(&self, cost: f64, column_norm: f64) -> bool {
        let is_due = match self.is_separable {
            true => self.slow_steps >= SLOW_STEPS,
            false => self.slow_steps > 0 && self.slow_steps.is_multiple_of(SLOWER_STEPS),
        };
        self.pending && is_due && (2.0 * cost).sqrt() > LARGE_RESIDUAL * column_norm
    }

    /// Computes S = H − JᵀJ over the free variables, with H from differences of the gradient at x.
    ///
    /// Returns the number of gradients evaluated.
    pub(super) fn compute_dense(
        &mut self,
        problem: &mut dyn LeastSquares,
        at: &SolverState,
        differences: &mut GradientDifferences,
    ) -> usize {
        let SolverState {
            x, free, jacobian, ..
        } = at;
        let n = x.len();
        differences.begin(problem, at);
        self.pending = false;
        self.in_use = true;
        refill(&mut self.matrix, n * n, 0.0);
        let columns = |j: usize| jacobian.column(j);
        for &j in free {
            let unit = at.step_scale.get(j).copied().unwrap_or(1.0);
            let step = RELATIVE_STEP * x[j].abs().max(unit);
            // Into the bounds, where the problem is defined; a narrower range is crossed.
            let space = problem.space();
            let (max_decrease, max_increase) = space.room(x, j);
            let step = match max_increase >= max_decrease {
                true => step.min(max_increase),
                false => -step.min(max_decrease),
            };
            let rounded_step = space.integrate_one(x, j, step, &mut differences.x);
            differences.gradient(problem);
            problem.space().return_one(x, j, &mut differences.x);
            for &k in free {
                let change =
                    (differences.gradient[k] - differences.gradient_at_x[k]) / rounded_step;
                let half_difference = 0.5 * (change - columns(j).dot(&columns(k)));
                self.matrix[j * n + k] += half_difference;
                self.matrix[k * n + j] += half_difference;
            }
        }
        free.len() + 1
    }

    /// Computes a semiseparable S over the free variables from differences of the gradient along probes at x.
    ///
    /// Returns the number of gradients evaluated. If S repeatedly has not this form, the search continues with a dense S.
    pub(super) fn compute_separable(
        &mut self,
        problem: &mut dyn LeastSquares,
        at: &SolverState,
        differences: &mut GradientDifferences,
        normal: &mut SemiseparableNormal,
    ) -> usize {
        let (m, n) = (at.residual.len(), at.x.len());
        differences.begin(problem, at);
        let is_first = self.generators.is_empty();
        refill(&mut self.generators, m * n, 0.0);
        differences.weight_variables(problem, at);
        for k in 0..m {
            for &j in &at.free {
                differences.probe[j] = differences.weights[j] * at.jacobian[(k, j)];
            }
            differences.multiply_probe(problem, at);
            for &j in &at.free {
                self.generators[j * m + k] = differences.product[j];
            }
        }
        normal.recover(
            &at.jacobian,
            &differences.weights,
            &at.free,
            &mut self.generators,
        );
        self.in_use = true;
        if !is_first {
            self.pending = false;
            return m + 1;
        }
        // A probe that is no combination of the others.
        for (k, &j) in at.free.iter().enumerate() {
            let column = at.jacobian.column(j);
            let ramp = (k + 1) as f64 / at.free.len() as f64;
            differences.probe[j] = ramp * differences.weights[j] * column.sum();
        }
        differences.multiply_probe(problem, at);
        let squared_product = dot(&differences.product, &differences.product);
        let generators = &self.generators;
        let jacobian = &at.jacobian;
        differences.x.fill(0.0);
        Semiseparable {
            jacobian,
            generators,
        }
        .add_product(&differences.probe, &mut differences.x, &mut self.sum);
        let squared_error = at.free.iter().map(|&j| {
            let error = differences.x[j] - differences.product[j];
            error * error
        });
        let squared_error = squared_error.sum::<f64>();
        // Away from a minimum, the three columns of a ball joint depend on their order, and S may be known later.
        self.pending = false;
        if squared_error > FORM_ERROR * FORM_ERROR * squared_product {
            self.in_use = false;
            self.generators.clear();
            self.failed_checks += 1;
            self.is_separable = self.failed_checks < FORM_CHECKS;
        }
        m + 2
    }

    /// Updates S by the recorded step, with the gradient after it.
    pub(super) fn update(&mut self, gradient: &[f64]) {
        if !std::mem::take(&mut self.pending) || self.is_separable {
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
        let change_dot_step = dot(change, &self.step);
        let negligible =
            NEGLIGIBLE_COSINE * (dot(change, change) * dot(&self.step, &self.step)).sqrt();
        if change_dot_step.is_nan() || change_dot_step <= negligible {
            return;
        }
        // Sizing (section 4 of the same paper): S must shrink with the residual.
        let current = quadratic(&self.matrix, &self.step);
        let required = dot(sharp, &self.step);
        if current != 0.0 {
            let size = (required / current).abs().min(1.0);
            self.matrix.iter_mut().for_each(|entry| *entry *= size);
        }
        multiply_symmetric(&self.matrix, &self.step, &mut self.missing);
        for (missing, &y_sharp) in self.missing.iter_mut().zip(sharp.iter()) {
            *missing = y_sharp - *missing;
        }
        let excess = dot(&self.missing, &self.step) / (change_dot_step * change_dot_step);
        for (i, row) in self.matrix.chunks_exact_mut(n).enumerate() {
            add_scaled(
                row,
                self.missing[i] / change_dot_step - excess * change[i],
                change,
            );
            add_scaled(row, change[i] / change_dot_step, &self.missing);
        }
    }
}
