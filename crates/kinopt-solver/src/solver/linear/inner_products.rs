//! Product JᵀJ for a kinematic tree.
//!
//! The joints of a limb move few of the rows, so most products of two columns have few terms or none. This is
//! branch-induced sparsity (Featherstone 2005, "Efficient factorization of the joint-space inertia matrix for branched
//! kinematic trees").

use nalgebra::DMatrix;

use super::dense::{dot, dot_of_chunks};

/// Number of rows per bit of a support.
const CHUNK: usize = 4;

/// Supports of columns: one bit per chunk of rows with a nonzero entry.
#[derive(Clone, Debug, Default)]
#[doc(hidden)]
pub struct InnerProducts {
    supports: Vec<u64>,
}

impl InnerProducts {
    /// Reserves memory.
    #[doc(hidden)]
    pub fn reserve(&mut self, columns: usize) {
        self.supports.clear();
        self.supports.reserve(columns);
    }

    /// Writes the lower triangle of J_FᵀJ_F, row by row.
    ///
    /// Each entry is bitwise equal to the product of whole columns.
    #[doc(hidden)]
    pub fn fill(&mut self, jacobian: &DMatrix<f64>, free: &[usize], gram: &mut [f64]) {
        let (rows, order) = (jacobian.nrows(), free.len());
        let entries = jacobian.as_slice();
        let column = |j: usize| &entries[j * rows..(j + 1) * rows];
        let bits = rows.div_ceil(CHUNK);
        if bits > u64::BITS as usize {
            for (a, &ja) in free.iter().enumerate() {
                for (b, &jb) in free.iter().enumerate().take(a + 1) {
                    gram[a * order + b] = dot(column(ja), column(jb));
                }
            }
            return;
        }
        self.supports.clear();
        self.supports
            .extend(free.iter().map(|&j| support(column(j))));
        let whole = u64::MAX >> (u64::BITS as usize - bits.max(1));
        for (a, &ja) in free.iter().enumerate() {
            for (b, &jb) in free.iter().enumerate().take(a + 1) {
                let shared = self.supports[a] & self.supports[b];
                gram[a * order + b] = match shared {
                    0 => 0.0,
                    _ if shared == whole => dot(column(ja), column(jb)),
                    _ => dot_of_chunks(column(ja), column(jb), shared),
                };
            }
        }
    }
}

/// Bit mask of a column's chunks with a nonzero entry.
fn support(column: &[f64]) -> u64 {
    let mut support = 0;
    for (k, chunk) in column.chunks(CHUNK).enumerate() {
        support |= u64::from(chunk.iter().any(|&v| v != 0.0)) << k;
    }
    support
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::{InnerProducts, dot};

    #[test]
    fn products_of_sparse_columns_are_those_of_whole_ones() {
        for rows in [1, 3, 4, 26, 255, 256, 257] {
            let columns = 9;
            let entry = |i: usize, j: usize| match (i / 6 + j) % 3 {
                0 => 1.0 / ((7 * i + 3 * j + 1) as f64),
                _ if j == 0 => 1.0 / ((i + 2) as f64),
                _ => 0.0,
            };
            let jacobian = DMatrix::from_fn(rows, columns, entry);
            let free = [0, 1, 2, 4, 5, 7, 8];
            let mut gram = vec![0.0; free.len() * free.len()];
            InnerProducts::default().fill(&jacobian, &free, &mut gram);
            let entries = jacobian.as_slice();
            let column = |j: usize| &entries[j * rows..(j + 1) * rows];
            for (a, &i) in free.iter().enumerate() {
                for (b, &j) in free.iter().enumerate().take(a + 1) {
                    assert_eq!(gram[a * free.len() + b], dot(column(i), column(j)));
                }
            }
        }
    }
}
