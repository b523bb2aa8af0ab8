//! Newton's model along what some rows leave free, as a least-squares problem.

use nalgebra::DMatrix;

use super::cholesky;
use super::row_span::RowSpan;

/// ½ Δᵀ(P H P + μ I)Δ + gᵀPΔ as ½‖E Δ + e‖², P the projection along the rows' span, for variables that may move.
#[derive(Clone, Debug, Default)]
pub(crate) struct TangentNewton {
    /// P H P, by rows.
    hessian: Vec<f64>,
    factor: Vec<f64>,
    pivot_column: Vec<f64>,
    column: Vec<f64>,
    /// The largest entry of the diagonal.
    stiffest: f64,
    pub(crate) rows: DMatrix<f64>,
    pub(crate) residual: Vec<f64>,
}

impl TangentNewton {
    /// Takes H, column by column; what it has for fixed variables must be zero.
    pub(crate) fn take(&mut self, hessian: &DMatrix<f64>, above: &RowSpan) {
        let n = hessian.ncols();
        self.hessian.resize(n * n, 0.0);
        // P H, column by column, …
        for (j, column) in hessian.as_slice().chunks_exact(n.max(1)).enumerate() {
            self.column.clear();
            self.column.extend_from_slice(column);
            above.project_out(&mut self.column);
            for (row, &entry) in self.column.iter().enumerate() {
                self.hessian[row * n + j] = entry;
            }
        }
        // … then each of its rows times P, and the symmetric part of that.
        for row in self.hessian.chunks_exact_mut(n.max(1)) {
            above.project_out(row);
        }
        self.stiffest = 0.0;
        for row in 0..n {
            for column in 0..=row {
                let mean = 0.5 * (self.hessian[row * n + column] + self.hessian[column * n + row]);
                self.hessian[row * n + column] = mean;
                self.hessian[column * n + row] = mean;
            }
            self.stiffest = self.stiffest.max(self.hessian[row * n + row].abs());
        }
    }

    /// The largest entry of the diagonal: what damping is measured by.
    pub(crate) fn stiffest(&self) -> f64 {
        self.stiffest
    }

    /// Writes E and e for a damping μ and the projected slope P g. False where the model has no minimum.
    pub(crate) fn minimise(&mut self, damping: f64, slope: &[f64]) -> bool {
        let n = slope.len();
        self.factor.clear();
        self.factor.extend_from_slice(&self.hessian);
        for j in 0..n {
            self.factor[j * n + j] += damping;
        }
        if !cholesky::factorise(&mut self.factor, n, &mut self.pivot_column) {
            return false;
        }
        if self.rows.shape() != (n, n) {
            self.rows = DMatrix::zeros(n, n);
        }
        self.residual.resize(n, 0.0);
        // E = Lᵀ: its column j is row j of L, whose diagonal is kept inverted.
        for (j, row) in self.factor.chunks_exact(n.max(1)).enumerate() {
            let column = &mut self.rows.as_mut_slice()[j * n..(j + 1) * n];
            column.fill(0.0);
            column[..j].copy_from_slice(&row[..j]);
            column[j] = if row[j] > 0.0 { 1.0 / row[j] } else { 0.0 };
            let known: f64 = (row[..j].iter().zip(&self.residual))
                .map(|(l, e)| l * e)
                .sum();
            self.residual[j] = (slope[j] - known) * row[j];
        }
        true
    }
}
