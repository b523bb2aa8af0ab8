//! Commanded motion of a drag within limits of velocity, acceleration and jerk.
//!
//! Each variable of a revolute or prismatic joint follows its goal by [`JointMotion`]. For a ball joint, three
//! components of a rotation vector in its own axes do. Each component has 1/√3 of the limits, so that the norm is
//! within them. The vector of a frame is the rotation from the last orientation to the next.

use super::drag_frame::{MAX_REST_MOVE, solve};
use super::{MotionLimits, Restarts, Solution, SolveError, Solver, Workspace};
use crate::motion_limits::{CycleLimits, GoalHistory, JointMotion};
use crate::problem::{Problem, ProblemInstance};
use crate::solver::Stopping;
use kinopt_kinematics::bad_option::{ABOVE_0, AT_LEAST_0, BadOption, POSITIVE, Range};
use kinopt_kinematics::spatial::{Quaternion, Vector3};

/// Step of a variable without a velocity limit in a frame, radians or metres. It exceeds any displacement of a goal.
const UNLIMITED_STEP: f64 = 1e3;

/// Fraction of a limit for each of three rates, so that their norm is within the limit: 1/√3, rounded down.
const FRACTION_PER_COMPONENT: f64 = 0.577_350_269;

/// Ball joint of the commanded motion.
#[derive(Clone, Debug)]
struct CommandedBall {
    /// First of its three variables.
    first: usize,
    orientation: Quaternion<f64>,
    goal: Quaternion<f64>,
}

/// Commanded motion of a drag.
#[derive(Clone, Debug)]
pub(super) struct DragMotion {
    /// Largest step of each variable in a frame; for a ball joint the whole angle. All lists are by variable.
    largest_steps: Vec<f64>,
    limits: Vec<CycleLimits>,
    /// Motion of each variable. The position of a ball joint's variables is relative to its orientation, so it is zero.
    joints: Vec<JointMotion>,
    balls: Vec<CommandedBall>,
    /// Goals by variable; for a ball joint the sum of its goal's rotation vectors over all frames.
    goals: Vec<f64>,
    history: GoalHistory,
    /// Goals by variable; for a ball joint the rotation vector from its orientation to the goal.
    towards: Vec<f64>,
    x: Vec<f64>,
    q: Vec<f64>,
    evaluator: Solver,
    workspace: Workspace,
}

impl DragMotion {
    pub(super) fn new(
        problem: &Problem,
        time_step: f64,
        motion_limits: &MotionLimits,
        x: &[f64],
    ) -> Result<Self, SolveError> {
        BadOption::check("time_step", time_step, POSITIVE)?;
        let unsupported = |reason: String| Err(SolveError::UnsupportedTimeStep { reason });
        if problem.collision_constraint().is_some() {
            return unsupported("collisions to avoid".to_owned());
        }
        for ball in problem.parameters().balls() {
            if ball.swing.is_some() || ball.angle.is_some() {
                let joint = &problem.names().joints[ball.variable];
                return unsupported(format!("bounded ball joint `{joint}`"));
            }
        }
        let velocity = by_variable(
            problem,
            "velocity_limits",
            &motion_limits.velocity,
            AT_LEAST_0,
        )?;
        let acceleration = by_variable(
            problem,
            "acceleration_limits",
            &motion_limits.acceleration,
            ABOVE_0,
        )?;
        let jerk = by_variable(problem, "jerk_limits", &motion_limits.jerk, ABOVE_0)?;
        let n = problem.variables();
        let mut is_ball = vec![false; n];
        for ball in problem.parameters().balls() {
            is_ball[ball.variable..ball.variable + 3].fill(true);
        }
        let limits = (0..n).map(|j| {
            let is_base_translation =
                problem.is_base_variable(j) && !problem.names().variable_is_angle[j];
            let fraction = match is_base_translation || is_ball[j] {
                true => FRACTION_PER_COMPONENT,
                false => 1.0,
            };
            let (lower, upper) = match is_ball[j] {
                true => (f64::NEG_INFINITY, f64::INFINITY),
                false => (problem.lower()[j], problem.upper()[j]),
            };
            let rates = [velocity[j], acceleration[j], jerk[j]].map(|limit| fraction * limit);
            CycleLimits::new([lower, upper], x[j], time_step, rates, UNLIMITED_STEP)
        });
        let limits: Vec<CycleLimits> = limits.collect();
        let stopping = Stopping::default().with_max_iterations(0);
        let evaluator = Solver::default().with_stopping(stopping);
        let mut motion = Self {
            largest_steps: limits.iter().map(|limits| limits.step).collect(),
            limits,
            joints: vec![JointMotion::default(); n],
            balls: Vec::new(),
            goals: vec![0.0; n],
            history: GoalHistory::resting_at(&vec![0.0; n]),
            towards: vec![0.0; n],
            x: vec![0.0; n],
            q: vec![0.0; problem.configuration_len()],
            evaluator: evaluator.with_restarts(Restarts::none()),
            workspace: Workspace::new(),
        };
        motion.rest_at(problem, x);
        Ok(motion)
    }

