//! A task with its names resolved to slots and its rows placed.

use std::ops::Range;

use super::ProblemError;
use crate::kinematics::FrameSlot;
use crate::task::{Quantity, Role, Room, Rows};

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
    /// What multiplies its rows, from a weight that is given.
    ///
    /// # Errors
    /// One that is negative or not finite.
    pub(super) fn weight_of(
        task: &str,
        quantity: Quantity,
        weight: f64,
    ) -> Result<f64, ProblemError> {
        if !(weight >= 0.0 && weight.is_finite()) {
            return Err(ProblemError::BadWeight {
                task: task.to_owned(),
                quantity,
                weight,
            });
        }
        // In the cost a weight whose square is nothing is none.
        Ok(match weight * weight < f64::MIN_POSITIVE {
            true => 0.0,
            false => weight,
        })
    }

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

    /// What follows from the weights of its blocks.
    pub(super) fn weigh(&mut self) {
        let blocks = self.blocks.iter();
        self.weights.clear();
        self.weights.extend(
            blocks.flat_map(|block| std::iter::repeat_n(block.weight, block.measure.count)),
        );
        self.edge_weights.clear();
        for room in &self.rooms {
            let weight = self.weights.get(room.rows().start).copied();
            let edges = std::iter::repeat_n(weight.unwrap_or_default(), room.edges());
            self.edge_weights.extend(edges);
        }
        self.binds = self.role == Role::Goal && self.blocks.iter().any(Block::can_miss);
    }

    /// Whether what ranks below must leave a block's error where the search of its own rank left it.
    pub(crate) fn keeps(&self, block: &Block) -> bool {
        self.binds && block.can_miss()
    }
}
