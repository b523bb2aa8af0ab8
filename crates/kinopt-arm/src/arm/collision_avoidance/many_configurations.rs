//! Collision checks of many configurations and of motions, for whole paths.

use crate::arm::QueryError;
use crate::arm::arm::Arm;
use kinopt_solver::search::Collision;

impl Arm {
    /// Flags the configurations that are free by their spheres or, if `by_shapes`, by the exact check.
    ///
    /// All are free for an arm without a checker.
    pub(crate) fn are_free(
        &self,
        q: &[f64],
        by_shapes: bool,
        free: &mut Vec<bool>,
    ) -> Result<(), QueryError> {
        free.clear();
        free.resize(q.len() / self.joint_count(), true);
        self.for_each_colliding(q, by_shapes, |index| free[index] = false)
    }

    /// Collision on the motion between two configurations with linear joint interpolation; `None` if it is free.
    pub(crate) fn motion_collision(
        &self,
        from: &[f64],
        to: &[f64],
    ) -> Result<Option<Collision>, QueryError> {
        let Some(avoidance) = &self.collisions else {
            return Ok(None);
        };
        self.with_collision_workspace(avoidance, |_, checks| {
            avoidance.blocked(self, checks, from, to)
        })
    }
}
