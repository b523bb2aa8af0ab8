//! Finite differences of the exact gradient of a Lagrangian.

use std::ops::Range;

use nalgebra::DMatrix;

use super::descent_problem::DescentProblem;
use crate::problem::TaskSubset;
use crate::solver::LeastSquares;

/// Gradient Jᵀw. The weight w is the residual for the level's own rows and the multiplier for other rows.
#[derive(Clone, Debug)]
pub(super) struct Weighted<'a> {
    pub(super) share: TaskSubset,
    /// Multiplier of each row of the task subset.
    pub(super) multipliers: &'a [f64],
    /// Multiplier of each inequality of the task subset; empty if there is none.
    pub(super) edges: &'a [f64],
    /// Rows weighted by their residual.
    pub(super) own: Range<usize>,
}

/// Scratch memory of finite differences.
#[derive(Clone, Debug, Default)]
pub(super) struct SlopeDifferences {
    here: Vec<f64>,
    there: Vec<f64>,
    weights: Vec<f64>,
    jacobian: DMatrix<f64>,
    trial: Vec<f64>,
}

impl SlopeDifferences {
    /// Resizes for a number of variables and rows.
    pub(super) fn fit(&mut self, variables: usize, rows: usize) {
        for vector in [&mut self.here, &mut self.there, &mut self.trial] {
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
        of: &Weighted<'_>,
        x: &[f64],
        fixed: &[bool],
    ) -> &mut [f64] {
        descent.counts.residuals += 1;
        descent.counts.gradients += 1;
        let mut rows = descent.evaluate(of.share);
        rows.residual(x, &mut self.weights);
        for (row, (weight, multiplier)) in self.weights.iter_mut().zip(of.multipliers).enumerate() {
            if !of.own.contains(&row) {
                *weight = *multiplier;
            }
        }
        match of.edges.iter().all(|multiplier| *multiplier == 0.0) {
            true => rows.gradient(x, &self.weights, &mut self.there, &mut self.jacobian),
            false => rows.slope_of_all(x, &self.weights, of.edges, &mut self.there),
        }
        release(&mut self.there, fixed);
        &mut self.there
    }

    /// Passes the columns of the gradient's Jacobian at x, of variables that are not fixed, to `take`.
    pub(super) fn columns(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        of: &Weighted<'_>,
        x: &[f64],
        fixed: &[bool],
        mut take: impl FnMut(usize, &mut [f64]),
    ) {
        let space = descent.question.space();
        self.slope(descent, of, x, fixed);
        std::mem::swap(&mut self.here, &mut self.there);
        let mut trial = std::mem::take(&mut self.trial);
        trial.copy_from_slice(x);
        for j in (0..x.len()).filter(|&j| fixed.get(j) != Some(&true)) {
            let shift = f64::EPSILON.sqrt() * x[j].abs().max(1.0);
            let taken = space.integrate_one(x, j, shift, &mut trial);
            self.slope(descent, of, &trial, fixed);
            space.return_one(x, j, &mut trial);
            for (there, here) in self.there.iter_mut().zip(&self.here) {
                *there = (*there - here) / taken;
            }
            take(j, &mut self.there);
        }
        self.trial = trial;
    }

    /// Computes the gradient at x for derivatives [along](Self::along) directions.
    pub(super) fn stand(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        of: &Weighted<'_>,
        x: &[f64],
    ) {
        self.slope(descent, of, x, &[]);
        std::mem::swap(&mut self.here, &mut self.there);
    }

    /// Writes the derivative of the gradient along a unit direction. Needs the stored gradient at `x`, from the
    /// preceding method.
    pub(super) fn along(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        of: &Weighted<'_>,
        (x, direction): (&[f64], &[f64]),
        derivative: &mut [f64],
    ) {
        let mut trial = std::mem::take(&mut self.trial);
        let largest = x.iter().fold(1.0_f64, |most, value| most.max(value.abs()));
        let share = f64::EPSILON.sqrt() * largest;
        let space = descent.question.space();
        space.integrate_share(x, share, direction, &mut trial);
        self.slope(descent, of, &trial, &[]);
        for ((derivative, there), here) in derivative.iter_mut().zip(&self.there).zip(&self.here) {
            *derivative = (there - here) / share;
        }
        self.trial = trial;
    }
}

/// Sets the entries of fixed variables to zero.
pub(super) fn release(slope: &mut [f64], fixed: &[bool]) {
    for (slope, fixed) in slope.iter_mut().zip(fixed) {
        if *fixed {
            *slope = 0.0;
        }
    }
}
