//! Targets that are certainly out of reach.

use super::Solution;
use crate::problem::{CompiledTask, Problem};
use crate::spatial::Vector3;
use crate::task::{Point, Pose, Quantity, Role};

/// Rounding of the lengths that are compared, as a share of them.
const ROUNDING: f64 = 1e-9;

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
    pub(super) fn find_beyond(&mut self, problem: &Problem) {
        let tasks = problem.compiled_tasks().iter().enumerate();
        let mut goals = tasks.filter(|(_, task)| task.role == Role::Goal);
        self.beyond = goals.find_map(|(index, task)| beyond(problem, index, task));
    }
}

fn beyond(problem: &Problem, index: usize, task: &CompiledTask) -> Option<Beyond> {
    let residual = task.residual.as_any();
    let (target, offset) = if let Some(point) = residual.downcast_ref::<Point>() {
        (point.target(), point.offset())
    } else {
        let pose = residual.downcast_ref::<Pose>()?;
        (pose.target().translation, Vector3::zero())
    };
    let anchor = problem.anchor(index)?;
    let mut asked = task.blocks().filter(|block| block.can_miss());
    let place = asked.find(|block| block.quantity == Quantity::Metres)?;
    let (distance, reach) = (
        (target - anchor.centre).norm(),
        anchor.reach + offset.norm(),
    );
    let certain = distance - reach > place.tolerance + ROUNDING * (distance + reach);
    (certain && distance.is_finite()).then_some(Beyond {
        task: index,
        distance,
        reach,
    })
}
