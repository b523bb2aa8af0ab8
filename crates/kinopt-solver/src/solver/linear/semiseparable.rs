//! Semiseparable second-order part of the Hessian of a chain: products, recovery from probes, and damped solves.
//!
//! In a kinematic tree the derivative of a column of J by an earlier variable is linear in that column. Σ r_k ∇²r_k thus
//! has the entries S_ij = u_i · J_j for i ≤ j, with a vector u_i per variable and columns J_j. Such a matrix is
//! semiseparable: products and factorisations take O(n m²) operations for m rows and n variables (Vandebril, Van Barel
//! & Mastronardi 2008, "Matrix Computations and Semiseparable Matrices", volume 1, chapter 4).

use std::cmp::Ordering;

use nalgebra::DMatrix;

use super::cholesky;
use super::curved_normal::CurvedModel;
use super::dense::{add_scaled, dot};
use kinopt_kinematics::buffer::{refill, vacate};

/// Smallest pivot, relative to the largest diagonal entry.
const NEGLIGIBLE: f64 = 1e-14;

/// Damping of the equations for a generator, relative to their trace plus 1, the part of one long column.
///
/// Directions without a lever stay zero.
const RIDGE: f64 = 1e-8;

/// Matrix S with the entries u_i · J_j for i ≤ j.
#[derive(Clone, Copy)]
pub(in crate::solver) struct Semiseparable<'a> {
    pub(in crate::solver) jacobian: &'a DMatrix<f64>,
    /// u, one vector of m numbers per variable.
    pub(in crate::solver) generators: &'a [f64],
}

impl<'a> Semiseparable<'a> {
    /// Rows, column and generator of each variable, in order.
    fn pairs(self) -> impl DoubleEndedIterator<Item = (&'a [f64], &'a [f64])> + ExactSizeIterator {
        let rows = self.jacobian.nrows().max(1);
        let columns = self.jacobian.as_slice().chunks_exact(rows);
        columns.zip(self.generators.chunks_exact(rows))
    }

    /// xᵀ S x; `sum` is a buffer for m numbers.
    pub(in crate::solver) fn quadratic(self, x: &[f64], sum: &mut Vec<f64>) -> f64 {
        refill(sum, self.jacobian.nrows(), 0.0);
        let (mut off_diagonal, mut diagonal) = (0.0, 0.0);
        for ((column, generator), &x) in self.pairs().zip(x).filter(|(_, x)| **x != 0.0) {
            off_diagonal += x * dot(column, sum);
            diagonal += x * x * dot(generator, column);
            add_scaled(sum, x, generator);
        }
        2.0 * off_diagonal + diagonal
    }

    /// Adds S x to `product`; `sum` is a buffer for m numbers.
    pub(in crate::solver) fn add_product(self, x: &[f64], product: &mut [f64], sum: &mut Vec<f64>) {
        refill(sum, self.jacobian.nrows(), 0.0);
        for (((column, generator), &x), entry) in self.pairs().zip(x).zip(product.iter_mut()) {
            *entry += dot(column, sum);
            if x != 0.0 {
                add_scaled(sum, x, generator);
            }
        }
        refill(sum, self.jacobian.nrows(), 0.0);
        let pairs = self.pairs().zip(x).zip(product.iter_mut());
        for (((column, generator), &x), entry) in pairs.rev() {
            if x != 0.0 {
                add_scaled(sum, x, column);
            }
            *entry += dot(generator, sum);
        }
    }
}

/// Buffers for the recovery of generators from products with S, and for solves.
#[derive(Clone, Debug, Default)]
pub(in crate::solver) struct SemiseparableNormal {
    /// m × m, row by row.
    matrix: Vec<f64>,
    factor: Vec<f64>,
    pivot_column: Vec<f64>,
    /// Column of T or of the right side, m numbers.
    side: Vec<f64>,
    sum: Vec<f64>,
    /// W, one vector of m numbers per moving variable.
    lower: Vec<f64>,
    pivots: Vec<f64>,
    product: Vec<f64>,
}

impl SemiseparableNormal {
    /// Reserves memory for every problem of this shape.
    pub(in crate::solver) fn reserve(&mut self, rows: usize, columns: usize) {
        for (vector, capacity) in [
            (&mut self.matrix, rows * rows),
            (&mut self.factor, rows * rows),
            (&mut self.pivot_column, 2 * rows),
            (&mut self.side, rows),
            (&mut self.sum, rows),
            (&mut self.lower, rows * columns),
            (&mut self.pivots, columns),
            (&mut self.product, columns),
        ] {
            vacate(vector, capacity);
        }
    }

