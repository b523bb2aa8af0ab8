//! Cholesky's factorisation L Lᵀ, row by row.

use super::dense::{add_scaled, dot};

/// Pivots below this share of the largest diagonal entry count as zero.
const NEGLIGIBLE: f64 = 1e-14;

/// Factorises a symmetric matrix in place in its lower triangle; the diagonal then holds the
/// inverses of L's. A pivot that rounding has eaten makes its unknown zero. Returns whether no
/// pivot was clearly negative: whether the matrix is positive semidefinite to rounding.
pub(super) fn factorise(a: &mut [f64], order: usize, pivot_column: &mut Vec<f64>) -> bool {
    let largest = (0..order).map(|k| a[k * order + k]).fold(0.0, f64::max);
    let mut semidefinite = true;
    for k in 0..order {
        let pivot = a[k * order + k];
        semidefinite &= pivot >= -NEGLIGIBLE * largest;
        let inverse = if pivot > NEGLIGIBLE * largest {
            1.0 / pivot.sqrt()
        } else {
            0.0
        };
        a[k * order + k] = inverse;
        // Right-looking: every later row loses its share of this column at once.
        pivot_column.clear();
        for row in a[(k + 1) * order..].chunks_exact_mut(order) {
            row[k] *= inverse;
            pivot_column.push(row[k]);
            let behind = &mut row[k + 1..k + 1 + pivot_column.len()];
            add_scaled(behind, -pivot_column[pivot_column.len() - 1], pivot_column);
        }
    }
    semidefinite
}

/// Solves L Lᵀ x = b in place.
pub(super) fn substitute(factor: &[f64], order: usize, b: &mut [f64]) {
    for (k, row) in factor.chunks_exact(order.max(1)).enumerate() {
        b[k] = (b[k] - dot(&row[..k], &b[..k])) * row[k];
    }
    for (k, row) in factor.chunks_exact(order.max(1)).enumerate().rev() {
        let (earlier, own) = b.split_at_mut(k);
        own[0] *= row[k];
        add_scaled(earlier, -own[0], row);
    }
}
