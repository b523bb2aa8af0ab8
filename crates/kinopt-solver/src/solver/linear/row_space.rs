//! Row space of a matrix of any rank: rank, null space, and pseudoinverse.

use std::ops::Range;

use super::cholesky;
use super::dense::{add_scaled, dot};
use super::householder::HouseholderQr;
use kinopt_kinematics::buffer::refill;

/// Factorisation Aᵀ P = Q [R; 0] with pivoting (Golub & Van Loan 2013, section 5.4.7).
///
/// The first columns of Q span A's rows, and its other columns the null space. If rows depend on each other, Rᵀ = Z U
/// is computed, too. If they are clearly independent and the null space is not needed, A Aᵀ = L Lᵀ suffices, at a
/// quarter of the cost. A step of refinement then restores the digits that it loses (Björck 1996, "Numerical Methods
/// for Least Squares Problems", section 6.6.5).
#[derive(Clone, Debug, Default)]
#[doc(hidden)]
pub struct RowSpace {
    columns: usize,
    rows: usize,
    q_r: HouseholderQr,
    z_u: HouseholderQr,
    /// Row of the matrix at each position of the pivoted one.
    pivots: Vec<usize>,
    /// Remaining squared length of each row.
    remaining: Vec<f64>,
    r_transposed: Vec<f64>,
    side: Vec<f64>,
    /// True if the factorisation is that of A Aᵀ.
    is_gram: bool,
    refinements: usize,
    matrix: Vec<f64>,
    /// First row of each column's nonzero part, and one past its last.
    spans: Vec<(usize, usize)>,
    gram: Vec<f64>,
    pivot_column: Vec<f64>,
    remainder: Vec<f64>,
}

/// Smallest remaining squared length of clearly independent rows, relative to the longest row.
const CLEARLY_INDEPENDENT: f64 = 1e-6;
/// Smallest remaining squared length without a loss of relevant digits, relative to the longest row.
const WELL_CONDITIONED: f64 = 1e-3;

/// Remaining squared length, relative to the largest, below which cancellation requires to compute it again.
const CANCELLED: f64 = 1e-6;

/// Reflection with parallel sums: no recorded digest of solver results depends on its rounding.
#[inline]
fn reflect(v: &[f64], scale: f64, x: &mut [f64]) {
    add_scaled(x, -scale * dot(v, x), v);
}

impl RowSpace {
    /// Factorises a matrix that is given by its rows in sequence, each of `columns` numbers.
    ///
    /// Rows whose remaining length is at most `min_length` add no rank.
    pub(crate) fn factorise(&mut self, entries: &[f64], columns: usize, min_length: f64) {
        self.is_gram = false;
        self.columns = columns;
        self.rows = entries.len().checked_div(columns).unwrap_or(0);
        self.q_r.load(columns, entries.iter());
        self.pivots.clear();
        self.pivots.extend(0..self.rows);
        self.remaining.clear();
        let rows = entries.chunks_exact(columns.max(1));
        self.remaining.extend(rows.map(|row| dot(row, row)));
        let longest: f64 = self
            .remaining
            .iter()
            .fold(0.0, |max, remaining| remaining.max(max));
        for k in 0..self.rows.min(columns) {
            let best = (k..self.rows).fold(k, |best, next| {
                match self.remaining[next] > self.remaining[best] {
                    true => next,
                    false => best,
                }
            });
            if self.remaining[best] <= CANCELLED * longest {
                for row in k..self.rows {
                    let tail = self.q_r.tail_norm(row, k);
                    self.remaining[row] = tail * tail;
                }
            }
            let best = (k..self.rows).fold(best, |best, next| {
                match self.remaining[next] > self.remaining[best] {
                    true => next,
                    false => best,
                }
            });
            // False for NaN.
            let is_independent = self.remaining[best].sqrt() > min_length;
            if !is_independent {
                break;
            }
            self.q_r.swap_columns(k, best);
            self.pivots.swap(k, best);
            self.remaining.swap(k, best);
            self.q_r.reduce_next_by(reflect);
            for row in k + 1..self.rows {
                let entry = self.q_r.r(k, row);
                self.remaining[row] = (self.remaining[row] - entry * entry).max(0.0);
            }
        }
        if self.rank() < self.rows {
            self.factorise_dependent();
        }
    }

