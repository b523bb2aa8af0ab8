//! Targets that are certainly out of reach.

use super::Solution;
use crate::problem::{CompiledTask, Problem, Question};
use crate::spatial::Vector3;
use crate::task::{Asked, Quantity, Role};

/// A goal whose place is farther from where its chain begins than the chain is long.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Beyond {
    pub(super) task: usize,
    /// From the chain's first joint to the place.
    pub(super) distance: f64,
    /// The chain's length.
    pub(super) reach: f64,
}

impl Solution {
    /// Looks for a missed goal that no configuration can meet.
    pub(crate) fn find_beyond(&mut self, question: Question<'_>) {
        let tasks = question.problem.compiled_tasks().iter().enumerate();
        let mut goals = tasks.filter(|(_, task)| task.role == Role::Goal);
        self.beyond = goals.find_map(|(index, task)| beyond(question, index, task));
    }

    /// As the core tells of its goals, of the first task's place, which must be met within a tolerance (metres).
    pub(crate) fn find_place_beyond(
        &mut self,
        problem: &Problem,
        place: Vector3<f64>,
        tolerance: f64,
    ) {
        self.beyond = beyond_chain(problem, 0, place, Vector3::zero(), tolerance);
    }
}

fn beyond(question: Question<'_>, index: usize, task: &CompiledTask) -> Option<Beyond> {
    // Anchors are where the problem was built.
    let problem = (!question.places_moved()).then_some(question.problem)?;
    let residual = question.residual(index).as_any();
    let Asked { place, offset, .. } = Asked::by(residual)?;
    let target = place?;
    let mut asked = task.blocks().filter(|block| block.can_miss());
    let place = asked.find(|block| block.measure.quantity == Quantity::Metres)?;
    beyond_chain(problem, index, target, offset, place.tolerance)
}

/// Whether a place is farther from where the chain of a task begins than that is long, with a point's offset from
/// its tip.
fn beyond_chain(
    problem: &Problem,
    index: usize,
    target: Vector3<f64>,
    offset: Vector3<f64>,
    tolerance: f64,
) -> Option<Beyond> {
    let anchor = problem.anchor(index)?;
    let (distance, reach) = anchor.falls_short_of(target, offset, tolerance)?;
    Some(Beyond {
        task: index,
        distance,
        reach,
    })
}
