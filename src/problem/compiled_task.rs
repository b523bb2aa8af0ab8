//! A task with its names resolved to slots and its rows placed.

use std::ops::Range;

use crate::kinematics::FrameSlot;
use crate::task::{Role, Room, Rows};

/// How far from where it was a goal may end for the sake of ranks below, as a share of its tolerance.
const KEPT: f64 = 1e-3;

/// Rows of one quantity, their weight and tolerance.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    /// What they measure, and how many they are.
    pub(crate) measure: Rows,
    /// Rows of the whole problem.
    pub(crate) rows: Range<usize>,
    pub(crate) weight: f64,
    pub(crate) tolerance: f64,
}

impl Block {
    /// Its rows, where those of its task begin at `to` instead of `from`.
    pub(crate) fn rows_after(&self, from: usize, to: usize) -> Range<usize> {
        self.rows.start - from + to..self.rows.end - from + to
    }

    /// How far from where it was its weighted error may end for the sake of ranks below.
    pub(crate) fn kept_within(&self) -> f64 {
        KEPT * self.tolerance * self.weight
    }

    /// Whether anything is asked of the rows: a weight of 0 or an infinite tolerance asks nothing.
    pub(crate) fn can_miss(&self) -> bool {
        self.weight > 0.0 && self.tolerance < f64::INFINITY
    }
}

/// A task as a problem evaluates and judges it.
///
/// A block *can miss* where its weight and tolerance ask for something. A goal *binds* where one of its
/// blocks can: only those are ever missed, and what ranks below must *keep* those blocks' errors. Every
/// other task pulls. Its rank follows from that and its level: see [`Ranks`](super::Ranks).
#[derive(Clone, Debug)]
pub(crate) struct CompiledTask {
    pub(crate) name: String,
    /// Whether it closes a loop of the model.
    pub(crate) is_loop: bool,
    pub(crate) role: Role,
    pub(crate) blocks: Vec<Block>,
    /// All rows, of the whole problem.
    pub(crate) rows: Range<usize>,
    /// Whether it is a goal that can be missed.
    pub(crate) binds: bool,
    /// The level that it was given: lower ones come first.
    pub(crate) level: usize,
    /// Which tasks it is weighed against; lower ones come first.
    pub(crate) rank: usize,
    /// The same rows, rank by rank.
    pub(crate) rows_by_rank: Range<usize>,
    /// The weight of each row.
    pub(crate) weights: Vec<f64>,
    /// Within what its rows vanish, where the edges of that stand, rank by rank, and the weight of each.
    pub(crate) rooms: Vec<Room>,
    pub(crate) edges_by_rank: Range<usize>,
    pub(crate) edge_weights: Vec<f64>,
    pub(crate) frames: Vec<FrameSlot>,
    /// Whether its Jacobian comes cheaper by sweeps over the whole tree than frame by frame.
    pub(crate) swept: bool,
    /// Coordinates of the configuration.
    pub(crate) coordinates: Vec<usize>,
}

impl CompiledTask {
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    pub(crate) fn blocks(&self) -> impl Iterator<Item = &Block> {
        self.blocks.iter()
    }

    /// Whether what ranks below must leave a block's error where the search of its own rank left it.
    pub(crate) fn keeps(&self, block: &Block) -> bool {
        self.binds && block.can_miss()
    }
}
