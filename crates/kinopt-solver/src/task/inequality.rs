//! Inequalities of residuals.

use std::ops::Range;

/// Residual rows that are zero together exactly if all of their slacks are at least zero.
///
/// For priority levels below, such rows are the inequalities slack ≥ 0 rather than equations: see
/// [`InequalityResidual`](super::InequalityResidual).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Inequality {
    rows: Range<usize>,
    edges: usize,
}

impl Inequality {
    /// An inequality of these rows with `edges` slacks.
    #[must_use]
    pub fn new(rows: Range<usize>, edges: usize) -> Self {
        Self { rows, edges }
    }

    /// Number of slacks.
    #[must_use]
    pub fn edges(&self) -> usize {
        self.edges
    }

    /// The rows that are zero inside.
    #[must_use]
    pub fn rows(&self) -> Range<usize> {
        self.rows.clone()
    }
}