    /// Replaces products with S by the generators of S, free variable by free variable.
    ///
    /// Entry k of variable i in `products` is that of S qᵏ, for the m probes qᵏ with qᵏ_j = weight_j J_kj. The equations
    /// for u_i have the matrix Σ weight_j J_j J_jᵀ over all j ≥ i.
    pub(in crate::solver) fn recover(
        &mut self,
        jacobian: &DMatrix<f64>,
        weights: &[f64],
        free: &[usize],
        products: &mut [f64],
    ) {
        let rows = jacobian.nrows().max(1);
        let entries = jacobian.as_slice();
        refill(&mut self.matrix, rows * rows, 0.0);
        for &j in free.iter().filter(|j| weights[**j] != 0.0) {
            let column = &entries[j * rows..(j + 1) * rows];
            add_outer(&mut self.matrix, weights[j], column, column);
        }
        // Σ qᵏ_j u_j over all earlier j, row by row.
        let mut earlier = std::mem::take(&mut self.lower);
        refill(&mut earlier, rows * rows, 0.0);
        for &j in free {
            let (column, weight) = (&entries[j * rows..(j + 1) * rows], weights[j]);
            let products = &mut products[j * rows..(j + 1) * rows];
            for (entry, row) in products.iter_mut().zip(earlier.chunks_exact(rows)) {
                *entry -= dot(row, column);
            }
            self.matrix.clone_into(&mut self.factor);
            let trace: f64 = (0..rows).map(|k| self.matrix[k * rows + k]).sum();
            for k in 0..rows {
                self.factor[k * rows + k] += RIDGE * (trace + 1.0);
            }
            cholesky::factorise(&mut self.factor, rows, &mut self.pivot_column);
            cholesky::substitute(&self.factor, rows, products);
            if weight != 0.0 {
                add_outer(&mut self.matrix, -weight, column, column);
                add_outer(&mut earlier, weight, column, products);
            }
        }
        self.lower = earlier;
    }

    /// Writes the solution over the moving variables of (JᵀJ + S + λ/scale²) Δ = −g − (JᵀJ + S) `stopped`.
    ///
    /// Returns false if the matrix is not positive definite. The matrix has the entries (J_i + u_i) · J_j for i ≤ j, and
    /// is factorised from the first variable to the last.
    pub(super) fn solve(
        &mut self,
        model: &CurvedModel<'_>,
        s: Semiseparable<'_>,
        damping: f64,
        (moving, stopped): (&[usize], &[f64]),
        unknown: &mut Vec<f64>,
    ) -> bool {
        let rows = model.jacobian.nrows();
        let entries = model.jacobian.as_slice();
        let column = |j: usize| &entries[j * rows..(j + 1) * rows];
        let generator = |j: usize| &s.generators[j * rows..(j + 1) * rows];

        refill(&mut self.product, stopped.len(), 0.0);
        if stopped.iter().any(|moved| *moved != 0.0) {
            s.add_product(stopped, &mut self.product, &mut self.sum);
        }
        refill(&mut self.side, rows, 0.0);
        for (j, &moved) in stopped
            .iter()
            .enumerate()
            .filter(|(_, moved)| **moved != 0.0)
        {
            add_scaled(&mut self.side, moved, column(j));
        }
        unknown.clear();
        unknown.extend(
            moving
                .iter()
                .map(|&j| -model.gradient[j] - dot(column(j), &self.side) - self.product[j]),
        );

        // L = I + tril(J Wᵀ), with T = Σ D_j W_j W_jᵀ over the variables so far.
        refill(&mut self.matrix, rows * rows, 0.0);
        refill(&mut self.sum, rows, 0.0);
        self.lower.clear();
        self.pivots.clear();
        let mut largest = 0.0_f64;
        for (&j, value) in moving.iter().zip(unknown.iter_mut()) {
            let (jacobian_column, scale) = (column(j), model.scale.get(j).copied().unwrap_or(1.0));
            let diagonal = dot(jacobian_column, jacobian_column)
                + dot(generator(j), jacobian_column)
                + damping / (scale * scale);
            largest = largest.max(diagonal);
            self.side.clear();
            let products = self
                .matrix
                .chunks_exact(rows)
                .map(|row| dot(row, jacobian_column));
            self.side.extend(products);
            let pivot = diagonal - dot(&self.side, jacobian_column);
            // True for NaN.
            let is_lost = pivot.partial_cmp(&(NEGLIGIBLE * largest)) != Some(Ordering::Greater);
            if is_lost {
                return false;
            }
            let from = self.lower.len();
            let terms = jacobian_column.iter().zip(generator(j)).zip(&self.side);
            self.lower
                .extend(terms.map(|((entry, generator), side)| (entry + generator - side) / pivot));
            let w = &self.lower[from..];
            add_outer(&mut self.matrix, pivot, w, w);
            *value -= dot(jacobian_column, &self.sum);
            add_scaled(&mut self.sum, *value, w);
            self.pivots.push(pivot);
        }
        refill(&mut self.sum, rows, 0.0);
        for (k, &j) in moving.iter().enumerate().rev() {
            let w = &self.lower[k * rows..(k + 1) * rows];
            unknown[k] = unknown[k] / self.pivots[k] - dot(w, &self.sum);
            add_scaled(&mut self.sum, unknown[k], column(j));
        }
        true
    }
}

/// Adds factor · a bᵀ to a matrix given row by row.
fn add_outer(matrix: &mut [f64], factor: f64, a: &[f64], b: &[f64]) {
    for (row, a) in matrix.chunks_exact_mut(b.len().max(1)).zip(a) {
        add_scaled(row, factor * a, b);
    }
}
