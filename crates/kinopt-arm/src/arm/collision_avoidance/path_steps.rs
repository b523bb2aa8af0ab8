//! Steps of a path that stop before a collision.

use super::avoidance::CollisionAvoidance;
use super::checks::with_collision_workspace;
use super::null_space_avoidance::perturb_in_null_space;
use super::workspace::CollisionWorkspace;
use crate::arm::QueryError;
use crate::arm::arm::Arm;
use crate::arm::distances::{MAX_JOINT_STEP, largest_joint_move};
use crate::arm::move_bounds::bound_by_limits;
use crate::arm::recording::{judge, record_configuration};
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

/// Avoids a collision on a step of a path by null-space motion, or cuts the step short before it.
///
/// The solution then lists the collision, or the pairs that are still in contact.
pub(in crate::arm) fn avoid_step_collision(
    arm: &Arm,
    from: &[f64],
    target: &Placement<f64>,
    solution: &mut Solution,
) -> Result<(), QueryError> {
    let Some(avoidance) = &arm.collisions else {
        return Ok(());
    };
    with_collision_workspace(arm, avoidance, |workspace, checks| {
        let motion = avoidance.way_from_contact(arm, checks, from, &solution.q)?;
        let begins_in_contact = motion.begins_touching();
        if let Some(collision) = motion.blocked_by {
            workspace.set_target(target);
            bound_by_limits(arm, workspace);
            let found_detour = solution.reached
                && find_detour_in_null_space(arm, avoidance, workspace, checks, from)?;
            if !found_detour {
                let fraction = avoidance.cautious_fraction(arm, checks, from, &solution.q)?;
                let ends = from.iter().zip(&solution.q);
                for (x, (from, to)) in workspace.x.iter_mut().zip(ends) {
                    *x = from + fraction * (to - from);
                }
            }
            let mut result =
                SearchResult::single_attempt(Termination::CannotContinue, solution.iterations);
            judge(arm, workspace, &mut result);
            record_configuration(arm, &result, workspace, solution);
            if !found_detour {
                solution.set_collisions(vec![collision]);
            }
        }
        if begins_in_contact && solution.collisions().is_empty() {
            let contacts = avoidance.collisions(arm, checks, &solution.q)?;
            solution.set_collisions(contacts);
        }
        Ok(())
    })
}

/// Looks for another configuration near `from` that reaches the target, by null-space motion.
///
/// Leaves the nearest one with a collision-free motion in the workspace's x. Returns true if there is one.
fn find_detour_in_null_space(
    arm: &Arm,
    avoidance: &CollisionAvoidance,
    workspace: &mut ArmWorkspace,
    checks: &mut CollisionWorkspace,
    from: &[f64],
) -> Result<bool, QueryError> {
    let Some(simd_solver) = arm.simd_solver.as_ref().filter(|_| arm.has_null_space()) else {
        return Ok(false);
    };
    workspace.compute_twists(arm, from);
    let n = arm.joint_count();
    let mut q = vec![0.0; n];
    // One deadline for all attempts.
    let deadline = arm.deadline();
    let mut best = f64::INFINITY;
    for joint in 0..n {
        for displacement in AVOIDANCE_MOTIONS {
            if is_past(deadline) {
                return Ok(best.is_finite());
            }
            if !perturb_in_null_space(arm, workspace, from, joint, displacement) {
                continue;
            }
            let target = workspace.target();
            let outcome =
                simd_solver.attempt_from_start(&target, &workspace.trial, deadline, &mut q);
            let (_, distance) = largest_joint_move(arm, from, &q);
            let is_nearer = outcome.reached && distance <= MAX_JOINT_STEP && distance < best;
            let is_free = |checks: &mut CollisionWorkspace| -> Result<bool, QueryError> {
                let motion = avoidance.way_from_contact(arm, checks, from, &q)?;
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
