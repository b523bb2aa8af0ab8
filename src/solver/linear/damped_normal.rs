//! The damped normal equations, from whichever side is smaller.

use nalgebra::DMatrix;

/// Pivots below this share of the largest diagonal entry count as zero.
const NEGLIGIBLE: f64 = 1e-14;

/// Solves (J_FᵀJ_F + λI) Δ = −J_Fᵀ r over the free columns F; with fewer rows than free columns
/// through (J_F J_Fᵀ + λI) y = −r, Δ = J_Fᵀ y, which is the same Δ.
#[derive(Clone, Debug, Default)]
pub(in crate::solver) struct DampedNormal {
    /// J_FᵀJ_F or J_F J_Fᵀ, lower triangle, row by row.
    gram: Vec<f64>,
    gram_is_fresh: bool,
    factor: Vec<f64>,
    unknown: Vec<f64>,
}

impl DampedNormal {
    /// Makes room for every problem of this shape, whatever is free.
    pub(in crate::solver) fn reserve(&mut self, rows: usize, columns: usize) {
        let order = rows.min(columns);
        for (vector, room) in [
            (&mut self.gram, order * order),
            (&mut self.factor, order * order),
            (&mut self.unknown, order),
        ] {
            vector.clear();
            vector.reserve(room);
        }
        self.gram_is_fresh = false;
    }

    /// The Jacobian or the free set has changed.
    pub(in crate::solver) fn forget(&mut self) {
        self.gram_is_fresh = false;
    }

    /// Writes Δ at the free variables of `step`. `gradient` is Jᵀr.
    pub(in crate::solver) fn solve(
        &mut self,
        jacobian: &DMatrix<f64>,
        residual: &[f64],
        gradient: &[f64],
        free: &[usize],
        damping: f64,
        step: &mut [f64],
    ) {
        let rows = residual.len();
        let dual = rows < free.len();
        let order = rows.min(free.len());
        if !self.gram_is_fresh {
            self.gram.clear();
            self.gram.resize(order * order, 0.0);
            if dual {
                self.add_outer_products(jacobian, free, order);
            } else {
                self.fill_inner_products(jacobian, free, order);
            }
            self.gram_is_fresh = true;
        }
        self.factor.clear();
        self.factor.extend_from_slice(&self.gram);
        for k in 0..order {
            self.factor[k * order + k] += damping;
        }
        self.unknown.clear();
        if dual {
            self.unknown.extend(residual.iter().map(|r| -r));
        } else {
            self.unknown.extend(free.iter().map(|&j| -gradient[j]));
        }
        factorise(&mut self.factor, order);
        substitute(&self.factor, order, &mut self.unknown);
        if dual {
            for &j in free {
                let column = jacobian.column(j);
                step[j] = column.iter().zip(&self.unknown).map(|(j, y)| j * y).sum();
            }
        } else {
            for (&j, &value) in free.iter().zip(&self.unknown) {
                step[j] = value;
            }
        }
    }

    /// J_F J_Fᵀ: one outer product a column, whose zeros (rows that the joint does not move) are
    /// skipped.
    fn add_outer_products(&mut self, jacobian: &DMatrix<f64>, free: &[usize], order: usize) {
        let entries = jacobian.as_slice();
        for &j in free {
            let column = &entries[j * order..(j + 1) * order];
            for (a, &value) in column.iter().enumerate() {
                if value != 0.0 {
                    let gram_row = &mut self.gram[a * order..a * order + a + 1];
                    for (sum, &other) in gram_row.iter_mut().zip(column) {
                        *sum += value * other;
                    }
                }
            }
        }
    }

    /// J_FᵀJ_F, entry by entry.
    fn fill_inner_products(&mut self, jacobian: &DMatrix<f64>, free: &[usize], order: usize) {
        let rows = jacobian.nrows();
        let entries = jacobian.as_slice();
        let column = |j: usize| &entries[j * rows..(j + 1) * rows];
        for (a, &ja) in free.iter().enumerate() {
            for (b, &jb) in free.iter().enumerate().take(a + 1) {
                let products = column(ja).iter().zip(column(jb)).map(|(p, q)| p * q);
                self.gram[a * order + b] = products.sum();
            }
        }
    }
}

/// Cholesky L Lᵀ of a positive semidefinite matrix, in place in its lower triangle. A pivot that
/// rounding has eaten makes its unknown zero.
fn factorise(a: &mut [f64], order: usize) {
    let largest = (0..order).map(|k| a[k * order + k]).fold(0.0, f64::max);
    for k in 0..order {
        let (above, below) = a.split_at_mut((k + 1) * order);
        let row = &mut above[k * order..];
        let pivot = row[k] - row[..k].iter().map(|v| v * v).sum::<f64>();
        let inverse = if pivot > NEGLIGIBLE * largest {
            1.0 / pivot.sqrt()
        } else {
            0.0
        };
        // The diagonal holds the inverse of L's, so that substitution multiplies.
        row[k] = inverse;
        for lower in below.chunks_exact_mut(order) {
            let dot: f64 = lower[..k].iter().zip(&row[..k]).map(|(p, q)| p * q).sum();
            lower[k] = (lower[k] - dot) * inverse;
        }
    }
}

/// Solves L Lᵀ x = b in place.
fn substitute(factor: &[f64], order: usize, b: &mut [f64]) {
    for k in 0..order {
        let row = &factor[k * order..k * order + k + 1];
        let dot: f64 = row[..k].iter().zip(&b[..k]).map(|(l, v)| l * v).sum();
        b[k] = (b[k] - dot) * row[k];
    }
    for k in (0..order).rev() {
        let row = &factor[k * order..k * order + k + 1];
        b[k] *= row[k];
        let value = b[k];
        for (earlier, l) in b[..k].iter_mut().zip(row) {
            *earlier -= l * value;
        }
    }
}
