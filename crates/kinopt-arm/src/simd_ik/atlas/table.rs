//! Memory layout of the seed atlas.

use kinopt_kinematics::spatial::Vector3;

/// Largest number of joints with an atlas; for longer chains random starts suffice.
pub(super) const MAX_ATLAS_JOINTS: usize = 12;

/// Largest number of configurations in a cell.
pub(super) const PER_CELL: usize = 4;

/// Number of cells along each coordinate of the key.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KeyResolution {
    pub(crate) radius: usize,
    pub(crate) height: usize,
    pub(crate) direction: usize,
    /// Average number of samples per cell.
    pub(crate) samples: usize,
}

impl Default for KeyResolution {
    fn default() -> Self {
        Self {
            radius: 8,
            height: 12,
            direction: 8,
            samples: 16,
        }
    }
}

/// One number of each of a cell's configurations.
pub(super) type CellRow = [f32; PER_CELL];

/// Table of start configurations over a grid of keys.
#[derive(Debug)]
pub(crate) struct Atlas {
    pub(super) joints: usize,
    pub(super) resolution: KeyResolution,
    pub(super) low: [f64; 2],
    pub(super) scale: [f64; 2],
    /// Rows of each cell: joint values (one row per joint), key (five rows), derivative (four rows per joint).
    pub(super) rows: Vec<CellRow>,
    /// Number of configurations in each cell.
    pub(super) counts: Vec<u8>,
    /// Index of the leading joint, by which goals are reduced.
    ///
    /// It is the second joint if the first two have one axis and the first is prismatic with a short range, as in a
    /// lifting torso. Otherwise it is the first. The short prismatic joint is sampled like those in between: a
    /// reduction by it would put most starts outside its range.
    pub(super) lead: usize,
    /// Point of the leading axis in the first joint's frame.
    pub(super) lead_point: Vector3<f64>,
    pub(super) lead_turns: bool,
    pub(super) last_turns: bool,
    /// Middle of the range of the leading and the last joint.
    pub(super) middles: [f64; 2],
}

impl Atlas {
    /// Memory of the table, in bytes.
    pub(crate) fn memory(&self) -> usize {
        size_of_val(self.rows.as_slice()) + self.counts.len()
    }
}
