//! Damped normal equations with a second-order part, solved within bounds.

use nalgebra::DMatrix;

use super::cholesky;
use super::dense::{add_scaled, dot};
use super::inner_products::InnerProducts;
use super::semiseparable::{Semiseparable, SemiseparableNormal};
use crate::solver::ConfigurationSpace;
use kinopt_kinematics::buffer::{refill, vacate};

/// Second-order part S of the Hessian.
#[derive(Clone, Copy)]
pub(in crate::solver) enum SecondOrder<'a> {
    /// S, n × n, row by row.
    Dense(&'a [f64]),
    /// S by its generators, m numbers per variable, see [`Semiseparable`].
    Semiseparable(&'a [f64]),
}

/// Quadratic model gᵀΔ + ½ Δᵀ(JᵀJ + S + λI)Δ over the free variables.
pub(in crate::solver) struct CurvedModel<'a> {
    pub(in crate::solver) jacobian: &'a DMatrix<f64>,
    pub(in crate::solver) curvature: SecondOrder<'a>,
    pub(in crate::solver) gradient: &'a [f64],
    pub(in crate::solver) free: &'a [usize],
    /// Units of the steps for λ, by variable; empty if all are 1.
    pub(in crate::solver) scale: &'a [f64],
    pub(in crate::solver) x: &'a [f64],
    pub(in crate::solver) space: ConfigurationSpace<'a>,
}

/// Workspace for the minimisation of a [`CurvedModel`].
#[derive(Clone, Debug, Default)]
pub(in crate::solver) struct CurvedNormal {
    factor: Vec<f64>,
    pivot_column: Vec<f64>,
    unknown: Vec<f64>,
    /// Free variables that no bound has stopped yet.
    moving: Vec<usize>,
    /// J Δ of the variables that a bound has stopped.
    stopped_effect: Vec<f64>,
    products: InnerProducts,
    pub(in crate::solver) semiseparable: SemiseparableNormal,
}

impl CurvedNormal {
    /// Reserves memory for every problem of this shape, whose S is semiseparable or dense.
    pub(in crate::solver) fn reserve(&mut self, rows: usize, columns: usize, separable: bool) {
        match separable {
            true => self.semiseparable.reserve(rows, columns),
            false => vacate(&mut self.factor, columns * columns),
        }
        for (vector, capacity) in [
            (&mut self.pivot_column, 2 * columns),
            (&mut self.unknown, columns),
            (&mut self.stopped_effect, rows),
        ] {
            vacate(vector, capacity);
        }
        vacate(&mut self.moving, columns);
        self.products.reserve(columns);
    }

    /// Writes the step Δ. Returns false if a matrix is not positive definite.
    ///
    /// A variable that meets a bound stops there, and the rest is solved again. With curvature, a step that is clamped
    /// afterwards usually raises the cost.
    pub(in crate::solver) fn minimise(
        &mut self,
        model: &CurvedModel<'_>,
        damping: f64,
        step: &mut [f64],
    ) -> bool {
        step.fill(0.0);
        model.free.clone_into(&mut self.moving);
        loop {
            let before = self.moving.len();
            let solved = match model.curvature {
                SecondOrder::Dense(matrix) => self.solve(model, matrix, damping, step),
                SecondOrder::Semiseparable(generators) => {
                    let s = Semiseparable {
                        jacobian: model.jacobian,
                        generators,
                    };
                    let variables = (self.moving.as_slice(), &*step);
                    self.semiseparable
                        .solve(model, s, damping, variables, &mut self.unknown)
                }
            };
            if !solved {
                return false;
            }
            let unknown = &self.unknown;
            let mut solved = unknown.iter();
            self.moving.retain(|&j| {
                let full_step = *solved.next().unwrap_or(&0.0);
                let stopped = model.space.stopped_step(model.x, j, full_step);
                step[j] = stopped.unwrap_or(0.0);
                stopped.is_none()
            });
            if self.moving.len() == before {
                for (&j, &value) in self.moving.iter().zip(unknown) {
                    step[j] = value;
                }
                return true;
            }
        }
    }

    /// Solves for the moving variables, with the displacement of the stopped ones.
    fn solve(
        &mut self,
        model: &CurvedModel<'_>,
        curvature: &[f64],
        damping: f64,
        stopped: &[f64],
    ) -> bool {
        let (order, n) = (self.moving.len(), stopped.len());
        let rows = model.jacobian.nrows();
        let entries = model.jacobian.as_slice();
        let column = |j: usize| &entries[j * rows..(j + 1) * rows];
        let curvature_row = |j: usize| &curvature[j * n..(j + 1) * n];

        refill(&mut self.factor, order * order, 0.0);
        let (moving, factor) = (&self.moving, &mut self.factor);
        self.products.fill(model.jacobian, moving, factor);
        for (a, &i) in self.moving.iter().enumerate() {
            for (b, &j) in self.moving.iter().enumerate().take(a + 1) {
                self.factor[a * order + b] += curvature_row(i)[j];
            }
            let scale = model.scale.get(i).copied().unwrap_or(1.0);
            self.factor[a * order + a] += damping / (scale * scale);
        }
        if !cholesky::factorise(&mut self.factor, order, &mut self.pivot_column) {
            return false;
        }

        refill(&mut self.stopped_effect, rows, 0.0);
        for (j, &moved) in stopped.iter().enumerate() {
            if moved != 0.0 {
                add_scaled(&mut self.stopped_effect, moved, column(j));
            }
        }
        let (effect, gradient) = (&self.stopped_effect, model.gradient);
        self.unknown.clear();
        let slopes = self.moving.iter();
        self.unknown.extend(
            slopes.map(|&j| -gradient[j] - dot(column(j), effect) - dot(curvature_row(j), stopped)),
        );
        cholesky::substitute(&self.factor, order, &mut self.unknown);
        true
    }
}

/// xᵀ S x for a symmetric matrix S given row by row.
pub(in crate::solver) fn quadratic(matrix: &[f64], x: &[f64]) -> f64 {
    let rows = matrix.chunks_exact(x.len().max(1));
    rows.zip(x).map(|(row, &x_i)| x_i * dot(row, x)).sum()
}

/// Writes S x for a symmetric matrix S given row by row.
pub(in crate::solver) fn multiply_symmetric(matrix: &[f64], x: &[f64], product: &mut [f64]) {
    let rows = matrix.chunks_exact(x.len().max(1));
    for (entry, row) in product.iter_mut().zip(rows) {
        *entry = dot(row, x);
    }
}
