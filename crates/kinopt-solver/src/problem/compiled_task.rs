//! Compiled tasks, with names resolved to slots and rows numbered.

use std::ops::Range;

use super::ProblemError;
use crate::task::{Inequality, Quantity, Role, RowBlock};
use kinopt_kinematics::kinematics::FrameSlot;

/// Largest change of a required task's error in favour of lower priorities, relative to its tolerance.
const MAX_RELATIVE_CHANGE: f64 = 1e-3;

/// Rows of one quantity with their weight and tolerance.
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct Block {
    /// Quantity and number of the rows.
    #[doc(hidden)]
    pub measure: RowBlock,
    /// Rows of the whole problem.
    pub(crate) rows: Range<usize>,
    #[doc(hidden)]
    pub weight: f64,
    pub(crate) tolerance: f64,
}

impl Block {
    /// The factor on the rows for a given weight.
    ///
    /// # Errors
    /// Returns an error for a weight that is negative or not finite.
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
        // A weight whose square underflows has no effect on the cost.
        Ok(match weight * weight < f64::MIN_POSITIVE {
            true => 0.0,
            false => weight,
        })
    }

    /// The rows, after the first row of the task moves from `from` to `to`.
    pub(crate) fn rows_after(&self, from: usize, to: usize) -> Range<usize> {
        self.rows.start - from + to..self.rows.end - from + to
    }

    /// Largest change of its weighted error in favour of lower priorities.
    pub(crate) fn max_change(&self) -> f64 {
        MAX_RELATIVE_CHANGE * self.tolerance * self.weight
    }

    /// True if the rows can be unreached: the weight is above 0 and the tolerance is finite.
    pub(crate) fn can_be_unreached(&self) -> bool {
        self.weight > 0.0 && self.tolerance < f64::INFINITY
    }
}

/// A task in the form in which a problem evaluates and judges it.
///
/// A block *can miss* if its weight is above 0 and its tolerance finite. A required task *binds* if one of its blocks
/// can miss. Only such tasks are ever unreached, and lower priorities must *keep* the errors of those blocks. All other
/// tasks are soft. The rank of a task is its position in the priority order: see [`Ranks`](super::Ranks).
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct CompiledTask {
    pub(crate) name: String,
    /// True if it closes a loop of the model.
    #[doc(hidden)]
    pub is_loop: bool,
    pub(crate) role: Role,
    pub(crate) blocks: Vec<Block>,
    /// All rows, of the whole problem.
    #[doc(hidden)]
    pub rows: Range<usize>,
    /// True if it is a required task that can be unreached.
    pub(crate) binds: bool,
    /// The priority level that it was given; lower levels come first.
    pub(crate) level: usize,
    /// Position in the priority order; tasks of equal rank are weighted against each other.
    pub(crate) rank: usize,
    /// All rows, numbered in the priority order.
    pub(crate) rows_by_rank: Range<usize>,
    /// The weight of each row.
    pub(crate) weights: Vec<f64>,
    /// Inequalities of the rows; the range of their slacks in the priority order and the weight of each slack follow.
    pub(crate) inequalities: Vec<Inequality>,
    pub(crate) slacks_by_rank: Range<usize>,
    pub(crate) slack_weights: Vec<f64>,
    pub(crate) frames: Vec<FrameSlot>,
    /// True if its Jacobian is cheaper by sweeps over the whole tree than frame by frame.
    pub(crate) uses_sweeps: bool,
    /// Coordinates of the configuration that it reads.
    pub(crate) coordinates: Vec<usize>,
}

impl CompiledTask {
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    #[doc(hidden)]
    pub fn blocks(&self) -> impl Iterator<Item = &Block> {
        self.blocks.iter()
    }

    /// Updates the values that depend on the weights of its blocks.
    pub(super) fn update_weights(&mut self) {
        let blocks = self.blocks.iter();
        self.weights.clear();
        self.weights.extend(
            blocks.flat_map(|block| std::iter::repeat_n(block.weight, block.measure.count)),
        );
        self.slack_weights.clear();
        for inequality in &self.inequalities {
            let weight = self.weights.get(inequality.rows().start).copied();
            let edges = std::iter::repeat_n(weight.unwrap_or_default(), inequality.edges());
            self.slack_weights.extend(edges);
        }
        self.binds = self.role == Role::Goal && self.blocks.iter().any(Block::can_be_unreached);
    }

    /// True if lower priorities must keep the error of a block.
    pub(crate) fn keeps(&self, block: &Block) -> bool {
        self.binds && block.can_be_unreached()
    }
}
