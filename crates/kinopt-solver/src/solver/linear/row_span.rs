//! Span of some rows: orthogonal complement and multipliers.

use super::dense::{add_scaled, dot};

/// Rows added one by one, with an orthonormal basis of their span (modified Gram-Schmidt, twice: Golub & Van Loan 2013,
/// section 5.2.8).
#[derive(Clone, Debug, Default)]
#[doc(hidden)]
pub struct RowSpan {
    /// Basis, vector by vector.
    basis: Vec<f64>,
    /// Coefficients of each independent row in the basis vectors up to its own, row by row.
    coefficients: Vec<f64>,
    /// The caller's number of each independent row.
    rows: Vec<usize>,
    remainder: Vec<f64>,
    multipliers: Vec<f64>,
    /// Squared part of each variable's unit vector outside the span of all vectors so far.
    free_parts: Vec<f64>,
}

impl RowSpan {
    /// Reserves memory for this many independent rows and numbers per row.
    pub(crate) fn reserve(&mut self, rows: usize, columns: usize) {
        self.clear();
        for (vector, capacity) in [
            (&mut self.basis, rows * columns),
            (&mut self.coefficients, triangle(rows + 1)),
            (&mut self.remainder, columns),
            (&mut self.multipliers, rows),
            (&mut self.free_parts, columns),
        ] {
            vector.clear();
            vector.reserve(capacity);
        }
        self.rows.reserve(rows);
    }

    /// Removes all rows.
    pub(crate) fn clear(&mut self) {
        self.basis.clear();
        self.coefficients.clear();
        self.rows.clear();
    }

    /// Adds a row by its number, unless at most `min_length` of it is independent of the stored rows.
    pub(crate) fn add(&mut self, number: usize, row: impl Iterator<Item = f64>, min_length: f64) {
        self.remainder.clear();
        self.remainder.extend(row);
        let rank = self.rows.len();
        self.coefficients.resize(triangle(rank + 1), 0.0);
        let coefficients = &mut self.coefficients[triangle(rank)..];
        coefficients.fill(0.0);
        for _ in 0..2 {
            let basis = self.basis.chunks_exact(self.remainder.len().max(1));
            for (vector, coefficient) in basis.zip(&mut *coefficients) {
                let component = dot(vector, &self.remainder);
                add_scaled(&mut self.remainder, -component, vector);
                *coefficient += component;
            }
        }
        let length = dot(&self.remainder, &self.remainder).sqrt();
        if length > min_length && length.is_finite() {
            coefficients[rank] = length;
            self.basis
                .extend(self.remainder.iter().map(|entry| entry / length));
            self.rows.push(number);
        }
    }

    /// Projects a vector onto the orthogonal complement of the rows.
    pub(crate) fn project_out(&self, vector: &mut [f64]) {
        for direction in self.basis.chunks_exact(vector.len().max(1)) {
            let along = dot(direction, vector);
            add_scaled(vector, -along, direction);
        }
    }

    /// Writes an orthonormal basis of the rows' null space over the variables that are not fixed, in sequence.
    ///
    /// Rows must be zero for fixed variables.
    pub(crate) fn complement(&mut self, fixed: &[bool], directions: &mut Vec<f64>) {
        let n = fixed.len();
        let basis = self.basis.chunks_exact(n.max(1));
        self.free_parts.clear();
        let free = fixed.iter().map(|&fixed| if fixed { -1.0 } else { 1.0 });
        self.free_parts.extend(free);
        for vector in basis.clone() {
            for (free_part, entry) in self.free_parts.iter_mut().zip(vector) {
                *free_part -= entry * entry;
            }
        }
        let free = fixed.iter().filter(|fixed| !**fixed).count();
        directions.clear();
        for _ in self.rows.len()..free {
            let index = (0..n).max_by(|&a, &b| self.free_parts[a].total_cmp(&self.free_parts[b]));
            let Some(index) = index else { return };
            let done = directions.len();
            directions.resize(done + n, 0.0);
            let (earlier, direction) = directions.split_at_mut(done);
            direction[index] = 1.0;
            // Twice, as in `add`.
            for _ in 0..2 {
                for vector in basis.clone().chain(earlier.chunks_exact(n.max(1))) {
                    let component = dot(vector, direction);
                    add_scaled(direction, -component, vector);
                }
            }
            let length = dot(direction, direction).sqrt();
            for (free_part, entry) in self.free_parts.iter_mut().zip(&mut *direction) {
                *entry /= length;
                *free_part -= *entry * *entry;
            }
        }
    }

