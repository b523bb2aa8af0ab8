//! Householder QR factorisation, one column at a time, in reused memory.

/// A matrix that is being reduced to Q R.
///
/// Columns before the current one hold R above the diagonal and the reflection's vector from the diagonal down. R's
/// diagonal is stored separately.
#[derive(Clone, Debug, Default)]
pub(super) struct HouseholderQr {
    rows: usize,
    entries: Vec<f64>,
    diagonal: Vec<f64>,
    /// Factor 2 / ‖v‖² of each reflection I − scale · v vᵀ.
    scale: Vec<f64>,
}

impl HouseholderQr {
    /// Reserves memory for matrices of up to this shape.
    pub(super) fn reserve(&mut self, rows: usize, columns: usize) {
        for (vector, capacity) in [
            (&mut self.entries, rows * columns),
            (&mut self.diagonal, columns),
            (&mut self.scale, columns),
        ] {
            vector.clear();
            vector.reserve(capacity);
        }
    }

    /// Loads a matrix, given by its columns.
    pub(super) fn load<'a>(&mut self, rows: usize, entries: impl Iterator<Item = &'a f64>) {
        self.rows = rows;
        self.entries.clear();
        self.entries.extend(entries);
        self.diagonal.clear();
        self.scale.clear();
    }

    /// Number of reduced columns.
    pub(super) fn reduced(&self) -> usize {
        self.diagonal.len()
    }

    pub(super) fn swap_columns(&mut self, a: usize, b: usize) {
        if a != b {
            for row in 0..self.rows {
                self.entries.swap(a * self.rows + row, b * self.rows + row);
            }
        }
    }

    /// Norm of a column from row `from` down.
    pub(super) fn tail_norm(&self, column: usize, from: usize) -> f64 {
        let tail = &self.entries[column * self.rows + from..(column + 1) * self.rows];
        tail.iter().map(|v| v * v).sum::<f64>().sqrt()
    }

    /// Reduces the next column and applies the reflection to all later ones.
    pub(super) fn reduce_next(&mut self) {
        self.reduce_next_by(reflect);
    }

    /// Reduces the next column with a given loop for x ← (I − scale · v vᵀ) x, called with v, scale and x.
    #[inline]
    pub(super) fn reduce_next_by(&mut self, reflect: impl Fn(&[f64], f64, &mut [f64])) {
        let (k, rows) = (self.reduced(), self.rows);
        let norm = self.tail_norm(k, k);
        let (done, later) = self.entries.split_at_mut((k + 1) * rows);
        let vector = &mut done[k * rows + k..];
        let head = vector[0];
        // This sign avoids cancellation.
        let diagonal = if head > 0.0 { -norm } else { norm };
        vector[0] = head - diagonal;
        let squared: f64 = vector.iter().map(|v| v * v).sum();
        let scale = if squared > 0.0 { 2.0 / squared } else { 0.0 };
        for column in later.chunks_exact_mut(rows) {
            reflect(vector, scale, &mut column[k..]);
        }
        self.diagonal.push(diagonal);
        self.scale.push(scale);
    }

    /// Entry of R, row ≤ column, among the reduced rows.
    pub(super) fn r(&self, row: usize, column: usize) -> f64 {
        if row == column {
            self.diagonal[row]
        } else {
            self.entries[column * self.rows + row]
        }
    }

    /// Computes b ← Qᵀ b.
    pub(super) fn apply_transpose(&self, b: &mut [f64]) {
        for k in 0..self.reduced() {
            self.reflect_by(k, b);
        }
    }

    /// Computes b ← Q b.
    pub(super) fn apply(&self, b: &mut [f64]) {
        for k in (0..self.reduced()).rev() {
            self.reflect_by(k, b);
        }
    }

    fn reflect_by(&self, k: usize, b: &mut [f64]) {
        let vector = &self.entries[k * self.rows + k..(k + 1) * self.rows];
        reflect(vector, self.scale[k], &mut b[k..]);
    }
}

/// Computes x ← (I − scale · v vᵀ) x.
fn reflect(v: &[f64], scale: f64, x: &mut [f64]) {
    let along: f64 = v.iter().zip(&*x).map(|(a, b)| a * b).sum();
    let along = scale * along;
    for (value, entry) in x.iter_mut().zip(v) {
        *value -= along * entry;
    }
}
