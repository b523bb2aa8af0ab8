//! What some rows span: the part of a vector that they leave alone, and their multipliers.

use super::dense::{add_scaled, dot};

/// Rows added one by one, with an orthonormal basis of what they span (modified Gram-Schmidt, twice: Golub &
/// Van Loan 2013, section 5.2.8).
#[derive(Clone, Debug, Default)]
pub(crate) struct RowSpan {
    /// The basis, vector by vector.
    basis: Vec<f64>,
    /// What each row that added to it is made of, row by row: its shares of the vectors up to its own.
    shares: Vec<f64>,
    /// Which rows those were, as the caller counts them.
    rows: Vec<usize>,
    left: Vec<f64>,
    multipliers: Vec<f64>,
    /// How much of each variable's own direction no vector takes, squared.
    untaken: Vec<f64>,
}

impl RowSpan {
    /// Makes room for so many independent rows of so many numbers.
    pub(crate) fn reserve(&mut self, rows: usize, columns: usize) {
        self.clear();
        for (vector, room) in [
            (&mut self.basis, rows * columns),
            (&mut self.shares, triangle(rows + 1)),
            (&mut self.left, columns),
            (&mut self.multipliers, rows),
            (&mut self.untaken, columns),
        ] {
            vector.clear();
            vector.reserve(room);
        }
        self.rows.reserve(rows);
    }

    /// Forgets all rows.
    pub(crate) fn clear(&mut self) {
        self.basis.clear();
        self.shares.clear();
        self.rows.clear();
    }

    /// Adds a row by its number, unless no more than `least` of its length is new.
    pub(crate) fn add(&mut self, number: usize, row: impl Iterator<Item = f64>, least: f64) {
        self.left.clear();
        self.left.extend(row);
        let rank = self.rows.len();
        self.shares.resize(triangle(rank + 1), 0.0);
        let shares = &mut self.shares[triangle(rank)..];
        shares.fill(0.0);
        for _ in 0..2 {
            let basis = self.basis.chunks_exact(self.left.len().max(1));
            for (vector, share) in basis.zip(&mut *shares) {
                let along = dot(vector, &self.left);
                add_scaled(&mut self.left, -along, vector);
                *share += along;
            }
        }
        let new = dot(&self.left, &self.left).sqrt();
        if new > least && new.is_finite() {
            shares[rank] = new;
            self.basis.extend(self.left.iter().map(|entry| entry / new));
            self.rows.push(number);
        }
    }

    /// Leaves of a vector what is orthogonal to all rows.
    pub(crate) fn project_out(&self, vector: &mut [f64]) {
        for direction in self.basis.chunks_exact(vector.len().max(1)) {
            let along = dot(direction, vector);
            add_scaled(vector, -along, direction);
        }
    }

    /// Writes orthonormal directions of the variables that are not fixed, as many as there are that no row feels, one
    /// after the other. Rows must have nothing for fixed variables.
    pub(crate) fn complement(&mut self, fixed: &[bool], directions: &mut Vec<f64>) {
        let n = fixed.len();
        let basis = self.basis.chunks_exact(n.max(1));
        self.untaken.clear();
        let free = fixed.iter().map(|&fixed| if fixed { -1.0 } else { 1.0 });
        self.untaken.extend(free);
        for vector in basis.clone() {
            for (untaken, entry) in self.untaken.iter_mut().zip(vector) {
                *untaken -= entry * entry;
            }
        }
        let free = fixed.iter().filter(|fixed| !**fixed).count();
        directions.clear();
        for _ in self.rows.len()..free {
            let most = (0..n).max_by(|&a, &b| self.untaken[a].total_cmp(&self.untaken[b]));
            let Some(most) = most else { return };
            let done = directions.len();
            directions.resize(done + n, 0.0);
            let (others, own) = directions.split_at_mut(done);
            own[most] = 1.0;
            // Twice, as Gram-Schmidt on rows.
            for _ in 0..2 {
                for vector in basis.clone().chain(others.chunks_exact(n.max(1))) {
                    let along = dot(vector, own);
                    add_scaled(own, -along, vector);
                }
            }
            let length = dot(own, own).sqrt();
            for (untaken, entry) in self.untaken.iter_mut().zip(&mut *own) {
                *entry /= length;
                *untaken -= *entry * *entry;
            }
        }
    }

    /// For each row that adds to the span, its number and its λ in the sum of rows that is nearest to −`vector`.
    /// Where all rows are zero the vector does not count.
    pub(crate) fn multipliers<'s>(
        &'s mut self,
        vector: &[f64],
    ) -> impl Iterator<Item = (usize, f64)> + use<'s> {
        let basis = self.basis.chunks_exact(vector.len().max(1));
        self.multipliers.clear();
        self.multipliers
            .extend(basis.map(|direction| -dot(direction, vector)));
        // Row k is made of the vectors up to its own, so its λ follows from those after it.
        for k in (0..self.rows.len()).rev() {
            let shares = &self.shares[triangle(k)..];
            let own = self.multipliers[k] / shares[k];
            self.multipliers[k] = own;
            add_scaled(&mut self.multipliers[..k], -own, &shares[..k]);
        }
        self.rows
            .iter()
            .copied()
            .zip(self.multipliers.iter().copied())
    }
}

/// How many shares so many rows have.
fn triangle(rows: usize) -> usize {
    rows * (rows + 1) / 2
}

#[cfg(test)]
mod tests {
    use super::RowSpan;

    #[test]
    fn multipliers_rebuild_what_rows_span_and_nothing_of_the_rest() {
        let rows = [[1.0, 2.0, 0.0, -1.0], [0.5, 0.0, 3.0, 1.0]];
        let mut space = RowSpan::default();
        for (number, row) in rows.iter().enumerate() {
            space.add(number, row.iter().copied(), 1e-10);
        }
        // Twice the first and the second: nothing new.
        space.add(7, [2.5, 4.0, 3.0, -1.0].into_iter(), 1e-10);
        let vector = [0.3, -1.2, 0.7, 2.0];
        let mut rest = vector;
        for (number, multiplier) in space.multipliers(&vector) {
            for (rest, entry) in rest.iter_mut().zip(rows[number]) {
                *rest += multiplier * entry;
            }
        }
        let mut projected = vector;
        space.project_out(&mut projected);
        for ((rest, projected), k) in rest.iter().zip(&projected).zip(0..) {
            assert!((rest - projected).abs() < 1e-14, "{k}: {rest} {projected}");
        }
        for row in rows {
            let along: f64 = row.iter().zip(&rest).map(|(a, b)| a * b).sum();
            assert!(along.abs() < 1e-14, "{along}");
        }
    }

    #[test]
    fn the_complement_is_orthonormal_and_all_that_no_row_feels() {
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
