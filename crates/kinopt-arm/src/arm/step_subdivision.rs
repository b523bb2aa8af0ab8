//! Fallbacks of a path step whose attempt fails.

use super::QueryError;
use super::arm::Arm;
use super::branch::Branch;
use super::follower::{MAX_JOINT_STEP, MAX_NULL_SPACE_STEP};
use super::local_descent::LocalDescent;
use super::workspace::ArmWorkspace;
use crate::simd_ik::PoseSolver;
use kinopt_kinematics::spatial::{Placement, Quaternion, rotation_exp};
use kinopt_solver::ik::Solution;
use kinopt_solver::search::SearchResult;
use kinopt_solver::solver::Termination;

/// Largest number of fractions of the motion to the target that are tried.
const MAX_FRACTIONS: usize = 64;
/// Smallest fraction.
const MIN_FRACTION: f64 = 1.0 / 128.0;
/// Longest joint motion of a step by local descent, radians.
const DESCENT_JOINT_STEP: f64 = 0.5 * MAX_JOINT_STEP;
/// Largest number of steps of one descent; the next target continues from there.
const MAX_DESCENT_STEPS: usize = 60;

impl Arm {
    /// Returns true if the SIMD solver alone makes the steps of a path.
    pub(super) fn steps_by_simd_solver(&self) -> bool {
        self.options.max_move.is_none() && self.options.posture.is_none()
    }

    /// Advances to a target on the arm's branch without a long motion: to a solution or to the closest pose.
    pub(super) fn descend_on_branch(
        &self,
        target: &Placement<f64>,
        from: &[f64],
        branch: &mut Branch,
        solution: &mut Solution,
    ) -> Result<(), QueryError> {
        let deadline = self.deadline();
        self.with_workspace(|workspace| {
            workspace.set_target(target);
            self.bound_step(workspace, from, DESCENT_JOINT_STEP);
            workspace.x.copy_from_slice(&workspace.start);
            branch.begin_step(self, workspace, MAX_NULL_SPACE_STEP);
            let descent = LocalDescent::without_anchor(MAX_DESCENT_STEPS, deadline);
            let (termination, iterations) = workspace.descend(&descent);
            let mut result = SearchResult::single_attempt(termination, iterations);
            self.judge(workspace, &mut result);
            if let (true, Some(posture)) = (result.reached, &self.options.posture) {
                self.move_towards_posture(workspace, posture, deadline);
                self.judge(workspace, &mut result);
            }
            branch.end_step(self, workspace, result.reached);
            result.termination =
                self.final_termination(&result, termination == Termination::TimeLimit);
            self.record_configuration(&result, workspace, solution);
        })
    }

    /// Advances to a target far from the last one, by small steps along the straight line between the poses.
    ///
    /// Returns true if they reach it.
    pub(super) fn advance_in_small_steps(
        &self,
        target: &Placement<f64>,
        from: &[f64],
        solution: &mut Solution,
    ) -> Result<bool, QueryError> {
        let (Some(simd_solver), true) = (&self.simd_solver, self.steps_by_simd_solver()) else {
            return Ok(false);
        };
        self.with_workspace(|workspace| {
            workspace.x.copy_from_slice(from);
            let Some(iterations) = self.advance_by_fractions(workspace, simd_solver, target) else {
                return false;
            };
            workspace.set_target(target);
            let mut result = SearchResult {
                termination: Termination::Reached,
                iterations,
                attempts: 1,
                ..SearchResult::default()
            };
            self.judge(workspace, &mut result);
            self.record_configuration(&result, workspace, solution);
            solution.reached
        })
    }

    /// Jumps to the nearest solution on any branch, or if there is none to the best of all attempts.
    pub(super) fn jump_to_solution(
        &self,
        target: &Placement<f64>,
        from: &[f64],
        solution: &mut Solution,
    ) -> Result<(), QueryError> {
        self.solve_query(&self.query(target, from), solution)?;
        if !(solution.reached && self.steps_by_simd_solver()) {
            return Ok(());
        }
        // The attempt from the start may have led far away.
        let query = self.query(target, from);
        self.with_workspace(|workspace| {
            workspace.set_target(target);
            self.bound_moves(workspace, from);
            self.collect_solutions(workspace, &query);
            let result = self.nearest(workspace, &query, Termination::Reached);
            let known_distance = self.distance(&solution.q, &workspace.start);
            if result.reached && self.distance(&workspace.x, &workspace.start) < known_distance {
                self.record_configuration(&result, workspace, solution);
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
        if !self.steps_by_simd_solver() {
            return Ok(Vec::new());
        }
        let query = self.query(target, from);
        self.with_workspace(|workspace| {
            workspace.set_target(target);
            self.bound_moves(workspace, from);
            self.collect_solutions(workspace, &query);
            #[cfg(feature = "collision")]
            self.drop_colliding(workspace, &query)?;
            Ok(self.distinct(workspace, count, MAX_JOINT_STEP, Termination::Reached))
        })?
    }

    /// Moves the workspace's x to the target by fractions of the straight line between the poses, without a long
    /// motion.
    ///
    /// Returns the number of iterations, or `None` if it does not arrive.
    fn advance_by_fractions(
        &self,
        workspace: &mut ArmWorkspace,
        simd_solver: &PoseSolver,
        target: &Placement<f64>,
    ) -> Option<usize> {
        let origin = self.base_from_tool(&workspace.x).ok()?;
        let rotation =
            Quaternion::from_matrix(&(origin.rotation.transpose() * target.rotation)).log();
        let translation = target.translation - origin.translation;
        let (mut done_fraction, mut fraction, mut iterations) = (0.0_f64, 0.5, 0);
        for _ in 0..MAX_FRACTIONS {
            let target_fraction = (done_fraction + fraction).min(1.0);
            let pose = if target_fraction < 1.0 {
                Placement::new(
                    origin.rotation * rotation_exp(rotation * target_fraction),
                    origin.translation + translation * target_fraction,
                )
            } else {
                *target
            };
            let ArmWorkspace { x, trial, .. } = workspace;
            let outcome = simd_solver.attempt_from_start(&pose, x, None, trial);
            iterations += outcome.iterations as usize;
            if outcome.reached && self.largest_joint_move(x, trial).1 <= DESCENT_JOINT_STEP {
                x.copy_from_slice(trial);
                done_fraction = target_fraction;
                fraction *= 2.0;
            } else {
                fraction *= 0.5;
            }
            if done_fraction >= 1.0 {
                return Some(iterations);
            }
            if fraction < MIN_FRACTION {
                return None;
            }
        }
        None
    }
}
