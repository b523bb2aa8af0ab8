//! What a path does where a step's own attempt fails.

use super::QueryError;
use super::follower::LONG_STEP;
use super::query::Arm;
use super::report::Reply;
use super::workspace::Workspace;
use crate::ik::Solution;
use crate::lanes::{self, PoseSolver};
use crate::solver::Termination;
use crate::spatial::{Placement, Quaternion, rotation_exp};

/// Fractions of the way to the target that are tried.
const FRACTIONS: usize = 64;
/// The smallest of them.
const SMALLEST: f64 = 1.0 / 128.0;

impl Arm {
    /// Whether steps of a path are the lane engine's alone.
    pub(super) fn follows_by_lanes(&self) -> bool {
        self.options.max_move.is_none() && self.options.posture.is_none()
    }

    /// Finds a solution for a step from `from`; whether small steps lead there.
    pub(super) fn rescue(
        &self,
        target: &Placement<f64>,
        from: &[f64],
        solution: &mut Solution,
    ) -> Result<bool, QueryError> {
        if let (Some(lanes), true) = (&self.lanes, self.follows_by_lanes()) {
            let by_fractions = self.with_workspace(|workspace| {
                workspace.x.copy_from_slice(from);
                let iterations = self.go_by_fractions(workspace, lanes, target)?;
                workspace.aim(target);
                let reply = Reply {
                    errors: workspace.judge_x(),
                    termination: Termination::Reached,
                    iterations,
                    attempts: 1,
                };
                self.report_workspace(&reply, workspace, solution);
                solution.reached.then_some(())
            })?;
            if by_fractions.is_some() {
                return Ok(true);
            }
        }
        self.answer(target, from, true, solution)?;
        Ok(false)
    }

    /// Other solutions of a pose, nearest to `from` first.
    pub(super) fn landings(
        &self,
        target: &Placement<f64>,
        from: &[f64],
        count: usize,
    ) -> Result<Vec<Solution>, QueryError> {
        if !self.follows_by_lanes() {
            return Ok(Vec::new());
        }
        let deadline = self.deadline();
        self.with_workspace(|workspace| {
            workspace.aim(target);
            self.open_window(workspace, from);
            self.gather(workspace, target, from, deadline);
            self.distinct(workspace, count, LONG_STEP, Termination::Reached)
        })
    }

    /// Goes from the workspace's x to the target by fractions of the straight way between the
    /// poses, each without a long move; the iterations that took, none if it ends half-way.
    fn go_by_fractions(
        &self,
        workspace: &mut Workspace,
        lanes: &PoseSolver,
        target: &Placement<f64>,
    ) -> Option<usize> {
        let origin = self.base_from_tool(&workspace.x).ok()?;
        let turn = Quaternion::from_matrix(&(origin.rotation.transpose() * target.rotation)).log();
        let way = target.translation - origin.translation;
        let (mut done, mut fraction, mut iterations) = (0.0_f64, 0.5, 0);
        for _ in 0..FRACTIONS {
            let to = (done + fraction).min(1.0);
            let pose = if to < 1.0 {
                Placement::new(
                    origin.rotation * rotation_exp(turn * to),
                    origin.translation + way * to,
                )
            } else {
                *target
            };
            let Workspace { x, trial, .. } = workspace;
            let search = lanes::Search::Start;
            let outcome = lanes.solve_checked(&pose, x, search, 1, None, true, trial);
            iterations += outcome.iterations as usize;
            if outcome.reached && self.longest_move(x, trial).1 <= 0.5 * LONG_STEP {
                x.copy_from_slice(trial);
                done = to;
                fraction *= 2.0;
            } else {
                fraction *= 0.5;
            }
            if done >= 1.0 {
                return Some(iterations);
            }
            if fraction < SMALLEST {
                return None;
            }
        }
        None
    }
}
