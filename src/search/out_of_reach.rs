//! Targets that are certainly out of reach.

use super::Solution;
use crate::problem::{CompiledTask, Question};
use crate::task::{FrameGoal, Quantity, Role};

/// A goal whose place is farther from where its chain begins than the chain is long.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Beyond {
    pub(super) task: usize,
    /// From the chain's first joint to the place.
    pub(super) distance: f64,
    /// The chain's length.
    pub(super) reach: f64,
}

impl Solution {
    /// Whether a missed goal is one that no configuration can meet, for certain.
    pub(crate) fn is_beyond_reach(&self) -> bool {
        self.beyond.is_some()
    }

    /// Looks for a missed goal that no configuration can meet.
    pub(crate) fn find_beyond(&mut self, question: Question<'_>) {
        let tasks = question.problem.compiled_tasks().iter().enumerate();
        let mut goals = tasks.filter(|(_, task)| task.role == Role::Goal);
        self.beyond = goals.find_map(|(index, task)| beyond(question, index, task));
    }
}

fn beyond(question: Question<'_>, index: usize, task: &CompiledTask) -> Option<Beyond> {
    // Anchors are where the problem was built.
    let problem = (!question.places_moved()).then_some(question.problem)?;
    let residual = question.residual(index).as_any();
    let FrameGoal { place, offset, .. } = FrameGoal::by(residual)?;
    let target = place?;
    let mut asked = task.blocks().filter(|block| block.can_miss());
    let place = asked.find(|block| block.measure.quantity == Quantity::Metres)?;
    let anchor = problem.anchor(index)?;
    let (distance, reach) = anchor.falls_short_of(target, offset, place.tolerance)?;
    Some(Beyond {
        task: index,
        distance,
        reach,
    })
}
