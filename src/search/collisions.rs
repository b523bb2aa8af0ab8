//! What a solution touches.

use super::Solution;
use crate::problem::Collision;

impl Solution {
    /// The pairs that are nearer to each other at `q` than the margin asked for, the deepest first. A solution that is
    /// [reached](Self::reached) has none; none are known where no world was given.
    #[must_use]
    pub fn collisions(&self) -> &[Collision] {
        &self.collisions
    }

    /// Whether every goal is within its tolerances, though something may be touched.
    #[must_use]
    pub fn goals_reached(&self) -> bool {
        self.reached || !self.collisions.is_empty() && self.goals_are_met()
    }

    fn goals_are_met(&self) -> bool {
        let mut goals = self.tasks().filter(|t| t.role == crate::task::Role::Goal);
        goals.all(|task| task.reached)
    }

    /// Takes what is touched; a solution that touches something is not reached.
    pub(crate) fn set_collisions(&mut self, collisions: Vec<Collision>) {
        self.reached &= collisions.is_empty();
        self.collisions = collisions;
    }
}
