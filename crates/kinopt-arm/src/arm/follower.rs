//! Path follower: one step of a path per target.
//!
//! A step begins at an extrapolation: most of the last motion is added again, scaled by the motion of the target. That
//! leads straight through singular configurations where branches meet. The null-space part of a redundant arm's motion
//! goes to the [nominal posture](super::redundancy) instead. The solver corrects the pose.

use super::QueryError;
use super::arm::Arm;
use super::branch::Branch;
#[cfg(feature = "collision")]
use super::collision_avoidance::path_steps::avoid_step_collision;
use super::distances::{MAX_JOINT_STEP, largest_joint_move, pose_distance};
use super::move_bounds::bound_by_limits;
use super::query::Query;
use super::recording::{judge, record, record_configuration, result_of};
use super::redundancy::{MAX_NULL_SPACE_STEP, STEP_FRACTION};
use super::solve_query::solve_query;
use super::step_subdivision::{
    advance_in_small_steps, descend_on_branch, jump_to_solution, steps_by_simd_solver,
};
use super::workspace::Errors;
use kinopt_kinematics::spatial::Placement;
use kinopt_solver::ik::{JointJump, Solution};
use kinopt_solver::search::SearchResult;
use kinopt_solver::solver::Termination;

/// Fraction of the last motion with which a step begins; below 1, so that null-space motion decays.
const EXTRAPOLATION_FACTOR: f64 = 0.8;
/// Distance between successive targets beyond which small steps are made, radians.
const MAX_TARGET_DISTANCE: f64 = 0.05;
/// Longest path step that counts towards the attraction of another path, radians.
const MAX_ATTRACTED_PATH: f64 = 0.1;

/// Follower of a path whose targets arrive one at a time: see [`Arm::follower`].
#[derive(Clone, Debug)]
pub struct Follower<'a> {
    arm: &'a Arm,
    /// Configuration at the end of the last step.
    q: Vec<f64>,
    /// Configuration at the end of the step before.
    previous_q: Vec<f64>,
    attempt_start: Vec<f64>,
    /// Motion with which a step begins, radians per joint.
    motion: Vec<f64>,
    branch: Branch,
    target: Option<Placement<f64>>,
    /// Distance between the last two targets, radians.
    target_step: f64,
    steps: usize,
}

impl<'a> Follower<'a> {
    /// Follower of an arm at a validated start.
    pub(super) fn new(arm: &'a Arm, start: &[f64]) -> Self {
        Self {
            arm,
            q: start.to_vec(),
            previous_q: start.to_vec(),
            attempt_start: start.to_vec(),
            motion: vec![0.0; start.len()],
            branch: Branch::begin(arm, start),
            target: None,
            target_step: 0.0,
            steps: 0,
        }
    }
}

