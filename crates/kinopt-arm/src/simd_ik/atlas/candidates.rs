//! Start configurations found by a look-up in the atlas.

use super::table::{MAX_ATLAS_JOINTS, PER_CELL};

/// Start configurations of one cell, with the order in which to try them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidates {
    pub(crate) count: usize,
    pub(super) q: [[f64; PER_CELL]; MAX_ATLAS_JOINTS],
    pub(super) order: [u8; PER_CELL],
}

impl Candidates {
    pub(crate) fn none() -> Self {
        Self {
            count: 0,
            q: [[0.0; PER_CELL]; MAX_ATLAS_JOINTS],
            order: [0; PER_CELL],
        }
    }

    /// Writes candidate `index` into `q`, not clamped to the bounds.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn fill(&self, index: usize, q: &mut [f64]) {
        let slot = usize::from(self.order[index % PER_CELL]) % PER_CELL;
        for (value, row) in q.iter_mut().zip(&self.q) {
            *value = row[slot];
        }
    }
}