    /// Numbers and multipliers λ of the independent rows, for the combination of rows nearest to −`vector`.
    pub(crate) fn multipliers<'s>(
        &'s mut self,
        vector: &[f64],
    ) -> impl Iterator<Item = (usize, f64)> + use<'s> {
        let basis = self.basis.chunks_exact(vector.len().max(1));
        self.multipliers.clear();
        self.multipliers
            .extend(basis.map(|direction| -dot(direction, vector)));
        // Row k depends on the basis vectors up to its own, so its λ follows from the later ones.
        for k in (0..self.rows.len()).rev() {
            let coefficients = &self.coefficients[triangle(k)..];
            let multiplier = self.multipliers[k] / coefficients[k];
            self.multipliers[k] = multiplier;
            add_scaled(&mut self.multipliers[..k], -multiplier, &coefficients[..k]);
        }
        self.rows
            .iter()
            .copied()
            .zip(self.multipliers.iter().copied())
    }
}

/// Number of coefficients of this many rows.
fn triangle(rows: usize) -> usize {
    rows * (rows + 1) / 2
}

#[cfg(test)]
mod tests {
    use super::RowSpan;

    #[test]
    fn multipliers_rebuild_only_the_span_of_the_rows() {
        let rows = [[1.0, 2.0, 0.0, -1.0], [0.5, 0.0, 3.0, 1.0]];
        let mut space = RowSpan::default();
        for (number, row) in rows.iter().enumerate() {
            space.add(number, row.iter().copied(), 1e-10);
        }
        // Twice the first row and the second: dependent.
        space.add(7, [2.5, 4.0, 3.0, -1.0].into_iter(), 1e-10);
        let vector = [0.3, -1.2, 0.7, 2.0];
        let mut remainder = vector;
        for (number, multiplier) in space.multipliers(&vector) {
            for (remainder, entry) in remainder.iter_mut().zip(rows[number]) {
                *remainder += multiplier * entry;
            }
        }
        let mut projected = vector;
        space.project_out(&mut projected);
        for ((remainder, projected), k) in remainder.iter().zip(&projected).zip(0..) {
            assert!(
                (remainder - projected).abs() < 1e-14,
                "{k}: {remainder} {projected}"
            );
        }
        for row in rows {
            let along: f64 = row.iter().zip(&remainder).map(|(a, b)| a * b).sum();
            assert!(along.abs() < 1e-14, "{along}");
        }
    }

    #[test]
    fn complement_is_an_orthonormal_null_space_basis() {
        let rows = [[1.0, 2.0, 0.0, -1.0, 0.4], [0.5, 0.0, 0.0, 1.0, -0.3]];
        let mut space = RowSpan::default();
        for (number, row) in rows.iter().enumerate() {
            space.add(number, row.iter().copied(), 1e-10);
        }
        let (fixed, mut directions) = ([false, false, true, false, false], Vec::new());
        space.complement(&fixed, &mut directions);
        assert_eq!(directions.len(), 2 * 5);
        let inner = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        for (k, direction) in directions.chunks_exact(5).enumerate() {
            assert_eq!(direction[2], 0.0);
            for row in &rows {
                assert!(inner(direction, row).abs() < 1e-14);
            }
            for (j, other) in directions.chunks_exact(5).enumerate() {
                assert!((inner(direction, other) - f64::from(j == k)).abs() < 1e-14);
            }
        }
    }
}