    #[must_use]
    pub(super) fn q(&self) -> &[f64] {
        &self.q
    }

    #[must_use]
    pub(super) fn solution(&self) -> &Solution {
        &self.workspace.solution
    }

    /// Largest steps of the goal in a frame, by variable.
    #[must_use]
    pub(super) fn largest_steps(&self) -> &[f64] {
        &self.largest_steps
    }

    /// Restarts at rest at `x`.
    pub(super) fn rest_at(&mut self, problem: &Problem, x: &[f64]) {
        self.x.copy_from_slice(x);
        self.goals.copy_from_slice(x);
        for (joint, x) in self.joints.iter_mut().zip(x) {
            *joint = JointMotion::at_rest(*x);
        }
        self.balls.clear();
        for ball in problem.parameters().balls() {
            let ball_range = ball.variable..ball.variable + 3;
            self.joints[ball_range.clone()].fill(JointMotion::default());
            self.goals[ball_range].fill(0.0);
            let orientation = ball.chart.rotation(ball.of(x).unwrap_or_default());
            self.balls.push(CommandedBall {
                first: ball.variable,
                orientation,
                goal: orientation,
            });
        }
        self.history.rest_at(&self.goals);
        let map = problem.parameters();
        map.scatter_within_limits(&self.x, &mut self.q);
    }

    /// Moves one frame towards a goal.
    pub(super) fn follow(&mut self, problem: &Problem, goal: &[f64]) {
        let map = problem.parameters();
        for (k, goal) in goal.iter().enumerate() {
            if !self.is_of_ball(k) {
                self.goals[k] = *goal;
            }
        }
        for (joint_ball, ball) in self.balls.iter_mut().zip(map.balls()) {
            let next = ball.chart.rotation(ball.of(goal).unwrap_or_default());
            let rotation = (joint_ball.goal.conjugate() * next).log();
            joint_ball.goal = next;
            for (value, rotation) in self.goals[joint_ball.first..]
                .iter_mut()
                .zip(rotation.to_array())
            {
                *value += rotation;
            }
        }
        self.history.push(&self.goals);
        self.towards.copy_from_slice(&self.goals);
        for joint_ball in &self.balls {
            let rotation_left = (joint_ball.orientation.conjugate() * joint_ball.goal).log();
            self.towards[joint_ball.first..joint_ball.first + 3]
                .copy_from_slice(&rotation_left.to_array());
        }
        for (j, joint) in self.joints.iter_mut().enumerate() {
            let limits = &self.limits[j];
            let range = joint.viable_changes(limits);
            let motion = self.history.motions()[j];
            let (change, _) = joint.change_to_meet(self.towards[j], range, motion, limits);
            *joint = joint.after(change).within(limits);
            self.x[j] = joint.q;
        }
        for (joint_ball, ball) in self.balls.iter_mut().zip(map.balls()) {
            let ball_range = joint_ball.first..joint_ball.first + 3;
            let steps = &mut self.joints[ball_range.clone()];
            let step = Vector3::new(steps[0].step, steps[1].step, steps[2].step);
            joint_ball.orientation = unit(joint_ball.orientation * Quaternion::exp(step));
            for joint in steps {
                joint.q = 0.0;
            }
            self.x[ball_range].copy_from_slice(&ball.chart.variables(joint_ball.orientation));
        }
        map.scatter_within_limits(&self.x, &mut self.q);
    }

