//! Steps of a path that stop before a collision.

use super::{CollisionAvoidance, CollisionWorkspace};
use crate::arm::QueryError;
use crate::arm::arm::Arm;
use crate::arm::follower::MAX_JOINT_STEP;
use crate::arm::workspace::ArmWorkspace;
use kinopt_collision::collision::MotionCheck;
use kinopt_kinematics::clock::is_past;
use kinopt_kinematics::spatial::Placement;
use kinopt_solver::ik::Solution;
use kinopt_solver::search::{Collision, SearchResult};
use kinopt_solver::solver::Termination;

/// Distance before the margin at which a shortened step stops, metres, so that the next one can leave.
pub(super) const STAND_OFF: f64 = 1e-4;
/// Null-space motions that are tried to avoid an obstacle in one step, radians.
const AVOIDANCE_MOTIONS: [f64; 3] = [0.04, 0.12, -0.04];

impl Arm {
    /// Avoids a collision on a step of a path by null-space motion, or cuts the step short before it.
    ///
    /// The solution then lists the collision, or the pairs that are still in contact.
    pub(in crate::arm) fn avoid_step_collision(
        &self,
        from: &[f64],
        target: &Placement<f64>,
        solution: &mut Solution,
    ) -> Result<(), QueryError> {
        let Some(avoidance) = &self.collisions else {
            return Ok(());
        };
        self.with_collision_workspace(avoidance, |workspace, checks| {
            let motion = avoidance.way_from_contact(self, checks, from, &solution.q)?;
            let begins_in_contact = motion.begins_touching();
            if let Some(collision) = motion.blocked_by {
                workspace.set_target(target);
                self.bound_by_limits(workspace);
                let found_detour = solution.reached
                    && self.find_detour_in_null_space(avoidance, workspace, checks, from)?;
                if !found_detour {
                    let fraction = avoidance.cautious_fraction(self, checks, from, &solution.q)?;
                    let ends = from.iter().zip(&solution.q);
                    for (x, (from, to)) in workspace.x.iter_mut().zip(ends) {
                        *x = from + fraction * (to - from);
                    }
                }
                let mut result =
                    SearchResult::single_attempt(Termination::CannotContinue, solution.iterations);
                self.judge(workspace, &mut result);
                self.record_configuration(&result, workspace, solution);
                if !found_detour {
                    solution.set_collisions(vec![collision]);
                }
            }
            if begins_in_contact && solution.collisions().is_empty() {
                let contacts = avoidance.collisions(self, checks, &solution.q)?;
                solution.set_collisions(contacts);
            }
            Ok(())
        })
    }

    /// Looks for another configuration near `from` that reaches the target, by null-space motion.
    ///
    /// Leaves the nearest one with a collision-free motion in the workspace's x. Returns true if there is one.
    fn find_detour_in_null_space(
        &self,
        avoidance: &CollisionAvoidance,
        workspace: &mut ArmWorkspace,
        checks: &mut CollisionWorkspace,
        from: &[f64],
    ) -> Result<bool, QueryError> {
        let Some(simd_solver) = self.simd_solver.as_ref().filter(|_| self.has_null_space()) else {
            return Ok(false);
        };
        workspace.compute_twists(self, from);
        let n = self.joint_count();
        let mut q = vec![0.0; n];
        // One deadline for all attempts.
        let deadline = self.deadline();
        let mut best = f64::INFINITY;
        for joint in 0..n {
            for displacement in AVOIDANCE_MOTIONS {
                if is_past(deadline) {
                    return Ok(best.is_finite());
                }
                if !self.perturb_in_null_space(workspace, from, joint, displacement) {
                    continue;
                }
                let target = workspace.target();
                let outcome =
                    simd_solver.attempt_from_start(&target, &workspace.trial, deadline, &mut q);
                let (_, distance) = self.largest_joint_move(from, &q);
                let is_nearer = outcome.reached && distance <= MAX_JOINT_STEP && distance < best;
                let is_free = |checks: &mut CollisionWorkspace| -> Result<bool, QueryError> {
                    let motion = avoidance.way_from_contact(self, checks, from, &q)?;
                    Ok(motion.blocked_by.is_none())
                };
                if is_nearer && is_free(checks)? {
                    best = distance;
                    workspace.x.copy_from_slice(&q);
                }
            }
        }
        Ok(best.is_finite())
    }
}

impl CollisionAvoidance {
    /// Collision on the motion between two configurations of the arm with linear joint interpolation.
    pub(in crate::arm) fn blocked(
        &self,
        arm: &Arm,
        checks: &mut CollisionWorkspace,
        from: &[f64],
        to: &[f64],
    ) -> Result<Option<Collision>, QueryError> {
        checks.set_motion(arm, from, to)?;
        let motion =
            self.checker
                .check_motion(&mut checks.exact, &checks.q_from, &checks.q_model)?;
        Ok(motion.blocked_by)
    }

    /// Check of a motion on which pairs in contact at its start may come no nearer.
    pub(in crate::arm) fn way_from_contact(
        &self,
        arm: &Arm,
        checks: &mut CollisionWorkspace,
        from: &[f64],
        to: &[f64],
    ) -> Result<MotionCheck, QueryError> {
        checks.set_motion(arm, from, to)?;
        let (exact, from, to) = (&mut checks.exact, &checks.q_from, &checks.q_model);
        Ok(self.checker.way_from_contact(exact, from, to)?)
    }

    /// Fraction of that motion that is free with the larger margin.
    pub(in crate::arm) fn cautious_fraction(
        &self,
        arm: &Arm,
        checks: &mut CollisionWorkspace,
        from: &[f64],
        to: &[f64],
    ) -> Result<f64, QueryError> {
        checks.set_motion(arm, from, to)?;
        let motion =
            self.cautious
                .way_from_contact(&mut checks.exact, &checks.q_from, &checks.q_model)?;
        Ok(motion.free)
    }
}

impl CollisionWorkspace {
    fn set_motion(&mut self, arm: &Arm, from: &[f64], to: &[f64]) -> Result<(), QueryError> {
        self.q_from.clone_from(&self.q_model);
        arm.configuration(from, &mut self.q_from)?;
        arm.configuration(to, &mut self.q_model)
    }
}
