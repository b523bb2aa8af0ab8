//! Detection of targets that are provably out of reach.

use super::Solution;
use crate::problem::{CompiledTask, ProblemInstance};
use crate::task::{FrameGoal, Quantity, Role};

/// A required task whose target is farther from the start of its chain than the chain is long.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct OutOfReach {
    pub(super) task: usize,
    /// Distance from the first joint of the chain to the target.
    pub(super) distance: f64,
    /// Length of the chain.
    pub(super) reach: f64,
}

impl Solution {
    /// Reports whether an unreached required task is provably unreachable.
    pub(crate) fn is_beyond_reach(&self) -> bool {
        self.beyond.is_some()
    }

    /// Searches for an unreached required task that is provably unreachable.
    #[doc(hidden)]
    pub fn find_out_of_reach(&mut self, instance: ProblemInstance<'_>) {
        let tasks = instance.problem.compiled_tasks().iter().enumerate();
        let mut goals = tasks.filter(|(_, task)| task.role == Role::Goal);
        self.beyond = goals.find_map(|(index, task)| out_of_reach(instance, index, task));
    }
}

fn out_of_reach(
    instance: ProblemInstance<'_>,
    index: usize,
    task: &CompiledTask,
) -> Option<OutOfReach> {
    // Anchors are valid only for the targets with which the problem was built.
    let problem = (!instance.has_moved_tree()).then_some(instance.problem)?;
    let residual = instance.residual(index).as_any();
    let FrameGoal {
        position, offset, ..
    } = FrameGoal::of_residual(residual)?;
    let target = position?;
    let mut checked_blocks = task.blocks().filter(|block| block.can_be_unreached());
    let position_block = checked_blocks.find(|block| block.measure.quantity == Quantity::Metres)?;
    let anchor = problem.anchor(index)?;
    let (distance, reach) = anchor.falls_short_of(target, offset, position_block.tolerance)?;
    Some(OutOfReach {
        task: index,
        distance,
        reach,
    })
}
