//! Null space of the arm's task Jacobian.

/// Pivot, relative to the largest, below which a row counts as zero.
const PIVOT_TOLERANCE: f64 = 1e-6;

/// Basis of the null space of a matrix with six rows, stored column by column.
///
/// Gauss-Jordan elimination with complete pivoting (Golub & Van Loan 2013, "Matrix Computations", ch. 3.4). The buffers
/// are reused.
#[derive(Debug, Default)]
pub(super) struct NullSpace {
    matrix: Vec<[f64; 6]>,
    order: Vec<usize>,
    /// Basis vectors, one after another, n numbers each.
    pub(super) directions: Vec<f64>,
    pub(super) count: usize,
}

impl NullSpace {
    /// Computes the basis. `scales` are the weights of one unit of each joint.
    pub(super) fn compute(&mut self, jacobian: &[f64], scales: &[f64]) {
        let n = scales.len();
        self.matrix.clear();
        for (column, scale) in jacobian.chunks_exact(6).zip(scales) {
            let mut scaled = [0.0; 6];
            for (entry, value) in scaled.iter_mut().zip(column) {
                *entry = value / scale;
            }
            self.matrix.push(scaled);
        }
        self.order.clear();
        self.order.extend(0..n);
        let mut largest = 0.0;
        let mut rank = 0;
        while rank < n.min(6) {
            let Some((row, index, size)) = self.pivot(rank) else {
                break;
            };
            largest = f64::max(largest, size);
            if size <= PIVOT_TOLERANCE * largest {
                break;
            }
            self.order.swap(rank, index);
            let pivot = self.order[rank];
            for column in &mut self.matrix {
                column.swap(rank, row);
            }
            let pivot_column = self.matrix[pivot];
            // Columns of earlier pivots are unit vectors.
            for &column in &self.order[rank..] {
                let column = &mut self.matrix[column];
                column[rank] /= pivot_column[rank];
                let factor = column[rank];
                for (row, entry) in column.iter_mut().enumerate() {
                    if row != rank {
                        *entry -= pivot_column[row] * factor;
                    }
                }
            }
            rank += 1;
        }
        self.count = n - rank;
        self.directions.clear();
        self.directions.resize(self.count * n, 0.0);
        for (free, direction) in self.directions.chunks_exact_mut(n).enumerate() {
            let column = self.order[rank + free];
            direction[column] = 1.0;
            for (row, &pivot) in self.order[..rank].iter().enumerate() {
                direction[pivot] = -self.matrix[column][row];
            }
            let length = direction.iter().map(|v| v * v).sum::<f64>().sqrt();
            for (entry, scale) in direction.iter_mut().zip(scales) {
                *entry /= length * scale;
            }
        }
    }

    /// Returns the largest remaining entry: row, index into `order`, absolute value.
    fn pivot(&self, rank: usize) -> Option<(usize, usize, f64)> {
        let mut best: Option<(usize, usize, f64)> = None;
        for index in rank..self.order.len() {
            let column = &self.matrix[self.order[index]];
            for (row, entry) in column.iter().enumerate().skip(rank) {
                let size = entry.abs();
                if size > best.map_or(0.0, |best| best.2) {
                    best = Some((row, index, size));
                }
            }
        }
        best
    }
}
