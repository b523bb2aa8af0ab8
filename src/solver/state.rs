//! State of a search at its current point, with memory that is reused from search to search.

use std::any::Any;
use std::ops::AddAssign;

use nalgebra::DMatrix;

use super::LeastSquares;
use super::linear::{dot, largest};
use crate::buffer::{refill, vacate};

/// Numbers of evaluations of a problem.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

/// State of a search at its current point, with scratch memory for the next step.
///
/// The state of the method is separate: [`Method::State`](super::Method::State).
#[derive(Clone, Debug)]
pub struct SolverState {
    pub(super) x: Vec<f64>,
    pub(super) residual: Vec<f64>,
    pub(super) cost: f64,
    pub(super) gradient: Vec<f64>,
    pub(super) jacobian: DMatrix<f64>,
    pub(super) column_norm: f64,
    /// Units of the steps by variable, from [`LeastSquares::step_scale`]; empty if all are 1.
    pub(super) step_scale: Vec<f64>,
    pub(super) free: Vec<usize>,
    pub(super) step: Vec<f64>,
    pub(super) trial: Vec<f64>,
    pub(super) trial_residual: Vec<f64>,
    pub(super) trial_cost: f64,
    /// Number of flat steps in a row.
    pub(super) flat_steps: usize,
    pub(super) best_x: Vec<f64>,
    pub(super) best_cost: f64,
    pub(super) counts: Counts,
    pub(super) pool: StatePool,
}

impl Default for SolverState {
    fn default() -> Self {
        Self {
            x: Vec::new(),
            residual: Vec::new(),
            cost: f64::INFINITY,
            gradient: Vec::new(),
            jacobian: DMatrix::zeros(0, 0),
            column_norm: 0.0,
            step_scale: Vec::new(),
            free: Vec::new(),
            step: Vec::new(),
            trial: Vec::new(),
            trial_residual: Vec::new(),
            trial_cost: f64::INFINITY,
            flat_steps: 0,
            best_x: Vec::new(),
            best_cost: f64::INFINITY,
            counts: Counts::default(),
            pool: StatePool::default(),
        }
    }
}

/// States of methods between searches, one per type, whose memory the next search reuses.
#[derive(Debug, Default)]
pub(super) struct StatePool(Vec<Box<dyn Any + Send + Sync>>);

impl StatePool {
    /// State of this type from the last search, or a new one.
    pub(super) fn take<S: Any + Default>(&mut self) -> Box<S> {
        let known = self.0.iter().position(|state| state.is::<S>());
        let known = known.and_then(|index| self.0.swap_remove(index).downcast().ok());
        known.unwrap_or_default()
    }

    /// Stores a state for the next search.
    pub(super) fn keep<S: Any + Send + Sync>(&mut self, state: Box<S>) {
        self.0.push(state);
    }
}

impl Clone for StatePool {
    /// A clone is empty: the pool holds memory, not data.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl SolverState {
    /// Current point x of the search.
    #[must_use]
    pub fn x(&self) -> &[f64] {
        &self.x
    }

    /// Residual r(x).
    #[must_use]
    pub fn residual(&self) -> &[f64] {
        &self.residual
    }

    /// Cost ½‖r(x)‖².
    #[must_use]
    pub fn cost(&self) -> f64 {
        self.cost
    }

    /// Gradient Jᵀr at x.
    #[must_use]
    pub fn gradient(&self) -> &[f64] {
        &self.gradient
    }

    /// Jacobian at the point of its last evaluation: x, for methods that need it.
    #[must_use]
    pub fn jacobian(&self) -> &DMatrix<f64> {
        &self.jacobian
    }

    /// Largest norm of a column of J.
    #[must_use]
    pub fn column_norm(&self) -> f64 {
        self.column_norm
    }

    /// Free variables at x: all but those at a bound whose descent direction points outward.
    #[must_use]
    pub fn free(&self) -> &[usize] {
        &self.free
    }

    /// Last step Δ.
    #[must_use]
    pub fn step(&self) -> &[f64] {
        &self.step
    }

    /// Residual of the last [trial](super::Iterate::evaluate_trial).
    #[must_use]
    pub fn trial_residual(&self) -> &[f64] {
        &self.trial_residual
    }

