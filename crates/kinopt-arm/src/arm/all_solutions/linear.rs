//! Small square systems of linear equations.

/// Relative size below which a pivot counts as zero.
const MIN_PIVOT: f64 = 1e-10;

/// Solves rows·x = right by elimination with row pivots; `None` if the matrix is nearly singular.
pub(super) fn solve_square<const N: usize>(
    mut rows: [[f64; N]; N],
    mut right: [f64; N],
) -> Option<[f64; N]> {
    for k in 0..N {
        let mut pivot = k;
        for i in k + 1..N {
            if rows[i][k].abs() > rows[pivot][k].abs() {
                pivot = i;
            }
        }
        rows.swap(k, pivot);
        right.swap(k, pivot);
        let pivot_row = rows[k];
        if pivot_row[k].abs() < MIN_PIVOT {
            return None;
        }
        let scale = pivot_row[k].recip();
        for i in k + 1..N {
            let factor = rows[i][k] * scale;
            for j in k..N {
                rows[i][j] -= factor * pivot_row[j];
            }
            right[i] -= factor * right[k];
        }
    }
    let mut x = [0.0; N];
    for k in (0..N).rev() {
        let sum: f64 = (k + 1..N).map(|j| rows[k][j] * x[j]).sum();
        x[k] = (right[k] - sum) / rows[k][k];
    }
    Some(x)
}
