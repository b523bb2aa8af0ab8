//! Detection of targets that are provably out of reach.

use super::Solution;
use crate::problem::{CompiledTask, ProblemInstance, TaskSubset};
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

/// Lower bound of the cost of some tasks, from required targets that are provably unreachable; 0 without one.
pub(super) fn min_cost(instance: ProblemInstance<'_>, subset: TaskSubset) -> f64 {
    let tasks = instance.problem.tasks_of(subset);
    let goals = tasks.filter(|(_, task, _)| task.role == Role::Goal);
    let costs = goals.filter_map(|(index, task, _)| {
        let OutOfReach {
            distance, reach, ..
        } = out_of_reach(instance, index, task)?;
        let (weight, _) = weight_and_tolerance(task)?;
        let error = weight * (distance - reach);
        Some(0.5 * error * error)
    });
    costs.sum()
}

/// Weight and tolerance of the position of a task.
fn weight_and_tolerance(task: &CompiledTask) -> Option<(f64, f64)> {
    let mut blocks = task.blocks().filter(|block| block.can_be_unreached());
    let block = blocks.find(|block| block.measure.quantity == Quantity::Metres)?;
    Some((block.weight, block.tolerance))
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
    let (_, tolerance) = weight_and_tolerance(task)?;
    let anchor = problem.anchor(index)?;
    let (distance, reach) = anchor.falls_short_of(target, offset, tolerance)?;
    Some(OutOfReach {
        task: index,
        distance,
        reach,
    })
}