    /// Numbers of evaluations in this search.
    #[must_use]
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Takes the shape of `problem` and begins at the projected start.
    ///
    /// Values that are missing or not finite count as zero.
    pub(super) fn start_at(&mut self, problem: &mut dyn LeastSquares, start: &[f64]) {
        let (n, m) = (problem.variables(), problem.rows());
        self.step_scale.clear();
        self.step_scale.extend_from_slice(problem.step_scale());
        for vector in [
            &mut self.x,
            &mut self.gradient,
            &mut self.trial,
            &mut self.step,
            &mut self.best_x,
        ] {
            refill(vector, n, 0.0);
        }
        for vector in [&mut self.residual, &mut self.trial_residual] {
            refill(vector, m, 0.0);
        }
        if self.jacobian.shape() != (m, n) {
            self.jacobian = DMatrix::zeros(m, n);
        }
        vacate(&mut self.free, n);
        self.counts = Counts::default();
        self.flat_steps = 0;

        for (value, &given) in self.x.iter_mut().zip(start) {
            *value = if given.is_finite() { given } else { 0.0 };
        }
        problem.space().project(&mut self.x);
        self.cost = f64::INFINITY;
        if problem.space().is_of(n) {
            problem.residual(&self.x, &mut self.residual);
            self.counts.residuals += 1;
            self.cost = half_squared(&self.residual);
        }
        self.best_cost = self.cost;
        self.best_x.copy_from_slice(&self.x);
    }

    /// Evaluates the Jacobian at x, and from it the gradient, the largest column norm and the free variables.
    pub(super) fn differentiate(&mut self, problem: &mut dyn LeastSquares) {
        problem.jacobian(&self.x, &mut self.jacobian);
        self.counts.jacobians += 1;
        let residual = std::mem::take(&mut self.residual);
        self.compute_slope(&residual);
        self.residual = residual;
        self.list_free(problem);
    }

    /// Computes Jᵀr and the largest column norm from the Jacobian in memory.
    fn compute_slope(&mut self, residual: &[f64]) {
        let columns = self.jacobian.as_slice().chunks_exact(residual.len().max(1));
        let (mut squared, mut scales) = (0.0_f64, self.step_scale.iter());
        for (entry, column) in self.gradient.iter_mut().zip(columns) {
            *entry = dot(column, residual);
            let scale = scales.next().copied().unwrap_or(1.0);
            squared = squared.max(dot(column, column) * (scale * scale));
        }
        self.column_norm = squared.sqrt();
    }

    /// Evaluates only the gradient at x, and the free variables.
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

    /// Writes r(x) at any x to [`residual`](Self::residual).
    pub(crate) fn evaluate_at(&mut self, problem: &mut dyn LeastSquares, x: &[f64]) {
        problem.residual(x, &mut self.residual);
    }

    /// Gradient Jᵀr at any x with residual r, and the largest column norm of J there.
    pub(crate) fn slope_at(
        &mut self,
        problem: &mut dyn LeastSquares,
        x: &[f64],
        residual: &[f64],
    ) -> (&[f64], f64) {
        problem.jacobian(x, &mut self.jacobian);
        self.compute_slope(residual);
        (&self.gradient, self.column_norm)
    }

    /// Resizes the gradient and the Jacobian for a problem without a search.
    pub(crate) fn resize_derivatives(&mut self, rows: usize, variables: usize) {
        self.gradient.resize(variables, 0.0);
        if self.jacobian.shape() != (rows, variables) {
            self.jacobian = DMatrix::zeros(rows, variables);
        }
    }

    fn list_free(&mut self, problem: &dyn LeastSquares) {
        let space = problem.space();
        space.list_free(&self.x, &self.gradient, &mut self.free);
    }

    pub(super) fn projected_gradient_norm(&self, problem: &dyn LeastSquares) -> f64 {
        self.projected_step_norm(1.0, problem)
    }

    fn projected_step_norm(&self, curvature: f64, problem: &dyn LeastSquares) -> f64 {
        let space = problem.space();
        space.projected_gradient_norm(&self.x, &self.gradient, curvature)
    }

    /// s ‖proj(x − g/s²) − x‖∞ / ‖r‖ with s the largest column norm of J (MINPACK's test, Moré 1978, for bounds).
    ///
    /// It is the cosine between r and the effect of a free variable. The step g/s² has the size of x, so the test does
    /// not depend on the unit of r.
    pub(super) fn stationarity(&self, problem: &dyn LeastSquares) -> f64 {
        let length = (2.0 * self.cost).sqrt();
        if length == 0.0 || self.column_norm == 0.0 {
            return 0.0;
        }
        let scale = self.column_norm;
        self.projected_step_norm(scale * scale, problem) * scale / length
    }

    /// ‖Δ‖∞ of the last step.
    pub(super) fn step_norm(&self) -> f64 {
        largest(&self.step)
    }

    /// Returns true if the last step moves no variable by more than tolerance · max(1, |x|).
    pub(super) fn step_is_negligible(&self, tolerance: f64) -> bool {
        let pairs = self.step.iter().zip(&self.x);
        pairs
            .into_iter()
            .all(|(s, x)| s.abs() <= tolerance * x.abs().max(1.0))
    }
}

/// ½‖r‖².
pub(crate) fn half_squared(residual: &[f64]) -> f64 {
    0.5 * dot(residual, residual)
}
