//! Symmetric block-banded matrix with a Cholesky factorisation in linear time and memory.

use kinopt_solver::solver::dot;

/// Tile size of the inner loops in both directions. Blocks are padded to a multiple of this size.
const TILE: usize = 4;
/// Pivot, relative to the largest diagonal entry, below which the matrix is not positive definite.
const PIVOT_TOLERANCE: f64 = 1e-14;

/// Upper triangle of a symmetric matrix whose block (s, t) is zero if |s − t| exceeds the bandwidth.
#[derive(Clone, Debug)]
pub(super) struct BlockBanded {
    blocks: usize,
    order: usize,
    padded: usize,
    /// Row length: the padded columns of the diagonal block and of `bandwidth` following blocks.
    width: usize,
    entries: Vec<f64>,
}

impl BlockBanded {
    /// Creates a zero matrix of `blocks` diagonal blocks of an order.
    pub(super) fn new(blocks: usize, order: usize, bandwidth: usize) -> Self {
        let padded = order.next_multiple_of(TILE);
        let width = (bandwidth + 1) * padded;
        let mut matrix = Self {
            blocks,
            order,
            padded,
            width,
            entries: vec![0.0; blocks * padded * width],
        };
        matrix.clear();
        matrix
    }

    /// Sets all entries to zero, and the padding to the identity.
    pub(super) fn clear(&mut self) {
        self.entries.fill(0.0);
        for block in 0..self.blocks {
            for k in self.order..self.padded {
                let index = self.row_start(block, k) + k;
                self.entries[index] = 1.0;
            }
        }
    }

    pub(super) fn copy_from(&mut self, other: &Self) {
        self.entries.copy_from_slice(&other.entries);
    }

    /// Returns the start of a row. The columns of the diagonal block come first.
    fn row_start(&self, block: usize, row: usize) -> usize {
        (block * self.padded + row) * self.width
    }

    /// Adds to an entry of the block (`block`, `block + ahead`). Diagonal blocks accept `row ≤ column` only.
    pub(super) fn add(
        &mut self,
        block: usize,
        ahead: usize,
        row: usize,
        column: usize,
        value: f64,
    ) {
        let index = self.row_start(block, row) + ahead * self.padded + column;
        self.entries[index] += value;
    }

    /// Returns a row of a diagonal block.
    pub(super) fn row_mut(&mut self, block: usize, row: usize) -> &mut [f64] {
        let start = self.row_start(block, row);
        &mut self.entries[start..start + self.order]
    }

    /// Returns the largest diagonal entry.
    pub(super) fn largest(&self) -> f64 {
        let rows = (0..self.blocks).flat_map(|block| (0..self.order).map(move |k| (block, k)));
        rows.map(|(block, k)| self.entries[self.row_start(block, k) + k])
            .fold(0.0, f64::max)
    }

    /// Adds to all diagonal entries.
    pub(super) fn add_to_diagonal(&mut self, value: f64) {
        for block in 0..self.blocks {
            for k in 0..self.order {
                self.add(block, 0, k, k, value);
            }
        }
    }

    /// Eliminates one unknown: its row and column become those of the identity.
    pub(super) fn eliminate(&mut self, block: usize, unknown: usize) {
        let bandwidth = self.width / self.padded - 1;
        for above in block.saturating_sub(bandwidth)..=block {
            let last = if above == block { unknown } else { self.order };
            for row in 0..last {
                let index = self.row_start(above, row) + (block - above) * self.padded + unknown;
                self.entries[index] = 0.0;
            }
        }
        let start = self.row_start(block, unknown);
        self.entries[start..start + self.width].fill(0.0);
        self.entries[start + unknown] = 1.0;
    }

    /// Computes Cholesky's A = UᵀU in place, block row by block row (Golub & Van Loan 2013, "Matrix Computations",
    /// 4.3.5).
    ///
    /// The diagonal then holds the inverses of U's. Returns false if the matrix is not positive definite.
    pub(super) fn factorise(&mut self) -> bool {
        let Self {
            blocks,
            padded,
            width,
            ..
        } = *self;
        let min_pivot = PIVOT_TOLERANCE * self.largest();
        let size = padded * width;
        for block in 0..blocks {
            let (_, remaining) = self.entries.split_at_mut(block * size);
            let (block_rows, below) = remaining.split_at_mut(size);
            // Rows of the diagonal block, four at a time.
            for first in (0..padded).step_by(TILE) {
                let (_, rest) = block_rows.split_at_mut(first * width);
                let (four, later) = rest.split_at_mut(TILE * width);
                if !factorise_rows(four, first, width, min_pivot) {
                    return false;
                }
                for (k, rows) in later.chunks_exact_mut(TILE * width).enumerate() {
                    let row = first + TILE * (k + 1);
                    subtract_products(rows, row, four, row, width);
                }
            }
            // Updates of the blocks below.
            for (k, next) in below.chunks_exact_mut(size).enumerate() {
                let shift = (k + 1) * padded;
                if shift >= width {
                    break;
                }
                for (row, rows) in next.chunks_exact_mut(TILE * width).enumerate() {
                    subtract_products(rows, TILE * row, block_rows, shift + TILE * row, width);
                }
            }
        }
        true
    }

