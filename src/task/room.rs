//! Rows that cost nothing within some edges.

use std::ops::Range;

/// Rows of a residual that vanish together where each of some depths is at least zero, and only there.
///
/// To what ranks below a goal such rows are not equations but the inequalities depth ≥ 0: see
/// [`Residual::rooms`](super::Residual::rooms).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Room {
    rows: Range<usize>,
    edges: usize,
}

impl Room {
    /// These rows of the residual vanish within so many edges.
    #[must_use]
    pub fn new(rows: Range<usize>, edges: usize) -> Self {
        Self { rows, edges }
    }

    getters! {
        /// How many edges it has.
        pub fn edges(&self) -> usize = self.edges;
        /// The rows that vanish within it.
        pub fn rows(&self) -> Range<usize> = self.rows.clone();
    }
}
