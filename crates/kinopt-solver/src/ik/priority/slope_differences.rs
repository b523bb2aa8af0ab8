//! Finite differences of the exact gradient of a Lagrangian.

use std::ops::Range;

use nalgebra::DMatrix;

use super::descent_problem::DescentProblem;
use crate::problem::TaskSubset;
use crate::solver::LeastSquares;

/// Gradient Jᵀw. The weight w is the residual for the level's own rows and the multiplier for other rows.
#[derive(Clone, Debug)]
pub(super) struct WeightedGradient<'a> {
    pub(super) subset: TaskSubset,
    /// Multiplier of each row of the task subset.
    pub(super) multipliers: &'a [f64],
    /// Multiplier of each inequality of the task subset; empty if there is none.
    pub(super) inequality_multipliers: &'a [f64],
    /// Rows weighted by their residual.
    pub(super) residual_rows: Range<usize>,
}

/// Scratch memory of finite differences.
#[derive(Clone, Debug, Default)]
pub(super) struct SlopeDifferences {
    slope_at_x: Vec<f64>,
    trial_slope: Vec<f64>,
    weights: Vec<f64>,
    jacobian: DMatrix<f64>,
    trial: Vec<f64>,
}

impl SlopeDifferences {
    /// Resizes for a number of variables and rows.
    pub(super) fn fit(&mut self, variables: usize, rows: usize) {
        for vector in [&mut self.slope_at_x, &mut self.trial_slope, &mut self.trial] {
            vector.resize(variables, 0.0);
        }
        self.weights.resize(rows, 0.0);
        if self.jacobian.shape() != (rows, variables) {
            self.jacobian = DMatrix::zeros(rows, variables);
        }
    }

    /// Computes Jᵀw at x, with zeros for fixed variables. An empty `fixed` fixes none.
    pub(super) fn slope(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        weighted: &WeightedGradient<'_>,
        x: &[f64],
        fixed: &[bool],
    ) -> &mut [f64] {
        descent.counts.residuals += 1;
        descent.counts.gradients += 1;
        let mut evaluation = descent.evaluate(weighted.subset);
        evaluation.residual(x, &mut self.weights);
        for (row, (weight, multiplier)) in self
            .weights
            .iter_mut()
            .zip(weighted.multipliers)
            .enumerate()
        {
            if !weighted.residual_rows.contains(&row) {
                *weight = *multiplier;
            }
        }
        match weighted
            .inequality_multipliers
            .iter()
            .all(|multiplier| *multiplier == 0.0)
        {
            true => {
                evaluation.gradient(x, &self.weights, &mut self.trial_slope, &mut self.jacobian)
            }
            false => evaluation.slope_of_all(
                x,
                &self.weights,
                weighted.inequality_multipliers,
                &mut self.trial_slope,
            ),
        }
        clear_fixed(&mut self.trial_slope, fixed);
        &mut self.trial_slope
    }

    /// Passes the columns of the gradient's Jacobian at x, of variables that are not fixed, to `receive`.
    pub(super) fn columns(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        weighted: &WeightedGradient<'_>,
        x: &[f64],
        fixed: &[bool],
        mut receive: impl FnMut(usize, &mut [f64]),
    ) {
        let space = descent.instance.space();
        self.slope(descent, weighted, x, fixed);
        std::mem::swap(&mut self.slope_at_x, &mut self.trial_slope);
        let mut trial = std::mem::take(&mut self.trial);
        trial.copy_from_slice(x);
        for j in (0..x.len()).filter(|&j| fixed.get(j) != Some(&true)) {
            let shift = f64::EPSILON.sqrt() * x[j].abs().max(1.0);
            let step = space.integrate_one(x, j, shift, &mut trial);
            self.slope(descent, weighted, &trial, fixed);
            space.return_one(x, j, &mut trial);
            for (trial_slope, slope_at_x) in self.trial_slope.iter_mut().zip(&self.slope_at_x) {
                *trial_slope = (*trial_slope - slope_at_x) / step;
            }
            receive(j, &mut self.trial_slope);
        }
        self.trial = trial;
    }

    /// Computes the gradient at x for derivatives [along](Self::derivative_along) directions.
    pub(super) fn set_base_point(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        weighted: &WeightedGradient<'_>,
        x: &[f64],
    ) {
        self.slope(descent, weighted, x, &[]);
        std::mem::swap(&mut self.slope_at_x, &mut self.trial_slope);
    }

    /// Writes the derivative of the gradient along a unit direction. Needs the stored gradient at `x`, from the
    /// preceding method.
    pub(super) fn derivative_along(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        weighted: &WeightedGradient<'_>,
        (x, direction): (&[f64], &[f64]),
        derivative: &mut [f64],
    ) {
        let mut trial = std::mem::take(&mut self.trial);
        let max_value = x.iter().fold(1.0_f64, |max, value| max.max(value.abs()));
        let shift = f64::EPSILON.sqrt() * max_value;
        let space = descent.instance.space();
        space.integrate_share(x, shift, direction, &mut trial);
        self.slope(descent, weighted, &trial, &[]);
        for ((derivative, trial_slope), slope_at_x) in derivative
            .iter_mut()
            .zip(&self.trial_slope)
            .zip(&self.slope_at_x)
        {
            *derivative = (trial_slope - slope_at_x) / shift;
        }
        self.trial = trial;
    }
}

/// Sets the entries of fixed variables to zero.
pub(super) fn clear_fixed(slope: &mut [f64], fixed: &[bool]) {
    for (slope, fixed) in slope.iter_mut().zip(fixed) {
        if *fixed {
            *slope = 0.0;
        }
    }
}
