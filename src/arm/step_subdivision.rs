//! Fallbacks of a path step whose attempt fails.

use super::QueryError;
use super::arm::Arm;
use super::branch::Branch;
use super::follower::{LONG_STEP, LONGEST_EASE};
use super::local_descent::Settling;
use super::workspace::ArmWorkspace;
use crate::ik::Solution;
use crate::search::SearchResult;
use crate::simd_ik::PoseSolver;
use crate::solver::Termination;
use crate::spatial::{Placement, Quaternion, rotation_exp};

/// Largest number of fractions of the motion to the target that are tried.
const FRACTIONS: usize = 64;
/// Smallest fraction.
const SMALLEST: f64 = 1.0 / 128.0;
/// Longest joint motion of a step by local descent, radians.
const SETTLING_STEP: f64 = 0.5 * LONG_STEP;
/// Largest number of steps of one descent; the next target continues from there.
const SETTLING_STEPS: usize = 60;

impl Arm {
    /// Returns true if the SIMD solver alone makes the steps of a path.
    pub(super) fn follows_by_lanes(&self) -> bool {
        self.options.max_move.is_none() && self.options.posture.is_none()
    }

    /// Advances to a target on the arm's branch without a long motion: to a solution or to the closest pose.
    pub(super) fn keep_to_branch(
        &self,
        target: &Placement<f64>,
        from: &[f64],
        branch: &mut Branch,
        solution: &mut Solution,
    ) -> Result<(), QueryError> {
        let deadline = self.deadline();
        self.with_workspace(|workspace| {
            workspace.aim(target);
            self.bound_step(workspace, from, SETTLING_STEP);
            workspace.x.copy_from_slice(&workspace.start);
            branch.lead(self, workspace, LONGEST_EASE);
            let how = Settling::freely(SETTLING_STEPS, deadline);
            let (termination, iterations) = workspace.settle_near(&how);
            let mut found = SearchResult::single_attempt(termination, iterations);
            self.judge(workspace, &mut found);
            if let (true, Some(posture)) = (found.reached, &self.options.posture) {
                self.descend(workspace, posture, deadline);
                self.judge(workspace, &mut found);
            }
            branch.arrive(self, workspace, found.reached);
            found.termination = self.ended(&found, termination == Termination::TimeLimit);
            self.record_configuration(&found, workspace, solution);
        })
    }

    /// Advances to a target far from the last one, by small steps along the straight line between the poses.
    ///
    /// Returns true if they reach it.
    pub(super) fn go_far(
        &self,
        target: &Placement<f64>,
        from: &[f64],
        solution: &mut Solution,
    ) -> Result<bool, QueryError> {
        let (Some(lanes), true) = (&self.lanes, self.follows_by_lanes()) else {
            return Ok(false);
        };
        self.with_workspace(|workspace| {
            workspace.x.copy_from_slice(from);
            let Some(iterations) = self.go_by_fractions(workspace, lanes, target) else {
                return false;
            };
            workspace.aim(target);
            let mut found = SearchResult {
                termination: Termination::Reached,
                iterations,
                attempts: 1,
                ..SearchResult::default()
            };
            self.judge(workspace, &mut found);
            self.record_configuration(&found, workspace, solution);
            solution.reached
        })
    }

    /// Jumps to the nearest solution on any branch, or if there is none to the best of all attempts.
    pub(super) fn leap(
        &self,
        target: &Placement<f64>,
        from: &[f64],
        solution: &mut Solution,
    ) -> Result<(), QueryError> {
        self.answer(&self.query(target, from), solution)?;
        if !(solution.reached && self.follows_by_lanes()) {
            return Ok(());
        }
        // The attempt from the start may have led far away.
        let query = self.query(target, from);
        self.with_workspace(|workspace| {
            workspace.aim(target);
            self.bound_moves(workspace, from);
            self.gather(workspace, &query);
            let found = self.nearest(workspace, &query, Termination::Reached);
            let known = self.distance(&solution.q, &workspace.start);
            if found.reached && self.distance(&workspace.x, &workspace.start) < known {
                self.record_configuration(&found, workspace, solution);
            }
        })
    }

    /// Other solutions of a pose, nearest to `from` first.
    pub(super) fn other_solutions(
        &self,
        target: &Placement<f64>,
        from: &[f64],
        count: usize,
    ) -> Result<Vec<Solution>, QueryError> {
        if !self.follows_by_lanes() {
            return Ok(Vec::new());
        }
        let query = self.query(target, from);
        self.with_workspace(|workspace| {
            workspace.aim(target);
            self.bound_moves(workspace, from);
            self.gather(workspace, &query);
            #[cfg(feature = "collision")]
            self.drop_touching(workspace, &query)?;
            Ok(self.distinct(workspace, count, LONG_STEP, Termination::Reached))
        })?
    }

    /// Moves the workspace's x to the target by fractions of the straight line between the poses, without a long
    /// motion.
    ///
    /// Returns the number of iterations, or `None` if it does not arrive.
    fn go_by_fractions(
        &self,
        workspace: &mut ArmWorkspace,
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
            let ArmWorkspace { x, trial, .. } = workspace;
            let outcome = lanes.attempt_from_start(&pose, x, None, trial);
            iterations += outcome.iterations as usize;
            if outcome.reached && self.longest_move(x, trial).1 <= SETTLING_STEP {
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
