//! Evaluation of a solution: residual, Jacobian, directions and curvature.

use nalgebra::DMatrix;

use super::directions::{Bound, Directions, list_bounds};
use super::rows::Roles;
use crate::problem::{Evaluation, ProblemInstance, Scratch, TangentPoint, TaskSubset};
use crate::solver::LeastSquares;
use kinopt_kinematics::buffer::refill;

/// Step of central differences of gradients, relative to a radian or the reach; truncation and rounding errors are then
/// both near 1e-11.
const DIFFERENCE_STEP: f64 = 1e-5;

/// Problem instance and the memory to evaluate it.
pub(super) struct Evaluator<'q, 's> {
    pub(super) instance: ProblemInstance<'q>,
    pub(super) scratch: &'s mut Scratch,
}

impl Evaluator<'_, '_> {
    pub(super) fn evaluation(&mut self) -> Evaluation<'_> {
        Evaluation::of(TaskSubset::All, self.instance, self.scratch)
    }
}

/// Solution point, with memory to evaluate it and its neighbourhood.
#[derive(Clone, Debug, Default)]
pub(super) struct KktPoint {
    pub(super) x: Vec<f64>,
    /// Configuration of x.
    q: Vec<f64>,
    /// Weighted residual of all tasks.
    pub(super) r: Vec<f64>,
    /// Derivative of the residual by the variables.
    pub(super) jacobian: DMatrix<f64>,
    pub(super) roles: Roles,
    pub(super) bounds: Vec<Bound>,
    pub(super) directions: Directions,
    /// Derivative of the residual along the directions, column by column.
    pub(super) reduced_jacobian: Vec<f64>,
    /// Weight of each row in the Lagrangian gradient: its residual if minimised, its multiplier if constrained.
    pub(super) row_weights: Vec<f64>,
    shifted_x: Vec<f64>,
    slope: Vec<f64>,
    reduced: Vec<f64>,
}

impl KktPoint {
    /// Evaluates a configuration, which must have the problem's length and be finite.
    pub(super) fn evaluate(&mut self, evaluator: &mut Evaluator<'_, '_>, q: &[f64]) {
        let instance = evaluator.instance;
        let problem = instance.problem();
        let (n, m) = (problem.variables(), problem.rows());
        for (vector, len) in [
            (&mut self.x, n),
            (&mut self.r, m),
            (&mut self.row_weights, m),
            (&mut self.shifted_x, n),
            (&mut self.slope, n),
        ] {
            refill(vector, len, 0.0);
        }
        if self.jacobian.shape() != (m, n) {
            self.jacobian = DMatrix::zeros(m, n);
        }
        problem.parameters().gather(q, &mut self.x);
        instance.space().project(&mut self.x);
        list_bounds(instance, &mut self.x, &mut self.bounds);
        let mut evaluation = evaluator.evaluation();
        evaluation.residual(&self.x, &mut self.r);
        evaluation.analytic_jacobian(&self.x, &mut self.jacobian);
        self.roles.assign(instance, &self.r);
        evaluator.scratch.q().clone_into(&mut self.q);
    }

    /// Returns the point for conversions between variables and the model's velocity.
    pub(super) fn tangent_point<'a>(&'a self, instance: ProblemInstance<'a>) -> TangentPoint<'a> {
        TangentPoint {
            map: instance.parameters(),
            x: &self.x,
            q: &self.q,
        }
    }

    pub(super) fn is_finite(&self) -> bool {
        let mut numbers = self.r.iter().chain(self.jacobian.as_slice());
        numbers.all(|value| value.is_finite())
    }

    /// Computes the directions that the active bounds leave free.
    pub(super) fn compute_directions(&mut self, instance: ProblemInstance<'_>) {
        let tangent_point = TangentPoint {
            map: instance.parameters(),
            x: &self.x,
            q: &self.q,
        };
        self.directions
            .compute(instance, &tangent_point, &self.bounds);
        let (rows, entries) = (self.jacobian.nrows(), self.jacobian.as_slice());
        self.directions
            .reduce(rows, entries, &mut self.reduced_jacobian);
    }

    /// Returns the step of a difference along a direction.
    pub(super) fn difference_step(&self, instance: ProblemInstance<'_>, y: &[f64]) -> f64 {
        let length = y.iter().map(|y| y * y).sum::<f64>().sqrt();
        let problem = instance.problem();
        let has_prismatic = problem.names().variable_is_angle.contains(&false);
        let reach = problem.reach();
        let unit = if has_prismatic && reach > 0.0 {
            reach.min(1.0)
        } else {
            1.0
        };
        DIFFERENCE_STEP * unit / length
    }

    /// Writes and returns x moved along the directions.
    pub(super) fn shift_x(&mut self, y: &[f64], scale: f64) -> &[f64] {
        self.shifted_x.copy_from_slice(&self.x);
        self.directions.expand(y, scale, &mut self.shifted_x);
        &self.shifted_x
    }

    /// Last result of [`shift_x`](Self::shift_x).
    pub(super) fn shifted(&self) -> &[f64] {
        &self.shifted_x
    }

    /// Adds the curvature of the rows along a direction, Σ cᵢ ∇²rᵢ y, reduced to the directions.
    pub(super) fn add_curvature(
        &mut self,
        evaluator: &mut Evaluator<'_, '_>,
        y: &[f64],
        curvature: &mut [f64],
    ) {
        let instance = evaluator.instance;
        let shift = self.difference_step(instance, y);
        if !shift.is_finite() {
            return;
        }
        for step in [shift, -shift] {
            self.shift_x(y, step);
            let mut evaluation = evaluator.evaluation();
            evaluation.reverse_gradient(&self.shifted_x, &self.row_weights, &mut self.slope);
            self.directions.reduce(1, &self.slope, &mut self.reduced);
            for (curvature, slope) in curvature.iter_mut().zip(&self.reduced) {
                *curvature += slope / (2.0 * step);
            }
        }
    }

    /// Writes Σ cᵢ ∇rᵢ by the variables, from the stored Jacobian.
    pub(super) fn slope(&self, slope: &mut [f64]) {
        let rows = self.jacobian.nrows();
        let columns = self.jacobian.as_slice().chunks_exact(rows.max(1));
        for (slope, column) in slope.iter_mut().zip(columns) {
            *slope = column
                .iter()
                .zip(&self.row_weights)
                .map(|(j, c)| j * c)
                .sum();
        }
    }

    /// Returns the largest Σ |cᵢ ∇rᵢ| of a variable, the scale of the terms that cancel in the gradient.
    pub(super) fn max_slope_terms(&self) -> f64 {
        let rows = self.jacobian.nrows();
        let columns = self.jacobian.as_slice().chunks_exact(rows.max(1));
        let sums = columns.map(|column| {
            let terms = column.iter().zip(&self.row_weights);
            terms.map(|(j, c)| (j * c).abs()).sum()
        });
        sums.fold(0.0, f64::max)
    }

    /// Returns the norm of the longest column of the Jacobian.
    pub(super) fn max_column_norm(&self) -> f64 {
        let rows = self.jacobian.nrows();
        let columns = self.jacobian.as_slice().chunks_exact(rows.max(1));
        let squares = columns.map(|column| column.iter().map(|j| j * j).sum::<f64>());
        squares.fold(0.0, f64::max).sqrt()
    }

    /// Returns the entries of one row along the directions.
    pub(super) fn row(&self, row: usize) -> impl Iterator<Item = f64> + '_ {
        let rows = self.jacobian.nrows();
        (0..self.directions.len()).map(move |k| self.reduced_jacobian[k * rows + row])
    }
}
