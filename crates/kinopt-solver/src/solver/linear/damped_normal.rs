//! Damped normal equations, in the smaller of their primal and dual form.

use nalgebra::DMatrix;

use super::cholesky;
use super::dense::{add_scaled, add_two_scaled, dot};
use super::inner_products::InnerProducts;
use crate::solver::SolverState;
use kinopt_kinematics::buffer::{refill, vacate};

/// Solves (J_FᵀJ_F + λI) Δ = −J_Fᵀ r over the free columns F.
///
/// With fewer rows than free columns it solves (J_F J_Fᵀ + λI) y = −r, Δ = J_Fᵀ y, with the same Δ.
#[derive(Clone, Debug, Default)]
pub(in crate::solver) struct DampedNormal {
    /// Lower triangle of J_FᵀJ_F or J_F J_Fᵀ, row by row.
    gram: Vec<f64>,
    gram_is_fresh: bool,
    /// J S, if variables have scales.
    scaled: DMatrix<f64>,
    products: InnerProducts,
    factor: Vec<f64>,
    /// Two columns of the factor, in sequence.
    pivot_column: Vec<f64>,
    unknown: Vec<f64>,
}

impl DampedNormal {
    /// Reserves memory for every problem of this shape.
    pub(in crate::solver) fn reserve(&mut self, rows: usize, columns: usize) {
        let order = rows.min(columns);
        for (vector, capacity) in [
            (&mut self.gram, order * order),
            (&mut self.factor, order * order),
            (&mut self.pivot_column, 2 * order),
            (&mut self.unknown, order),
        ] {
            vacate(vector, capacity);
        }
        self.products.reserve(columns);
        self.gram_is_fresh = false;
    }

    /// Marks the Gram matrix as outdated, after a change of the Jacobian or the free set.
    pub(in crate::solver) fn forget(&mut self) {
        self.gram_is_fresh = false;
    }

    /// Writes the damped step over the free variables at the current point of a search.
    pub(in crate::solver) fn step(&mut self, at: &mut SolverState, damping: f64) {
        at.step.fill(0.0);
        if !at.step_scale.is_empty() {
            return self.scaled_step(at, damping);
        }
        self.factorise(&at.jacobian, &at.free, damping);
        self.solve(&at.jacobian, &at.free, &at.residual, &mut at.step);
    }

    /// The same with a damping by the scales of the variables: J S instead of J, and Δ = S Δ'.
    fn scaled_step(&mut self, at: &mut SolverState, damping: f64) {
        let mut scaled = std::mem::replace(&mut self.scaled, DMatrix::zeros(0, 0));
        if !self.gram_is_fresh || scaled.shape() != at.jacobian.shape() {
            scaled.clone_from(&at.jacobian);
            for (mut column, scale) in scaled.column_iter_mut().zip(&at.step_scale) {
                column *= *scale;
            }
        }
        self.factorise(&scaled, &at.free, damping);
        self.solve(&scaled, &at.free, &at.residual, &mut at.step);
        for (step, scale) in at.step.iter_mut().zip(&at.step_scale) {
            *step *= scale;
        }
        self.scaled = scaled;
    }

    /// Factorises the damped system over the free columns.
    fn factorise(&mut self, jacobian: &DMatrix<f64>, free: &[usize], damping: f64) {
        let rows = jacobian.nrows();
        let order = rows.min(free.len());
        if !self.gram_is_fresh {
            refill(&mut self.gram, order * order, 0.0);
            if rows < free.len() {
                self.add_outer_products(jacobian, free, order);
            } else {
                self.products.fill(jacobian, free, &mut self.gram);
            }
            self.gram_is_fresh = true;
        }
        self.gram.clone_into(&mut self.factor);
        for k in 0..order {
            self.factor[k * order + k] += damping;
        }
        cholesky::factorise(&mut self.factor, order, &mut self.pivot_column);
    }

    /// Writes Δ for `residual` to the free variables of `step`.
    ///
    /// Requires [`factorise`](Self::factorise) with the same Jacobian and free columns.
    fn solve(
        &mut self,
        jacobian: &DMatrix<f64>,
        free: &[usize],
        residual: &[f64],
        step: &mut [f64],
    ) {
        let rows = jacobian.nrows();
        let entries = jacobian.as_slice();
        let column = |j: usize| &entries[j * rows..(j + 1) * rows];
        self.unknown.clear();
        if rows < free.len() {
            self.unknown.extend(residual.iter().map(|r| -r));
            cholesky::substitute(&self.factor, rows, &mut self.unknown);
            for &j in free {
                step[j] = dot(column(j), &self.unknown);
            }
        } else {
            let slopes = free.iter().map(|&j| -dot(column(j), residual));
            self.unknown.extend(slopes);
            cholesky::substitute(&self.factor, free.len(), &mut self.unknown);
            for (&j, &value) in free.iter().zip(&self.unknown) {
                step[j] = value;
            }
        }
    }

    /// Adds J_F J_Fᵀ: one outer product per column, between its first and last nonzero entry.
    ///
    /// A joint moves few of the frames. Adjacent joints of a limb move the same ones and go two at a time.
    fn add_outer_products(&mut self, jacobian: &DMatrix<f64>, free: &[usize], order: usize) {
        let entries = jacobian.as_slice();
        let column = |j: usize| &entries[j * order..(j + 1) * order];
        let mut waiting: Option<(usize, usize, &[f64])> = None;
        for &j in free {
            let column = column(j);
            let Some(first) = column.iter().position(|&v| v != 0.0) else {
                continue;
            };
            let last = column.iter().rposition(|&v| v != 0.0).unwrap_or(first);
            match waiting.take() {
                Some((start, end, other)) if (start, end) == (first, last) => {
                    for a in first..=last {
                        let row = &mut self.gram[a * order + first..=a * order + a];
                        let both = [&other[first..=a], &column[first..=a]];
                        add_two_scaled(row, [other[a], column[a]], both);
                    }
                }
                other => {
                    self.add_outer_product(other, order);
                    waiting = Some((first, last, column));
                }
            }
        }
        self.add_outer_product(waiting, order);
    }

    fn add_outer_product(&mut self, column: Option<(usize, usize, &[f64])>, order: usize) {
        let Some((first, last, column)) = column else {
            return;
        };
        for a in first..=last {
            let row = &mut self.gram[a * order + first..=a * order + a];
            add_scaled(row, column[a], &column[first..=a]);
        }
    }
}
