//! What a solution touches.

use super::Solution;
use crate::problem::{Collision, Question};

impl Solution {
    /// What is in the way: the pairs that are nearer to each other at `q` than the margin asked for, the deepest first; or where there are
    /// none and the step to a better place is not surely free, the pair that it would come to ([`Collision::on_the_way`]). A solution
    /// that is [reached](Self::reached) has none; none are known where no world was given.
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

    /// Checks what a question's problem keeps clear of, for engines that are not led out of what they touch.
    pub(crate) fn check_clear(&mut self, question: Question<'_>) {
        let fence = question.problem.fence();
        if let Some(fence) = fence.filter(|_| self.q.iter().all(|value| value.is_finite())) {
            self.set_collisions(fence.check().collisions(&self.q));
        }
    }

    /// Takes what is in the way; a solution that has something in its way is not reached.
    pub(crate) fn set_collisions(&mut self, collisions: Vec<Collision>) {
        self.reached &= collisions.is_empty();
        self.collisions = collisions;
    }
}
