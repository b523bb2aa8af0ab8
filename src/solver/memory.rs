//! The memory of one search, reused from search to search.

use std::ops::AddAssign;

use nalgebra::DMatrix;

use super::LeastSquares;
use super::active_set::{list_free, project, projected_gradient_norm};
use super::curvature::{Curvature, Differences};
use super::linear::{CompleteOrthogonal, CurvedNormal, DampedNormal, add_scaled, dot};

/// How many past costs a search may remember.
pub(super) const MOST_RECENT_COSTS: usize = 10;

/// A step that changes the cost by no more than this share of it has hardly changed it.
const FLAT: f64 = 1e-13;

/// How often a problem was evaluated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Counts {
    /// Residual evaluations.
    pub residuals: usize,
    /// Jacobian evaluations.
    pub jacobians: usize,
    /// Gradient evaluations without a Jacobian.
    pub gradients: usize,
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.residuals += other.residuals;
        self.jacobians += other.jacobians;
        self.gradients += other.gradients;
    }
}

/// Where a search stands, and room for its next step.
#[derive(Clone, Debug)]
pub struct Memory {
    pub(super) x: Vec<f64>,
    pub(super) residual: Vec<f64>,
    pub(super) cost: f64,
    pub(super) gradient: Vec<f64>,
    pub(super) jacobian: DMatrix<f64>,
    /// Largest column norm of the last Jacobian.
    pub(super) column_norm: f64,
    pub(super) free: Vec<usize>,
    pub(super) trial: Vec<f64>,
    pub(super) trial_residual: Vec<f64>,
    pub(super) step: Vec<f64>,
    pub(super) damping: f64,
    /// By how much a refused step raises λ (Nielsen's ν).
    pub(super) damping_growth: f64,
    /// μ in λ = μ · cost.
    pub(super) damping_per_cost: f64,
    /// Δ, while the trials of a line search overwrite `step`.
    pub(super) direction: Vec<f64>,
    /// How many steps in a row have hardly changed the cost.
    pub(super) flat_steps: usize,
    pub(super) previous_x: Vec<f64>,
    pub(super) previous_gradient: Vec<f64>,
    /// Costs of the last steps, newest last, for searches that may climb for a while.
    pub(super) recent_costs: Vec<f64>,
    pub(super) best_x: Vec<f64>,
    pub(super) best_cost: f64,
    pub(super) normal: DampedNormal,
    pub(super) curvature: Curvature,
    pub(super) differences: Differences,
    pub(super) curved: CurvedNormal,
    pub(super) orthogonal: CompleteOrthogonal,
    pub(super) counts: Counts,
}

impl Default for Memory {
    fn default() -> Self {
        Self {
            x: Vec::new(),
            residual: Vec::new(),
            cost: f64::INFINITY,
            gradient: Vec::new(),
            jacobian: DMatrix::zeros(0, 0),
            column_norm: 0.0,
            free: Vec::new(),
            trial: Vec::new(),
            trial_residual: Vec::new(),
            step: Vec::new(),
            damping: 0.0,
            damping_growth: 0.0,
            damping_per_cost: 0.0,
            direction: Vec::new(),
            flat_steps: 0,
            previous_x: Vec::new(),
            previous_gradient: Vec::new(),
            recent_costs: Vec::new(),
            best_x: Vec::new(),
            best_cost: f64::INFINITY,
            normal: DampedNormal::default(),
            curvature: Curvature::default(),
            differences: Differences::default(),
            curved: CurvedNormal::default(),
            orthogonal: CompleteOrthogonal::default(),
            counts: Counts::default(),
        }
    }
}

impl Memory {
    /// Where the search stands.
    #[must_use]
    pub fn x(&self) -> &[f64] {
        &self.x
    }

    /// r(x).
    #[must_use]
    pub fn residual(&self) -> &[f64] {
        &self.residual
    }

    /// ½‖r(x)‖².
    #[must_use]
    pub fn cost(&self) -> f64 {
        self.cost
    }

    /// Jᵀr at x.
    #[must_use]
    pub fn gradient(&self) -> &[f64] {
        &self.gradient
    }

    /// J where it was taken last.
    pub(crate) fn jacobian(&self) -> &DMatrix<f64> {
        &self.jacobian
    }

