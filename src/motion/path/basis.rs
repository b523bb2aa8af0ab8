//! Null space of the arm's task Jacobian.

/// Pivot, relative to the largest, below which a row counts as zero.
const NO_ROW: f64 = 1e-6;

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
    pub(super) fn of(&mut self, slopes: &[f64], scales: &[f64]) {
        let n = scales.len();
        self.matrix.clear();
        for (column, scale) in slopes.chunks_exact(6).zip(scales) {
            let mut own = [0.0; 6];
            for (own, slope) in own.iter_mut().zip(column) {
                *own = slope / scale;
            }
            self.matrix.push(own);
        }
        self.order.clear();
        self.order.extend(0..n);
        let mut largest = 0.0;
        let mut rank = 0;
        while rank < n.min(6) {
            let Some((row, place, size)) = self.pivot(rank) else {
                break;
            };
            largest = f64::max(largest, size);
            if size <= NO_ROW * largest {
                break;
            }
            self.order.swap(rank, place);
            let pivot = self.order[rank];
            for column in &mut self.matrix {
                column.swap(rank, row);
            }
            let own = self.matrix[pivot];
            // Columns of earlier pivots are unit vectors.
            for &column in &self.order[rank..] {
                let column = &mut self.matrix[column];
                column[rank] /= own[rank];
                let by = column[rank];
                for (row, entry) in column.iter_mut().enumerate() {
                    if row != rank {
                        *entry -= own[row] * by;
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
        for place in rank..self.order.len() {
            let column = &self.matrix[self.order[place]];
            for (row, entry) in column.iter().enumerate().skip(rank) {
                let size = entry.abs();
                if size > best.map_or(0.0, |best| best.2) {
                    best = Some((row, place, size));
                }
            }
        }
        best
    }
}
