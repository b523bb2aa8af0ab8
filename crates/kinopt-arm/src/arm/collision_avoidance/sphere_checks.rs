//! Collision checks of many configurations, eight per pass in SIMD lanes.

use crate::arm::arm::Arm;
use crate::arm::{PoseOutcome, QueryError};
use crate::simd_spheres::CHECKED;

impl Arm {
    /// Sets `clear` for each configuration in `q`, in sequence, that is proven collision-free by spheres.
    ///
    /// The spheres cover the links, and none is nearer than the margin. Eight configurations are checked per pass, some
    /// twenty times as fast as by [`collisions`](Self::collisions). Spheres may protrude from the shapes, so a
    /// configuration that fails may still be free.
    ///
    /// Link pairs so close that their spheres nearly always overlap, as in a wrist, are checked by their shapes. The
    /// shapes also decide if there are no spheres, or if an obstacle is attached.
    ///
    /// # Errors
    /// Returns an error for an arm without a [checker](Self::with_checker), slices of the wrong length, or a
    /// configuration that is not finite.
    pub fn clear_by_spheres(&self, q: &[f64], clear: &mut [bool]) -> Result<(), QueryError> {
        self.check_length("q", q.len(), self.joint_count() * clear.len())?;
        self.check_finite("q", q)?;
        if !self.avoids_collisions() {
            return Err(QueryError::NothingToKeepClearOf);
        }
        clear.fill(true);
        self.for_each_colliding(q, false, |index| clear[index] = false)
    }

    /// Marks attempts in collision as not reached.
    pub(in crate::arm) fn reject_collisions(
        &self,
        q: &[f64],
        outcomes: &mut [PoseOutcome],
    ) -> Result<(), QueryError> {
        self.for_each_colliding(q, true, |index| outcomes[index].reached = false)
    }

    /// Visits the indices of the configurations that are not proven free by spheres, nor, if `by_shapes`, by the exact
    /// check.
    pub(super) fn for_each_colliding(
        &self,
        q: &[f64],
        by_shapes: bool,
        mut visit: impl FnMut(usize),
    ) -> Result<(), QueryError> {
        let Some(avoidance) = &self.collisions else {
            return Ok(());
        };
        self.with_collision_workspace(avoidance, |_, checks| {
            let n = self.joint_count();
            for (group, configurations) in q.chunks(CHECKED * n).enumerate() {
                let by_spheres = avoidance.free_by_spheres(self, checks, configurations)?;
                for (lane, q) in configurations.chunks_exact(n).enumerate() {
                    let is_free = match by_spheres >> lane & 1 != 0 {
                        true => avoidance.are_close_pairs_free(self, checks, q)?,
                        false => by_shapes && avoidance.is_free_by_shapes(self, checks, q)?,
                    };
                    if !is_free {
                        visit(group * CHECKED + lane);
                    }
                }
            }
            Ok(())
        })
    }
}