impl Follower<'_> {
    /// Configuration at the end of the last step.
    #[must_use]
    pub fn q(&self) -> &[f64] {
        &self.q
    }

    /// Advances to the next target. Returns the [`JointJump`] of a step in which a joint moves farther than 0.2 rad.
    ///
    /// Prismatic joints count by the [metres that weigh as much](super::ArmBuilder::with_metres_per_radian). Jumps
    /// follow a target that is far from the last one. Reconfigurations are
    /// [enabled](super::ArmBuilder::with_global_search_on_miss) separately. If a step ends short of the closest pose,
    /// the next one continues. Nothing is allocated after the first few steps.
    ///
    /// # Errors
    /// Returns the errors of [`Arm::solve`].
    pub fn advance(
        &mut self,
        base_from_tool: impl Into<Placement<f64>>,
        solution: &mut Solution,
    ) -> Result<Option<JointJump>, QueryError> {
        let target = base_from_tool.into();
        let arm = self.arm;
        arm.check_query(Some(self.steps), &target, &self.q)?;
        if self.is_outside() {
            self.return_to_limits(&target, solution)?;
            return Ok(self.record_step(&target, solution, true));
        }
        self.branch.take_target(self.target == Some(target));
        // After an unreached target branches meet: return in short steps.
        let short_steps = self.branch.near_singularity() && !self.is_far(&target)?;
        let mut continuous = short_steps && self.advance_on_branch(&target, solution)?;
        let is_done = continuous || short_steps && self.branch.is_stretched();
        if !is_done {
            continuous = self.try_branch(&target, None, solution)
                || self.is_far(&target)?
                    && advance_in_small_steps(arm, &target, &self.q, solution)?
                || self.advance_on_branch(&target, solution)?;
        }
        if !solution.reached && arm.options.global_search_on_failure {
            jump_to_solution(arm, &target, &self.q, solution)?;
        }
        #[cfg(feature = "collision")]
        avoid_step_collision(arm, &self.q, &target, solution)?;
        Ok(self.record_step(&target, solution, continuous))
    }

    /// Returns true if a joint is outside its limits, as it may be at the start.
    fn is_outside(&self) -> bool {
        let mut joints = self.arm.limits().zip(&self.q);
        joints.any(|(limits, q)| !limits.contains(*q))
    }

    /// Moves the joints that are outside their limits towards them, by at most [`MAX_JOINT_STEP`]; the other joints
    /// stay.
    fn return_to_limits(
        &mut self,
        target: &Placement<f64>,
        solution: &mut Solution,
    ) -> Result<(), QueryError> {
        let (arm, q) = (self.arm, &self.q);
        arm.with_workspace(|workspace| {
            workspace.set_target(target);
            bound_by_limits(arm, workspace);
            for (i, limits) in arm.limits().enumerate() {
                // Slightly less, so that rounding does not make the step a jump.
                let max_move = (1.0 - 1e-9) * MAX_JOINT_STEP / arm.scale[i];
                workspace.x[i] = q[i] + (limits.clamp(q[i]) - q[i]).clamp(-max_move, max_move);
            }
            let mut result = SearchResult::single_attempt(Termination::IterationLimit, 0);
            judge(arm, workspace, &mut result);
            let mut joints = arm.limits().zip(&workspace.x);
            let inside = joints.all(|(limits, x)| limits.contains(*x));
            result.reached &= inside;
            workspace.errors.reached &= inside;
            record_configuration(arm, &result, workspace, solution);
        })
    }

    /// Advances on the current branch in short steps. Returns true if that reaches the target.
    fn advance_on_branch(
        &mut self,
        target: &Placement<f64>,
        solution: &mut Solution,
    ) -> Result<bool, QueryError> {
        descend_on_branch(self.arm, target, &self.q, &mut self.branch, solution)?;
        Ok(solution.reached)
    }

    /// Records the end of a step. Returns the jump, if it was one.
    fn record_step(
        &mut self,
        target: &Placement<f64>,
        solution: &Solution,
        continuous: bool,
    ) -> Option<JointJump> {
        let (joint, distance) = largest_joint_move(self.arm, &self.q, &solution.q);
        let jump = (distance > MAX_JOINT_STEP).then_some(JointJump {
            index: self.steps,
            joint,
            distance,
            reconfiguration: !continuous,
        });
        self.set_configuration(target, &solution.q);
        if jump.is_some() {
            self.branch.jump_to(&solution.q, solution.reached);
        } else if solution.reached {
            self.branch.end_step_at(self.arm, &solution.q);
        }
        jump
    }

    /// Advances to the first target of a whole path, from a configuration that may be far from it.
    pub(super) fn begin(
        &mut self,
        target: Placement<f64>,
        solution: &mut Solution,
    ) -> Result<Option<JointJump>, QueryError> {
        if !self.is_far(&target)? {
            return self.advance(target, solution);
        }
        let arm = self.arm;
        let continuous = advance_in_small_steps(arm, &target, &self.q, solution)?;
        #[cfg(feature = "collision")]
        let continuous = continuous && arm.touching(&solution.q)?.is_empty();
        if !continuous {
            solve_query(arm, &Query::new(arm, &target, &self.q), solution)?;
        }
        Ok(self.record_step(&target, solution, continuous))
    }

    /// Returns true if a target is far from the last one, or from the tool at the first step.
    fn is_far(&self, target: &Placement<f64>) -> Result<bool, QueryError> {
        let last = match self.target {
            Some(last) => last,
            None => self.arm.base_from_tool(&self.q)?,
        };
        Ok(pose_distance(self.arm, target, &last) > MAX_TARGET_DISTANCE)
    }

    /// Tries to reach a target by one attempt from the extrapolated start. Returns true if it does without a long
    /// motion.
    ///
    /// `towards` attracts the null space to a configuration, each joint by at most the given radians per radian of
    /// path.
    pub(super) fn try_branch(
        &mut self,
        target: &Placement<f64>,
        towards: Option<(&[f64], f64)>,
        solution: &mut Solution,
    ) -> bool {
        let arm = self.arm;
        let (Some(simd_solver), true) = (&arm.simd_solver, steps_by_simd_solver(arm)) else {
            return false;
        };
        self.fill_attempt_start(target, towards);
        solution.q.resize(arm.joint_count(), 0.0);
        let outcome = simd_solver.attempt_from_start(
            target,
            &self.attempt_start,
            arm.deadline(),
            &mut solution.q,
        );
        let is_short_step =
            outcome.reached && largest_joint_move(arm, &self.q, &solution.q).1 <= MAX_JOINT_STEP;
        if is_short_step {
            record(
                arm,
                &result_of(arm, &outcome),
                Errors::of(&outcome),
                solution,
            );
        }
        is_short_step
    }

    /// Records a configuration as the end of a step.
    pub(super) fn set_configuration(&mut self, target: &Placement<f64>, q: &[f64]) {
        let last = self.target.replace(*target);
        self.target_step = last.map_or(0.0, |last| pose_distance(self.arm, target, &last));
        self.previous_q.copy_from_slice(&self.q);
        self.q.copy_from_slice(q);
        self.steps += 1;
    }

    /// Sets the number of steps of the path that are done.
    pub(super) fn set_steps(&mut self, steps: usize) {
        self.steps = steps;
    }

    /// Sets the nominal posture to that of an arm that begins at `start`.
    pub(super) fn set_nominal_posture(&mut self, start: &[f64]) {
        self.branch.set_nominal_posture(self.arm, start);
    }

    /// Computes the start of the next attempt.
    fn fill_attempt_start(&mut self, target: &Placement<f64>, towards: Option<(&[f64], f64)>) {
        self.attempt_start.copy_from_slice(&self.q);
        let Some(last) = &self.target else {
            return;
        };
        let distance = pose_distance(self.arm, target, last);
        let fraction = if self.target_step > 0.0 {
            EXTRAPOLATION_FACTOR * (distance / self.target_step).min(1.0)
        } else {
            0.0
        };
        let scales = &self.arm.scale;
        let motion = self.q.iter().zip(&self.previous_q).zip(scales);
        for (joint_motion, ((q, previous), scale)) in self.motion.iter_mut().zip(motion) {
            let last = q - previous;
            // A jump is not extrapolated.
            *joint_motion = match last.abs() * scale <= MAX_JOINT_STEP {
                true => fraction * last * scale,
                false => 0.0,
            };
        }
        if let Some((attractor, rate)) = towards {
            let rate = rate * distance.min(MAX_ATTRACTED_PATH);
            let differences = attractor.iter().zip(&self.q).zip(scales);
            for (joint_motion, ((attractor, q), scale)) in self.motion.iter_mut().zip(differences) {
                *joint_motion += ((attractor - q) * scale).clamp(-rate, rate);
            }
        } else if self.branch.uses_null_space(self.arm) {
            self.replace_null_space_motion(target);
        }
        let map = &self.arm.serial.map;
        let bounds = map.lower().iter().zip(map.upper());
        let ends = self.motion.iter().zip(scales).zip(bounds);
        for (value, ((joint_motion, scale), (&lower, &upper))) in
            self.attempt_start.iter_mut().zip(ends)
        {
            *value = (*value + joint_motion / scale).max(lower).min(upper);
        }
    }

    /// Replaces the null-space part of the motion by motion to the nominal posture.
    fn replace_null_space_motion(&mut self, target: &Placement<f64>) {
        let (arm, q, motion) = (self.arm, &self.q, &mut self.motion);
        let branch = &mut self.branch;
        // Without a workspace the motion stays; the step itself returns the error.
        let _ = arm.with_workspace(|workspace| {
            workspace.set_target(target);
            bound_by_limits(arm, workspace);
            workspace.compute_twists(arm, q);
            let factorisation = workspace.factor_without_bounds(q);
            match &factorisation {
                Some(factor) => workspace.project_without_bounds(factor, motion),
                None => workspace.project_to_null(q, motion, 0.0),
            };
            for (motion, null_space_motion) in motion.iter_mut().zip(&workspace.projected) {
                *motion -= null_space_motion;
            }
            branch.compute_null_space_step(
                arm,
                workspace,
                q,
                MAX_NULL_SPACE_STEP,
                STEP_FRACTION,
                factorisation.as_ref(),
            );
            for (motion, null_space_motion) in motion.iter_mut().zip(&workspace.projected) {
                *motion += null_space_motion;
            }
        });
    }
}
