//! Collision checks of single configurations of an arm.

use super::avoidance::CollisionAvoidance;
use super::workspace::CollisionWorkspace;
use crate::arm::QueryError;
use crate::arm::arm::Arm;
use crate::arm::workspace::ArmWorkspace;
use crate::simd_spheres;
use kinopt_kinematics::clock::deadline::until;
use kinopt_solver::search::Collision;

/// Largest number of solutions that are checked by shapes after their spheres collide.
pub(super) const MAX_EXACT_CHECKS: usize = 32;

impl CollisionAvoidance {
    /// Pairs that are too near at a configuration of the arm.
    pub(in crate::arm) fn collisions(
        &self,
        arm: &Arm,
        checks: &mut CollisionWorkspace,
        q: &[f64],
    ) -> Result<Vec<Collision>, QueryError> {
        arm.configuration(q, &mut checks.q_model)?;
        let check = || {
            self.checker
                .collisions_with(&mut checks.exact, &checks.q_model)
        };
        Ok(self.check_time.measured(arm.options.time_limit, check)?)
    }

    /// Returns the distance of the nearest pair at a configuration of the arm, metres. It is infinite if all pairs are free,
    /// and negative infinity if the check was cut short. The workspace's trial contacts are those of the check.
    pub(super) fn min_distance(
        &self,
        arm: &Arm,
        checks: &mut CollisionWorkspace,
        q: &[f64],
    ) -> Result<f64, QueryError> {
        arm.configuration(q, &mut checks.q_model)?;
        let check = || {
            self.checker
                .collisions_with(&mut checks.exact, &checks.q_model)
        };
        checks.trial_contacts = until(checks.deadline, check).transpose()?;
        Ok(match &checks.trial_contacts {
            Some(pairs) => pairs.first().map_or(f64::INFINITY, |pair| pair.distance),
            None => f64::NEG_INFINITY,
        })
    }

    /// Returns true if all pairs are far enough apart, by the exact check.
    pub(super) fn is_free(
        &self,
        arm: &Arm,
        checks: &mut CollisionWorkspace,
        q: &[f64],
    ) -> Result<bool, QueryError> {
        arm.configuration(q, &mut checks.q_model)?;
        let check = || self.checker.is_free(&mut checks.exact, &checks.q_model);
        let free = until(checks.deadline, check);
        Ok(free.transpose()?.unwrap_or(false))
    }

    /// Checks a configuration that is not free by spheres by its shapes. Returns false if the first check was exact
    /// already.
    pub(super) fn is_free_by_shapes(
        &self,
        arm: &Arm,
        checks: &mut CollisionWorkspace,
        q: &[f64],
    ) -> Result<bool, QueryError> {
        Ok(!self.spheres_decide() && !self.never_free && self.is_free(arm, checks, q)?)
    }

    /// Returns true if a configuration is free by its spheres, or else by its shapes.
    pub(super) fn is_clear(
        &self,
        arm: &Arm,
        checks: &mut CollisionWorkspace,
        q: &[f64],
    ) -> Result<bool, QueryError> {
        let by_spheres = self.free_by_spheres(arm, checks, q)? & 1 != 0;
        match by_spheres {
            true => self.are_close_pairs_free(arm, checks, q),
            false => self.is_free_by_shapes(arm, checks, q),
        }
    }

    /// Checks the link pairs that are too close for spheres by their shapes, for a configuration free by spheres.
    pub(super) fn are_close_pairs_free(
        &self,
        arm: &Arm,
        checks: &mut CollisionWorkspace,
        q: &[f64],
    ) -> Result<bool, QueryError> {
        if self.close_pairs.is_empty() || self.simd_checks.is_none() {
            return Ok(true);
        }
        arm.configuration(q, &mut checks.q_model)?;
        let (pairs, exact) = (&self.close_pairs, &mut checks.exact);
        Ok(self.checker.are_apart(pairs, exact, &checks.q_model)?)
    }

    /// Bit mask of up to eight configurations that are free by their spheres, except for [close
    /// pairs](Self::are_close_pairs_free).
    ///
    /// Without spheres the shapes decide.
    pub(super) fn free_by_spheres(
        &self,
        arm: &Arm,
        checks: &mut CollisionWorkspace,
        q: &[f64],
    ) -> Result<u32, QueryError> {
        let n = arm.joint_count();
        if self.never_free {
            return Ok(0);
        }
        let Some(simd_checks) = &self.simd_checks else {
            let mut free = 0;
            for (index, q) in q.chunks_exact(n).enumerate() {
                free |= u32::from(self.is_free(arm, checks, q)?) << index;
            }
            return Ok(free);
        };
        let near_bits = simd_spheres::near(
            &simd_checks.bodies,
            &simd_checks.solids,
            q,
            &mut checks.sphere_workspaces,
        );
        Ok(!near_bits & ((1 << (q.len() / n)) - 1))
    }
}

/// Runs a function with a workspace and its buffers for collision checks.
pub(super) fn with_collision_workspace<T>(
    arm: &Arm,
    avoidance: &CollisionAvoidance,
    run: impl FnOnce(&mut ArmWorkspace, &mut CollisionWorkspace) -> Result<T, QueryError>,
) -> Result<T, QueryError> {
    arm.with_workspace(|workspace| {
        // Taken out and put back, so that nothing is allocated.
        let mut stored = workspace.collision_workspace.take();
        let checks = stored.get_or_insert_with(|| avoidance.workspace());
        checks.deadline = None;
        let result = run(workspace, checks);
        checks.deadline = None;
        workspace.collision_workspace = stored;
        result
    })?
}
