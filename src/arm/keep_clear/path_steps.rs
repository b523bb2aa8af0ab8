//! Steps of a path that stop before they touch.

use super::{ClearRoom, KeepClear};
use crate::arm::Reply;
use crate::arm::arm::Arm;
use crate::arm::follower::LONG_STEP;
use crate::arm::workspace::ArmWorkspace;
use crate::clock::is_past;
use crate::collision::Way;
use crate::ik::Solution;
use crate::search::{Collision, Found};
use crate::solver::Termination;
use crate::spatial::Placement;

/// A step that is cut short stops so far before the margin, metres, so that the next one can leave.
pub(super) const STAND_OFF: f64 = 1e-4;
/// How far freedom is spent to go round something in one step, radians.
const DODGES: [f64; 3] = [0.04, 0.12, -0.04];

impl Arm {
    /// Cuts a step of a path short before something touches on the way, or goes round it by the freedom that the target leaves;
    /// what is in the way is told, and what touches still that touched before.
    pub(in crate::arm) fn keep_way_clear(
        &self,
        from: &[f64],
        target: &Placement<f64>,
        solution: &mut Solution,
    ) -> Reply<()> {
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
                let mut found = Found::alone(Termination::CannotContinue, solution.iterations);
                self.judge(workspace, &mut found);
                self.tell_place(&found, workspace, solution);
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

    /// Looks for a place near `from` that reaches the target by another way of spending the freedom; the nearest whose way is
    /// free is then in the workspace's x.
    fn go_round_obstacle(
        &self,
        kept: &KeepClear,
        workspace: &mut ArmWorkspace,
        room: &mut ClearRoom,
        from: &[f64],
    ) -> Reply<bool> {
        let Some(lanes) = self.lanes.as_ref().filter(|_| self.has_freedom()) else {
            return Ok(false);
        };
        workspace.take_twists(self, from);
        let n = self.joint_count();
        let mut q = vec![0.0; n];
        // One for all of them, not one each.
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
                let outcome = lanes.own_attempt(&target, &workspace.trial, deadline, &mut q);
                let (_, distance) = self.longest_move(from, &q);
                let near = outcome.reached && distance <= LONG_STEP && distance < best;
                let is_open = |room: &mut ClearRoom| -> Reply<bool> {
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

impl KeepClear {
    /// What is in the way from one configuration of the arm to another, on which all joints move evenly.
    pub(in crate::arm) fn blocked(
        &self,
        arm: &Arm,
        room: &mut ClearRoom,
        from: &[f64],
        to: &[f64],
    ) -> Reply<Option<Collision>> {
        room.take_way(arm, from, to)?;
        let way = self
            .checker
            .way(&mut room.exact, &room.q_from, &room.q_model)?;
        Ok(way.blocked_by)
    }

    /// The way on which what touches where it begins comes no nearer.
    pub(in crate::arm) fn way_from_contact(
        &self,
        arm: &Arm,
        room: &mut ClearRoom,
        from: &[f64],
        to: &[f64],
    ) -> Reply<Way> {
        room.take_way(arm, from, to)?;
        let (exact, from, to) = (&mut room.exact, &room.q_from, &room.q_model);
        Ok(self.checker.way_from_contact(exact, from, to)?)
    }

    /// How much of that way is free with room to spare.
    pub(in crate::arm) fn cautious_share(
        &self,
        arm: &Arm,
        room: &mut ClearRoom,
        from: &[f64],
        to: &[f64],
    ) -> Reply<f64> {
        room.take_way(arm, from, to)?;
        let way = self
            .cautious
            .way_from_contact(&mut room.exact, &room.q_from, &room.q_model)?;
        Ok(way.free)
    }
}

impl ClearRoom {
    fn take_way(&mut self, arm: &Arm, from: &[f64], to: &[f64]) -> Reply<()> {
        self.q_from.clone_from(&self.q_model);
        arm.configuration(from, &mut self.q_from)?;
        arm.configuration(to, &mut self.q_model)
    }
}
