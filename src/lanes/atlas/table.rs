//! The atlas as it lies in memory.

use crate::spatial::Vector3;

/// Longer chains have no atlas: random restarts suffice there.
pub(super) const MAX_ATLAS_JOINTS: usize = 12;

/// Configurations a cell holds.
pub(super) const PER_CELL: usize = 4;

/// Number of cells along each coordinate of the key.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Resolution {
    pub(crate) radius: usize,
    pub(crate) height: usize,
    pub(crate) direction: usize,
    /// Samples a cell, on average.
    pub(crate) samples: usize,
}

impl Default for Resolution {
    fn default() -> Self {
        Self {
            radius: 8,
            height: 12,
            direction: 8,
            samples: 16,
        }
    }
}

/// One number of the cell's configurations each.
pub(super) type Row = [f32; PER_CELL];

/// The table.
#[derive(Debug)]
pub(crate) struct Atlas {
    pub(super) joints: usize,
    pub(super) resolution: Resolution,
    pub(super) low: [f64; 2],
    pub(super) scale: [f64; 2],
    /// Per cell: joint values (one row a joint), key (five rows), derivative (four rows a joint).
    pub(super) rows: Vec<Row>,
    /// Number of configurations, by cell.
    pub(super) counts: Vec<u8>,
    /// The joint that goals are reduced by: the first, or the second where both stand along one axis and the first slides but a little,
    /// as a torso does that lifts an arm. That slide is sampled as the joints between are: goals reduced by it leave most seeds beyond its ends.
    pub(super) lead: usize,
    /// Where its axis meets the first joint's frame.
    pub(super) lead_at: Vector3<f64>,
    pub(super) lead_turns: bool,
    pub(super) last_turns: bool,
    /// Middle of the range of the leading and the last joint.
    pub(super) middles: [f64; 2],
}

impl Atlas {
    /// Bytes held.
    pub(crate) fn memory(&self) -> usize {
        size_of_val(self.rows.as_slice()) + self.counts.len()
    }
}