    /// Factorises a matrix of `rows` rows that is given by its columns, if no [`null_direction`](Self::null_direction)
    /// is needed.
    ///
    /// Entries may often be zero. Rows whose remaining length is at most `tolerance` of the longest add no rank.
    pub(crate) fn factorise_columns(&mut self, entries: &[f64], rows: usize, tolerance: f64) {
        self.rows = rows;
        self.columns = entries.len().checked_div(rows).unwrap_or(0);
        self.is_gram = rows <= self.columns && rows > 0 && self.factorise_gram(entries);
        if !self.is_gram {
            let mut transposed = std::mem::take(&mut self.matrix);
            transposed.clear();
            for row in 0..rows {
                transposed.extend(entries.iter().skip(row).step_by(rows));
            }
            let squares = transposed.chunks_exact(self.columns.max(1));
            let longest = squares.fold(0.0_f64, |max, row| max.max(dot(row, row)));
            self.factorise(&transposed, self.columns, tolerance * longest.sqrt());
            self.matrix = transposed;
        }
    }

    /// Factorises A Aᵀ = L Lᵀ. Returns true if the rows are clearly independent.
    fn factorise_gram(&mut self, entries: &[f64]) -> bool {
        let count = self.rows;
        refill(&mut self.gram, count * count, 0.0);
        self.spans.clear();
        // The columns of a limb are nonzero only in the rows of its tip.
        for column in entries.chunks_exact(count) {
            let from = column.iter().position(|entry| *entry != 0.0);
            let from = from.unwrap_or(count);
            let last = column[from..].iter().rposition(|entry| *entry != 0.0);
            let to = last.map_or(from, |last| from + last + 1);
            self.spans.push((from, to));
            for k in from..to {
                let row = &mut self.gram[k * count + from..=k * count + k];
                add_scaled(row, column[k], &column[from..=k]);
            }
        }
        let longest = (0..count).fold(0.0_f64, |max, k| max.max(self.gram[k * count + k]));
        cholesky::factorise(&mut self.gram, count, &mut self.pivot_column);
        // The diagonal is stored inverted, or zero for a lost pivot.
        let pivots = (0..count).map(|k| self.gram[k * count + k]);
        let squared = pivots.map(|inverse| match inverse > 0.0 {
            true => 1.0 / (inverse * inverse * longest),
            false => 0.0,
        });
        let min_pivot = squared.fold(f64::INFINITY, f64::min);
        if !(longest.is_finite() && min_pivot > CLEARLY_INDEPENDENT) {
            return false;
        }
        self.refinements = if min_pivot > WELL_CONDITIONED { 0 } else { 1 };
        entries.clone_into(&mut self.matrix);
        true
    }

    /// Number of independent rows.
    pub(crate) fn rank(&self) -> usize {
        match self.is_gram {
            true => self.rows,
            false => self.q_r.reduced(),
        }
    }

    /// Dimension of the null space.
    pub(crate) fn nullity(&self) -> usize {
        self.columns - self.rank()
    }

    /// Factorises Rᵀ = Z U.
    fn factorise_dependent(&mut self) {
        self.r_transposed.clear();
        for column in 0..self.rank() {
            let zeros = std::iter::repeat_n(0.0, column);
            let row_entries = (column..self.rows).map(|row| self.q_r.r(column, row));
            self.r_transposed.extend(zeros.chain(row_entries));
        }
        self.z_u.load(self.rows, self.r_transposed.iter());
        for _ in 0..self.rank() {
            self.z_u.reduce_next();
        }
    }