    /// Solves A x = b in place after [`factorise`](Self::factorise). The last argument is a buffer.
    pub(super) fn solve(&self, b: &mut [f64], buffer: &mut Vec<f64>) {
        let Self {
            blocks,
            order,
            padded,
            width,
            ..
        } = *self;
        buffer.clear();
        buffer.resize(blocks * padded + width, 0.0);
        for (to, from) in buffer.chunks_mut(padded).zip(b.chunks(order)) {
            to[..order].copy_from_slice(from);
        }
        for row in 0..blocks * padded {
            let offset = row % padded;
            let entries = &self.entries[row * width + offset..(row + 1) * width];
            let value = buffer[row] * entries[0];
            buffer[row] = value;
            for (rest, entry) in buffer[row + 1..].iter_mut().zip(&entries[1..]) {
                *rest -= value * entry;
            }
        }
        for row in (0..blocks * padded).rev() {
            let offset = row % padded;
            let entries = &self.entries[row * width + offset..(row + 1) * width];
            let product = dot(&entries[1..], &buffer[row + 1..]);
            buffer[row] = (buffer[row] - product) * entries[0];
        }
        for (from, to) in buffer.chunks(padded).zip(b.chunks_mut(order)) {
            to.copy_from_slice(&from[..order]);
        }
    }
}

/// Factorises four rows whose diagonal begins at column `first`.
fn factorise_rows(rows: &mut [f64], first: usize, width: usize, min_pivot: f64) -> bool {
    for k in 0..TILE {
        let (_, remaining) = rows.split_at_mut(k * width);
        let (pivot_row, later) = remaining.split_at_mut(width);
        let pivot = pivot_row[first + k];
        if pivot <= min_pivot || pivot.is_nan() {
            return false;
        }
        let inverse = 1.0 / pivot.sqrt();
        pivot_row[first + k] = inverse;
        let pivot_row = &mut pivot_row[first + k + 1..];
        pivot_row.iter_mut().for_each(|entry| *entry *= inverse);
        for (ahead, row) in later.chunks_exact_mut(width).enumerate() {
            let factor = pivot_row[ahead];
            let row = &mut row[first + k + 1..];
            for (entry, pivot_row) in row.iter_mut().zip(&*pivot_row) {
                *entry -= factor * pivot_row;
            }
        }
    }
    true
}

/// Subtracts AᵀB from four rows, starting at their column `from`.
///
/// A is the four columns of `factor` that begin at `columns`. B is all columns from there on.
fn subtract_products(rows: &mut [f64], from: usize, factor: &[f64], columns: usize, width: usize) {
    let tiles = (width - columns) / TILE;
    for tile in 0..tiles {
        let right = columns + TILE * tile;
        let mut sums = [[0.0; TILE]; TILE];
        for row in factor.chunks_exact(width) {
            let Some(a) = row[columns..].first_chunk::<TILE>() else {
                return;
            };
            let Some(b) = row[right..].first_chunk::<TILE>() else {
                return;
            };
            for (sums, a) in sums.iter_mut().zip(a) {
                for (sum, b) in sums.iter_mut().zip(b) {
                    *sum += a * b;
                }
            }
        }
        for (row, sums) in rows.chunks_exact_mut(width).zip(&sums) {
            for (entry, sum) in row[from + TILE * tile..].iter_mut().zip(sums) {
                *entry -= sum;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::BlockBanded;
    use kinopt_kinematics::random::RandomStream;

    #[test]
    fn solution_equals_dense_factorisation() {
        let mut random = RandomStream::new(3, 0);
        for (blocks, order, bandwidth) in [(1, 1, 1), (2, 3, 2), (7, 4, 1), (9, 5, 3), (6, 11, 2)] {
            let n = blocks * order;
            let mut banded = BlockBanded::new(blocks, order, bandwidth);
            let mut dense = DMatrix::zeros(n, n);
            for a in 0..n {
                for b in a..n.min((a / order + bandwidth + 1) * order) {
                    let diagonal = if a == b { 10.0 * n as f64 } else { 0.0 };
                    let entry = diagonal + 2.0 * random.unit() - 1.0;
                    (dense[(a, b)], dense[(b, a)]) = (entry, entry);
                    banded.add(
                        a / order,
                        b / order - a / order,
                        a % order,
                        b % order,
                        entry,
                    );
                }
            }
            let removed = n / 2;
            banded.eliminate(removed / order, removed % order);
            dense.row_mut(removed).fill(0.0);
            dense.column_mut(removed).fill(0.0);
            dense[(removed, removed)] = 1.0;
            let b = DVector::from_fn(n, |_, _| random.unit());
            let expected = dense.cholesky().map(|factor| factor.solve(&b));
            assert!(banded.factorise());
            let (mut x, mut buffer) = (b.as_slice().to_vec(), Vec::new());
            banded.solve(&mut x, &mut buffer);
            let error = expected.map(|expected| (expected - DVector::from_vec(x)).amax());
            assert!(error.is_some_and(|error| error < 1e-14), "{error:?}");
        }
    }

    #[test]
    fn indefinite_matrix_is_rejected() {
        let mut banded = BlockBanded::new(2, 1, 1);
        for (block, ahead, entry) in [(0, 0, 1.0), (0, 1, 2.0), (1, 0, 1.0)] {
            banded.add(block, ahead, 0, 0, entry);
        }
        assert!(!banded.factorise());
    }
}
