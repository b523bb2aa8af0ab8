//! Cholesky factorisation L Lᵀ, row by row.

use super::dense::{add_scaled, add_two_scaled, dot};

/// Relative size of a pivot that counts as zero, compared with the largest diagonal entry.
const NEGLIGIBLE: f64 = 1e-14;

/// Factorises a symmetric matrix in place in its lower triangle; the diagonal then holds the inverses of L's.
///
/// A pivot lost to rounding makes its unknown zero. Returns true if no pivot was clearly negative: the matrix is
/// positive semidefinite up to rounding. `columns` is a buffer for two columns.
pub(super) fn factorise(a: &mut [f64], order: usize, columns: &mut Vec<f64>) -> bool {
    let largest = (0..order).map(|k| a[k * order + k]).fold(0.0, f64::max);
    let mut semidefinite = true;
    let mut inverse_of = |pivot: f64| {
        semidefinite &= pivot >= -NEGLIGIBLE * largest;
        if pivot > NEGLIGIBLE * largest {
            1.0 / pivot.sqrt()
        } else {
            0.0
        }
    };
    columns.resize(2 * order, 0.0);
    let (first, second) = columns.split_at_mut(order);
    let mut k = 0;
    // Right-looking: every later row is updated by two columns at once, in order.
    while k + 1 < order {
        let (above, below) = a.split_at_mut((k + 2) * order);
        let inverse = inverse_of(above[k * order + k]);
        above[k * order + k] = inverse;
        let next = &mut above[(k + 1) * order..];
        next[k] *= inverse;
        let coupling = next[k];
        next[k + 1] -= coupling * coupling;
        let next_inverse = inverse_of(next[k + 1]);
        next[k + 1] = next_inverse;
        for (i, row) in below.chunks_exact_mut(order).enumerate() {
            row[k] *= inverse;
            row[k + 1] = (row[k + 1] - row[k] * coupling) * next_inverse;
            (first[i], second[i]) = (row[k], row[k + 1]);
            let factors = [-row[k], -row[k + 1]];
            let trailing = &mut row[k + 2..k + 3 + i];
            add_two_scaled(trailing, factors, [&first[..=i], &second[..=i]]);
        }
        k += 2;
    }
    if k < order {
        a[k * order + k] = inverse_of(a[k * order + k]);
    }
    semidefinite
}

/// Solves L Lᵀ x = b in place.
pub(super) fn substitute(factor: &[f64], order: usize, b: &mut [f64]) {
    for (k, row) in factor.chunks_exact(order.max(1)).enumerate() {
        b[k] = (b[k] - dot(&row[..k], &b[..k])) * row[k];
    }
    for (k, row) in factor.chunks_exact(order.max(1)).enumerate().rev() {
        let (earlier, later) = b.split_at_mut(k);
        later[0] *= row[k];
        add_scaled(earlier, -later[0], row);
    }
}