    /// Writes the k-th direction of an orthonormal basis of the null space.
    pub(crate) fn null_direction(&self, k: usize, direction: &mut [f64]) {
        direction.fill(0.0);
        if let Some(entry) = direction.get_mut(self.rank() + k) {
            *entry = 1.0;
        }
        self.q_r.apply(direction);
    }

    /// Writes the shortest y that minimises ‖A y − b‖.
    pub(crate) fn solve(&mut self, b: &[f64], y: &mut [f64]) {
        if self.is_gram {
            return self.solve_gram(b, y);
        }
        let rank = self.rank();
        self.side.clear();
        self.side.extend(self.pivots.iter().map(|&row| b[row]));
        y.fill(0.0);
        if rank < self.rows {
            // U s = (Zᵀ Pᵀ b)₁
            self.z_u.apply_transpose(&mut self.side);
            for k in (0..rank).rev() {
                let known: f64 = (k + 1..rank).map(|j| self.z_u.r(k, j) * y[j]).sum();
                y[k] = (self.side[k] - known) / self.z_u.r(k, k);
            }
        } else {
            // Rᵀ s = Pᵀ b
            for k in 0..rank {
                let known: f64 = (0..k).map(|j| self.q_r.r(j, k) * y[j]).sum();
                y[k] = (self.side[k] - known) / self.q_r.r(k, k);
            }
        }
        self.q_r.apply(y);
    }

    /// Writes the shortest λ that minimises ‖Aᵀ λ − g‖.
    pub(crate) fn solve_transposed(&mut self, g: &[f64], lambda: &mut [f64]) {
        if self.is_gram {
            return self.solve_gram_transposed(g, lambda);
        }
        let rank = self.rank();
        g.clone_into(&mut self.side);
        self.q_r.apply_transpose(&mut self.side);
        let mut pivoted = std::mem::take(&mut self.remaining);
        refill(&mut pivoted, self.rows, 0.0);
        if rank < self.rows {
            // Uᵀ w = (Qᵀ g)₁, λ = P Z [w; 0]
            for k in 0..rank {
                let known: f64 = (0..k).map(|j| self.z_u.r(j, k) * pivoted[j]).sum();
                pivoted[k] = (self.side[k] - known) / self.z_u.r(k, k);
            }
            self.z_u.apply(&mut pivoted);
        } else {
            for k in (0..rank).rev() {
                let known: f64 = (k + 1..rank).map(|j| self.q_r.r(k, j) * pivoted[j]).sum();
                pivoted[k] = (self.side[k] - known) / self.q_r.r(k, k);
            }
        }
        for (&row, &value) in self.pivots.iter().zip(&pivoted) {
            lambda[row] = value;
        }
        self.remaining = pivoted;
    }

    /// Nonzero parts of A's columns, with their rows.
    fn nonzero_columns(&self) -> impl Iterator<Item = (Range<usize>, &[f64])> {
        let columns = self.matrix.chunks_exact(self.rows.max(1));
        let spans = self.spans.iter().map(|&(from, to)| from..to);
        spans
            .zip(columns)
            .map(|(rows, column)| (rows.clone(), &column[rows]))
    }

    /// Computes y = Aᵀ (A Aᵀ)⁻¹ b, and repeats that for the remainder of b.
    fn solve_gram(&mut self, b: &[f64], y: &mut [f64]) {
        let mut remainder = std::mem::take(&mut self.remainder);
        y.fill(0.0);
        for round in 0..=self.refinements {
            b.clone_into(&mut remainder);
            if round > 0 {
                for ((rows, column), y) in self.nonzero_columns().zip(&*y) {
                    add_scaled(&mut remainder[rows], -y, column);
                }
            }
            cholesky::substitute(&self.gram, self.rows, &mut remainder);
            for ((rows, column), y) in self.nonzero_columns().zip(&mut *y) {
                *y += dot(column, &remainder[rows]);
            }
        }
        self.remainder = remainder;
    }

