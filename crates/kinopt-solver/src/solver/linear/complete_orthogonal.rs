//! Shortest least-squares solution for a matrix of any rank, by a complete orthogonal decomposition (Golub & Van Loan
//! 2013, section 5.4.7).

use nalgebra::DMatrix;

use super::householder::HouseholderQr;
use kinopt_kinematics::buffer::{refill, vacate};

/// Decomposition A P = Q [R; 0] with column pivoting, then Rᵀ = Z U. Together, A P = Q [Uᵀ 0; 0 0] Zᵀ.
#[derive(Clone, Debug, Default)]
pub(in crate::solver) struct CompleteOrthogonal {
    columns: usize,
    q_r: HouseholderQr,
    z_u: HouseholderQr,
    /// Column of the matrix at each position of the pivoted one.
    pivots: Vec<usize>,
    r_transposed: Vec<f64>,
    right_side: Vec<f64>,
    solution: Vec<f64>,
}

impl CompleteOrthogonal {
    /// Reserves memory for every problem of this shape.
    pub(in crate::solver) fn reserve(&mut self, rows: usize, columns: usize) {
        let rank = rows.min(columns);
        self.q_r.reserve(rows, columns);
        self.z_u.reserve(columns, rank);
        vacate(&mut self.pivots, columns);
        for (vector, capacity) in [
            (&mut self.r_transposed, columns * rank),
            (&mut self.right_side, rows),
            (&mut self.solution, columns),
        ] {
            vacate(vector, capacity);
        }
    }

    /// Factorises the given columns of `matrix`.
    ///
    /// Columns whose remaining length is at most `tolerance` times the longest column add no rank.
    pub(in crate::solver) fn factorise(
        &mut self,
        matrix: &DMatrix<f64>,
        columns: &[usize],
        tolerance: f64,
    ) {
        let rows = matrix.nrows();
        let matrix_entries = matrix.as_slice();
        let entries = columns
            .iter()
            .flat_map(|&column| &matrix_entries[column * rows..(column + 1) * rows]);
        self.q_r.load(rows, entries);
        self.columns = columns.len();
        self.pivots.clear();
        self.pivots.extend(0..columns.len());

        let mut longest = 0.0;
        for k in 0..rows.min(columns.len()) {
            let (best, norm) = self.longest_tail(k);
            longest = f64::max(longest, norm);
            if norm <= tolerance * longest {
                break;
            }
            self.q_r.swap_columns(k, best);
            self.pivots.swap(k, best);
            self.q_r.reduce_next();
        }
        self.factorise_rows();
    }

    fn rank(&self) -> usize {
        self.q_r.reduced()
    }

    fn longest_tail(&self, from: usize) -> (usize, f64) {
        let tails = (from..self.columns).map(|column| (column, self.q_r.tail_norm(column, from)));
        tails.fold(
            (from, 0.0),
            |best, next| {
                if next.1 > best.1 { next } else { best }
            },
        )
    }

    /// Factorises Rᵀ = Z U.
    fn factorise_rows(&mut self) {
        let n = self.columns;
        self.r_transposed.clear();
        for row in 0..self.rank() {
            let zeros = std::iter::repeat_n(0.0, row);
            let row_entries = (row..n).map(|column| self.q_r.r(row, column));
            self.r_transposed.extend(zeros.chain(row_entries));
        }
        self.z_u.load(n, self.r_transposed.iter());
        for _ in 0..self.rank() {
            self.z_u.reduce_next();
        }
    }

    /// Writes the shortest Δ that minimises ‖A Δ + residual‖ to the positions `columns` of `step`.
    pub(in crate::solver) fn minimise(
        &mut self,
        residual: &[f64],
        columns: &[usize],
        step: &mut [f64],
    ) {
        self.right_side.clear();
        self.right_side.extend(residual.iter().map(|r| -r));
        self.q_r.apply_transpose(&mut self.right_side);

        // Uᵀ w = (Qᵀ b)₁, then Δ = P Z [w; 0].
        refill(&mut self.solution, self.columns, 0.0);
        for k in 0..self.rank() {
            let known = (0..k).map(|i| self.z_u.r(i, k) * self.solution[i]);
            let known: f64 = known.sum();
            self.solution[k] = (self.right_side[k] - known) / self.z_u.r(k, k);
        }
        self.z_u.apply(&mut self.solution);
        for (&pivot, &value) in self.pivots.iter().zip(&self.solution) {
            step[columns[pivot]] = value;
        }
    }
}