    /// λ for Levenberg-Marquardt, the step length σ or α for the others.
    #[must_use]
    pub fn damping(&self) -> f64 {
        self.damping
    }

    /// Evaluations so far in this search.
    #[must_use]
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Takes the shape of `problem` and stands at the projected start, where what is missing or not
    /// finite counts as zero.
    pub(super) fn start_at(&mut self, problem: &mut dyn LeastSquares, start: &[f64]) {
        let (n, m) = (problem.variables(), problem.rows());
        for vector in [
            &mut self.x,
            &mut self.gradient,
            &mut self.trial,
            &mut self.step,
            &mut self.direction,
            &mut self.previous_x,
            &mut self.previous_gradient,
            &mut self.best_x,
        ] {
            vector.clear();
            vector.resize(n, 0.0);
        }
        for vector in [&mut self.residual, &mut self.trial_residual] {
            vector.clear();
            vector.resize(m, 0.0);
        }
        if self.jacobian.shape() != (m, n) {
            self.jacobian = DMatrix::zeros(m, n);
        }
        self.free.clear();
        self.free.reserve(n);
        self.recent_costs.clear();
        self.recent_costs.reserve(MOST_RECENT_COSTS);
        self.normal.reserve(m, n);
        self.curvature.reset(n);
        self.differences.reserve(m, n);
        self.curved.reserve(m, n);
        self.orthogonal.reserve(m, n);
        self.counts = Counts::default();
        self.damping = 0.0;
        self.damping_growth = 0.0;
        self.damping_per_cost = 0.0;
        self.flat_steps = 0;

        for (own, &given) in self.x.iter_mut().zip(start) {
            *own = if given.is_finite() { given } else { 0.0 };
        }
        project(&mut self.x, problem.lower(), problem.upper());
        self.cost = f64::INFINITY;
        if has_bounds_for_all(problem) {
            problem.residual(&self.x, &mut self.residual);
            self.counts.residuals += 1;
            self.cost = half_squared(&self.residual);
        }
        self.best_cost = self.cost;
        self.best_x.copy_from_slice(&self.x);
    }

    /// Evaluates the Jacobian at x, and with it what it decides: the gradient, the largest column
    /// norm and the free variables. The factorisation of the last one is forgotten.
    pub(super) fn differentiate(&mut self, problem: &mut dyn LeastSquares) {
        problem.jacobian(&self.x, &mut self.jacobian);
        self.counts.jacobians += 1;
        self.normal.forget();
        let residual = std::mem::take(&mut self.residual);
        self.take_slope(&residual);
        self.residual = residual;
        self.list_free(problem);
    }

    /// Jᵀr and the largest column norm of the Jacobian in memory.
    fn take_slope(&mut self, residual: &[f64]) {
        let columns = self.jacobian.as_slice().chunks_exact(residual.len().max(1));
        let mut squared = 0.0_f64;
        for (entry, column) in self.gradient.iter_mut().zip(columns) {
            *entry = dot(column, residual);
            squared = squared.max(dot(column, column));
        }
        self.column_norm = squared.sqrt();
    }

    /// Evaluates the gradient alone at x, and the free variables with it.
    pub(super) fn differentiate_cost(&mut self, problem: &mut dyn LeastSquares) {
        problem.gradient(
            &self.x,
            &self.residual,
            &mut self.gradient,
            &mut self.jacobian,
        );
        self.counts.gradients += 1;
        self.list_free(problem);
    }

    /// Puts r(x) at any x into [`residual`](Self::residual).
    pub(crate) fn evaluate_at(&mut self, problem: &mut dyn LeastSquares, x: &[f64]) {
        problem.residual(x, &mut self.residual);
    }

    /// The gradient Jᵀr at any x with residual r, and the largest column norm of J there.
    pub(crate) fn slope_at(
        &mut self,
        problem: &mut dyn LeastSquares,
        x: &[f64],
        residual: &[f64],
    ) -> (&[f64], f64) {
        problem.jacobian(x, &mut self.jacobian);
        self.take_slope(residual);
        (&self.gradient, self.column_norm)
    }

    /// Makes room for the slope of a problem that no search has started on.
    pub(crate) fn take_shape(&mut self, rows: usize, variables: usize) {
        self.gradient.resize(variables, 0.0);
        if self.jacobian.shape() != (rows, variables) {
            self.jacobian = DMatrix::zeros(rows, variables);
        }
    }