    /// Computes λ = (A Aᵀ)⁻¹ A g, and repeats that for the remainder of g.
    fn solve_gram_transposed(&mut self, g: &[f64], lambda: &mut [f64]) {
        let mut remainder = std::mem::take(&mut self.remainder);
        lambda.fill(0.0);
        for round in 0..=self.refinements {
            refill(&mut remainder, self.rows, 0.0);
            for ((rows, column), g) in self.nonzero_columns().zip(g) {
                let residual = match round {
                    0 => *g,
                    _ => g - dot(column, &lambda[rows.clone()]),
                };
                if residual != 0.0 {
                    add_scaled(&mut remainder[rows], residual, column);
                }
            }
            cholesky::substitute(&self.gram, self.rows, &mut remainder);
            add_scaled(lambda, 1.0, &remainder);
        }
        self.remainder = remainder;
    }
}

#[cfg(test)]
mod tests {
    use super::RowSpace;

    /// Three rows, of which the last is twice the first.
    const DEPENDENT: [f64; 12] = [1.0, 2.0, 0.0, 1.0, 0.0, 1.0, 3.0, 0.0, 2.0, 4.0, 0.0, 2.0];

    fn product(matrix: &[f64], y: &[f64]) -> Vec<f64> {
        let rows = matrix.chunks_exact(y.len());
        rows.map(|row| row.iter().zip(y).map(|(a, b)| a * b).sum())
            .collect()
    }

    #[test]
    fn null_space_is_orthonormal_and_complete() {
        let mut space = RowSpace::default();
        space.factorise(&DEPENDENT, 4, 1e-12);
        assert_eq!((space.rank(), space.nullity()), (2, 2));
        let directions = [0, 1].map(|k| {
            let mut direction = [0.0; 4];
            space.null_direction(k, &mut direction);
            direction
        });
        for (k, direction) in directions.iter().enumerate() {
            assert!(
                product(&DEPENDENT, direction)
                    .iter()
                    .all(|v| v.abs() < 1e-14)
            );
            for (j, other) in directions.iter().enumerate() {
                let inner: f64 = direction.iter().zip(other).map(|(a, b)| a * b).sum();
                assert!((inner - f64::from(j == k)).abs() < 1e-14);
            }
        }
    }

    /// (A⁺ b)·g = b·(A⁺ᵀ g), and A A⁺ A = A, for both ranks, with the null space and without.
    #[test]
    fn pseudoinverse_and_transpose_agree() {
        for (rows, bare) in [(2, false), (3, false), (2, true), (3, true)] {
            let matrix = &DEPENDENT[..rows * 4];
            let mut space = RowSpace::default();
            match bare {
                true => {
                    let columns = |k: usize| matrix.iter().skip(k).step_by(4).copied();
                    let entries: Vec<f64> = (0..4).flat_map(columns).collect();
                    space.factorise_columns(&entries, rows, 1e-12);
                }
                false => space.factorise(matrix, 4, 1e-12),
            }
            assert_eq!((space.rank(), space.is_gram), (2, bare && rows == 2));
            let (b, g) = ([0.3, -1.0, 0.7], [0.2, 0.5, -0.4, 1.0]);
            let (mut y, mut lambda) = ([0.0; 4], [0.0; 3]);
            space.solve(&b[..rows], &mut y);
            space.solve_transposed(&g, &mut lambda[..rows]);
            let one: f64 = y.iter().zip(g).map(|(a, b)| a * b).sum();
            let other: f64 = b[..rows].iter().zip(lambda).map(|(a, b)| a * b).sum();
            assert!((one - other).abs() < 1e-14, "{one} {other}");

            let image = product(matrix, &[1.0, -2.0, 0.5, 3.0]);
            space.solve(&image, &mut y);
            for (a, b) in product(matrix, &y).iter().zip(&image) {
                assert!((a - b).abs() < 1e-13);
            }
        }
    }
}
