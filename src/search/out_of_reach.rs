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
    pub(crate) fn find_beyond(&mut self, question: ProblemInstance<'_>) {
        let tasks = question.problem.compiled_tasks().iter().enumerate();
        let mut goals = tasks.filter(|(_, task)| task.role == Role::Goal);
        self.beyond = goals.find_map(|(index, task)| beyond(question, index, task));
    }
}

fn beyond(question: ProblemInstance<'_>, index: usize, task: &CompiledTask) -> Option<OutOfReach> {
    // Anchors are valid only for the targets with which the problem was built.
    let problem = (!question.has_moved_tree()).then_some(question.problem)?;
    let residual = question.residual(index).as_any();
    let FrameGoal {
        position: place,
        offset,
        ..
    } = FrameGoal::of_residual(residual)?;
    let target = place?;
    let mut asked = task.blocks().filter(|block| block.can_be_unreached());
    let place = asked.find(|block| block.measure.quantity == Quantity::Metres)?;
    let anchor = problem.anchor(index)?;
    let (distance, reach) = anchor.falls_short_of(target, offset, place.tolerance)?;
    Some(OutOfReach {
        task: index,
        distance,
        reach,
    })
}