    fn list_free(&mut self, problem: &dyn LeastSquares) {
        list_free(
            &self.x,
            &self.gradient,
            problem.lower(),
            problem.upper(),
            &mut self.free,
        );
    }

    pub(super) fn projected_gradient_norm(&self, problem: &dyn LeastSquares) -> f64 {
        self.projected_step_norm(1.0, problem)
    }

    fn projected_step_norm(&self, curvature: f64, problem: &dyn LeastSquares) -> f64 {
        let (lower, upper) = (problem.lower(), problem.upper());
        projected_gradient_norm(&self.x, &self.gradient, curvature, lower, upper)
    }

    /// s ‖proj(x − g/s²) − x‖∞ / ‖r‖ with s the largest column norm of J: the cosine between r and
    /// what a free variable can do about it (MINPACK's test, Moré 1978, for bounds). The step
    /// g/s² is of the size of x, so the test does not depend on the unit of r.
    pub(super) fn stationarity(&self, problem: &dyn LeastSquares) -> f64 {
        let length = (2.0 * self.cost).sqrt();
        if length == 0.0 || self.column_norm == 0.0 {
            return 0.0;
        }
        let scale = self.column_norm;
        self.projected_step_norm(scale * scale, problem) * scale / length
    }

    /// Projects `trial`, evaluates it and returns its cost; `step` becomes trial − x, after
    /// projection.
    pub(super) fn evaluate_trial(&mut self, problem: &mut dyn LeastSquares) -> f64 {
        self.project_trial(problem);
        self.evaluate_projected_trial(problem)
    }

    /// Projects `trial` and makes `step` what is left of the way there.
    pub(super) fn project_trial(&mut self, problem: &dyn LeastSquares) {
        project(&mut self.trial, problem.lower(), problem.upper());
        for ((step, &trial), &x) in self.step.iter_mut().zip(&self.trial).zip(&self.x) {
            *step = trial - x;
        }
    }

    /// Evaluates `trial`, which is within the bounds, and returns its cost.
    pub(super) fn evaluate_projected_trial(&mut self, problem: &mut dyn LeastSquares) -> f64 {
        problem.residual(&self.trial, &mut self.trial_residual);
        self.counts.residuals += 1;
        half_squared(&self.trial_residual)
    }

    /// Makes the trial the place where the search stands.
    pub(super) fn accept_trial(&mut self, cost: f64) {
        std::mem::swap(&mut self.x, &mut self.trial);
        std::mem::swap(&mut self.residual, &mut self.trial_residual);
        let flat = (self.cost - cost).abs() <= FLAT * self.cost;
        self.flat_steps = if flat { self.flat_steps + 1 } else { 0 };
        self.cost = cost;
        if cost < self.best_cost {
            self.best_cost = cost;
            self.best_x.copy_from_slice(&self.x);
        }
    }

    /// ½‖r + J Δ‖² for the step Δ: what the linear model promises.
    pub(super) fn model_cost(&mut self) -> f64 {
        let predicted = &mut self.trial_residual;
        predicted.copy_from_slice(&self.residual);
        let rows = predicted.len();
        let columns = self.jacobian.as_slice().chunks_exact(rows.max(1));
        for (&step, column) in self.step.iter().zip(columns) {
            if step != 0.0 {
                add_scaled(predicted, step, column);
            }
        }
        half_squared(predicted)
    }

    /// ‖Δ‖∞ of the last step.
    pub(super) fn step_norm(&self) -> f64 {
        self.step.iter().fold(0.0, |most, s| most.max(s.abs()))
    }

    /// Whether the last step moves no variable by more than tolerance · max(1, |x|).
    pub(super) fn step_is_negligible(&self, tolerance: f64) -> bool {
        let moves = self.step.iter().zip(&self.x);
        moves
            .into_iter()
            .all(|(s, x)| s.abs() <= tolerance * x.abs().max(1.0))
    }
}

/// Whether there is a bound on either side for every variable.
pub(super) fn has_bounds_for_all(problem: &dyn LeastSquares) -> bool {
    let n = problem.variables();
    problem.lower().len() == n && problem.upper().len() == n
}

/// ½‖r‖².
pub(crate) fn half_squared(residual: &[f64]) -> f64 {
    0.5 * dot(residual, residual)
}