    /// Returns whether the commanded configuration is at rest at the goal.
    pub(super) fn is_at_rest_on_goal(&self) -> bool {
        let mut balls = self.balls.iter();
        let angle_left =
            |ball: &CommandedBall| (ball.orientation.conjugate() * ball.goal).log().norm();
        let mut joints = self.joints.iter().enumerate();
        balls.all(|ball| angle_left(ball) < MAX_REST_MOVE)
            && joints.all(|(j, joint)| {
                let distance = match self.is_of_ball(j) {
                    true => 0.0,
                    false => self.goals[j] - joint.q,
                };
                distance.abs() < MAX_REST_MOVE && joint.step.abs() < MAX_REST_MOVE
            })
    }

    fn is_of_ball(&self, variable: usize) -> bool {
        let mut balls = self.balls.iter();
        balls.any(|ball| (ball.first..ball.first + 3).contains(&variable))
    }

    /// Writes the solution of the commanded configuration, with the effort of the frame that computed its goal.
    pub(super) fn report(&mut self, instance: ProblemInstance<'_>, goal: &Solution) {
        solve(&self.evaluator, instance, &self.q, &mut self.workspace);
        let solution = &mut self.workspace.solution;
        // Copies the values exactly, with the sign of the quaternions.
        solution.q.copy_from_slice(&self.q);
        solution.iterations = goal.iterations;
        solution.counts += goal.counts;
        if !solution.reached {
            solution.termination = goal.termination;
        }
    }
}

/// Returns the limits of the variables from those of the numbers of a configuration.
fn by_variable(
    problem: &Problem,
    option: &'static str,
    limits: &[f64],
    range: Range,
) -> Result<Vec<f64>, SolveError> {
    if limits.len() != problem.configuration_len() {
        return Err(SolveError::MotionLimitsLength {
            option,
            model: problem.names().model.clone(),
            given: limits.len(),
            expected: problem.configuration_len(),
        });
    }
    for &limit in limits {
        BadOption::check(option, limit, range)?;
    }
    let map = problem.parameters();
    let mut variable_limits = map.least_by_variable(limits);
    for ball in map.balls() {
        let quaternion_limits = &limits[ball.coordinate..ball.coordinate + 4];
        let angular = quaternion_limits
            .iter()
            .copied()
            .fold(f64::INFINITY, f64::min);
        variable_limits[ball.variable..ball.variable + 3].fill(angular);
    }
    // The slides of a free base share the smallest limit.
    let is_base_translation = |j: usize| {
        problem.is_base_variable(j) && problem.names().variable_is_angle.get(j) == Some(&false)
    };
    let linear = (0..variable_limits.len())
        .filter(|&j| is_base_translation(j))
        .map(|j| variable_limits[j]);
    let linear = linear.fold(f64::INFINITY, f64::min);
    for (j, limit) in variable_limits.iter_mut().enumerate() {
        if is_base_translation(j) {
            *limit = linear;
        }
    }
    Ok(variable_limits)
}

/// Normalises a quaternion.
fn unit(rotation: Quaternion<f64>) -> Quaternion<f64> {
    let length = (rotation.w * rotation.w + rotation.v.norm_squared()).sqrt();
    Quaternion {
        w: rotation.w / length,
        v: rotation.v * (1.0 / length),
    }
}
