//! Collisions of a solution.

use super::Solution;
use crate::problem::{Collision, ProblemInstance};

impl Solution {
    /// Collision pairs that prevent the solution from being [reached](Self::reached); empty for a reached solution and
    /// without a world.
    ///
    /// They are the pairs at `q` that are nearer than the required margin, the deepest first. If there are none, the
    /// step to a better configuration may be blocked: the result is then the pair that limits the step
    /// ([`Collision::on_the_way`]).
    #[must_use]
    pub fn collisions(&self) -> &[Collision] {
        &self.collisions
    }

    /// Reports whether all required tasks are within their tolerances, even if there are collisions.
    #[must_use]
    pub fn goals_reached(&self) -> bool {
        self.reached || !self.collisions.is_empty() && self.goals_are_met()
    }

    fn goals_are_met(&self) -> bool {
        let mut goals = self.tasks().filter(|t| t.role == crate::task::Role::Goal);
        goals.all(|task| task.reached)
    }

    /// Checks the collisions of the problem at `q`, for engines that do not avoid them.
    #[doc(hidden)]
    pub fn check_collisions(&mut self, instance: ProblemInstance<'_>) {
        let fence = instance.problem.collision_constraint();
        if let Some(fence) = fence.filter(|_| self.q.iter().all(|value| value.is_finite())) {
            self.set_collisions(fence.check().collisions(&self.q));
        }
    }

    /// Sets the collisions. A solution with collisions is not reached.
    #[doc(hidden)]
    pub fn set_collisions(&mut self, collisions: Vec<Collision>) {
        self.reached &= collisions.is_empty();
        self.collisions = collisions;
    }
}
