//! Steps of a path that stop before a collision.

use super::{CollisionAvoidance, CollisionWorkspace};
use crate::arm::QueryError;
use crate::arm::arm::Arm;
use crate::arm::follower::LONG_STEP;
use crate::arm::workspace::ArmWorkspace;
use crate::clock::is_past;
use crate::collision::MotionCheck;
use crate::ik::Solution;
use crate::search::{Collision, SearchResult};
use crate::solver::Termination;
use crate::spatial::Placement;

/// Distance before the margin at which a shortened step stops, metres, so that the next one can leave.
pub(super) const STAND_OFF: f64 = 1e-4;
/// Null-space motions that are tried to avoid an obstacle in one step, radians.
const DODGES: [f64; 3] = [0.04, 0.12, -0.04];

impl Arm {
    /// Avoids a collision on a step of a path by null-space motion, or cuts the step short before it.
    ///
    /// The solution then lists the collision, or the pairs that are still in contact.
    pub(in crate::arm) fn keep_way_clear(
        &self,
        from: &[f64],
        target: &Placement<f64>,
        solution: &mut Solution,
    ) -> Result<(), QueryError> {
        let Some(kept) = &self.collisions else {
            return Ok(());
        };
        self.with_room(kept, |workspace, room| {
            let way = kept.way_from_contact(self, room, from, &solution.q)?;
            let touches = way.begins_touching();
            if let Some(by) = way.blocked_by {
                workspace.aim(target);
                self.bound_by_limits(workspace);
                let round =
                    solution.reached && self.go_round_obstacle(kept, workspace, room, from)?;
                if !round {
                    let share = kept.cautious_share(self, room, from, &solution.q)?;
                    let ways = from.iter().zip(&solution.q);
                    for (x, (from, to)) in workspace.x.iter_mut().zip(ways) {
                        *x = from + share * (to - from);
                    }
                }
                let mut found =
                    SearchResult::single_attempt(Termination::CannotContinue, solution.iterations);
                self.judge(workspace, &mut found);
                self.record_configuration(&found, workspace, solution);
                if !round {
                    solution.set_collisions(vec![by]);
                }
            }
            if touches && solution.collisions().is_empty() {
                let touching = kept.collisions(self, room, &solution.q)?;
                solution.set_collisions(touching);
            }
            Ok(())
        })
    }

    /// Looks for another configuration near `from` that reaches the target, by null-space motion.
    ///
    /// Leaves the nearest one with a collision-free motion in the workspace's x. Returns true if there is one.
    fn go_round_obstacle(
        &self,
        kept: &CollisionAvoidance,
        workspace: &mut ArmWorkspace,
        room: &mut CollisionWorkspace,
        from: &[f64],
    ) -> Result<bool, QueryError> {
        let Some(lanes) = self.lanes.as_ref().filter(|_| self.has_freedom()) else {
            return Ok(false);
        };
        workspace.take_twists(self, from);
        let n = self.joint_count();
        let mut q = vec![0.0; n];
        // One deadline for all attempts.
        let deadline = self.deadline();
        let mut best = f64::INFINITY;
        for joint in 0..n {
            for by in DODGES {
                if is_past(deadline) {
                    return Ok(best.is_finite());
                }
                if !self.stand_beside(workspace, from, joint, by) {
                    continue;
                }
                let target = workspace.target();
                let outcome = lanes.attempt_from_start(&target, &workspace.trial, deadline, &mut q);
                let (_, distance) = self.longest_move(from, &q);
                let near = outcome.reached && distance <= LONG_STEP && distance < best;
                let is_open = |room: &mut CollisionWorkspace| -> Result<bool, QueryError> {
                    let way = kept.way_from_contact(self, room, from, &q)?;
                    Ok(way.blocked_by.is_none())
                };
                if near && is_open(room)? {
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
        room: &mut CollisionWorkspace,
        from: &[f64],
        to: &[f64],
    ) -> Result<Option<Collision>, QueryError> {
        room.take_way(arm, from, to)?;
        let way = self
            .checker
            .check_motion(&mut room.exact, &room.q_from, &room.q_model)?;
        Ok(way.blocked_by)
    }

    /// Check of a motion on which pairs in contact at its start may come no nearer.
    pub(in crate::arm) fn way_from_contact(
        &self,
        arm: &Arm,
        room: &mut CollisionWorkspace,
        from: &[f64],
        to: &[f64],
    ) -> Result<MotionCheck, QueryError> {
        room.take_way(arm, from, to)?;
        let (exact, from, to) = (&mut room.exact, &room.q_from, &room.q_model);
        Ok(self.checker.way_from_contact(exact, from, to)?)
    }

    /// Fraction of that motion that is free with the larger margin.
    pub(in crate::arm) fn cautious_share(
        &self,
        arm: &Arm,
        room: &mut CollisionWorkspace,
        from: &[f64],
        to: &[f64],
    ) -> Result<f64, QueryError> {
        room.take_way(arm, from, to)?;
        let way = self
            .cautious
            .way_from_contact(&mut room.exact, &room.q_from, &room.q_model)?;
        Ok(way.free)
    }
}

impl CollisionWorkspace {
    fn take_way(&mut self, arm: &Arm, from: &[f64], to: &[f64]) -> Result<(), QueryError> {
        self.q_from.clone_from(&self.q_model);
        arm.configuration(from, &mut self.q_from)?;
        arm.configuration(to, &mut self.q_model)
    }
}
