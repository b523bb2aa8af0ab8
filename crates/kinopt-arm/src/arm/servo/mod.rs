//! Servo: one target per control cycle, within limits of position, velocity, acceleration and jerk.
//!
//! 1. The *goal configuration* advances to the target on the arm's [branch](super::branch), by damped steps within the
//!    position limits (Wampler 1986, "Manipulator inverse kinematic solutions based on vector formulations and damped
//!    least-squares methods"). While the target rests the damping fades, so that the arm converges to the closest pose.
//! 2. Each joint has an interval of next steps from which it can still [brake](kinopt_solver::motion_limits) within all of its
//!    limits.
//! 3. Each joint takes the step in its interval that meets its goal, or comes nearest to that. If a joint is at a
//!    limit, the tool lags and its path bends.

mod report;
mod straight_line;

use super::distances::{MAX_JOINT_STEP, pose_distance};
use std::cmp::Ordering;

use self::straight_line::StraightLine;
use super::arm::Arm;
use super::branch::Branch;
use super::local_descent::LocalDescent;
use super::redundancy::{MAX_NULL_SPACE_STEP, STEP_FRACTION};
use super::workspace::{ArmWorkspace, Errors};
use super::{ArmError, QueryError};
use kinopt_kinematics::bad_option::{ABOVE_0, AT_LEAST_0, BadOption, NOT_NEGATIVE, Range};
use kinopt_kinematics::spatial::Placement;
use kinopt_solver::ik::Side;
use kinopt_solver::motion_limits::{CycleLimits, GoalHistory, JointMotion};
use kinopt_solver::search::{Collision, within};
use kinopt_solver::solver::Termination;

pub use report::{HeldBy, ServoStatus, ServoStep};

/// Longest time step, seconds.
const MAX_TIME_STEP: f64 = 1.0;
/// Steps of one cycle towards the goal configuration; the next cycle continues from there.
const GOAL_STEPS: usize = 8;
/// Largest step of a joint without a velocity limit in a cycle, radians.
const UNLIMITED_STEP: f64 = 0.5 * MAX_JOINT_STEP;
/// Default damping, radians.
const DAMPING: f64 = 0.01;
/// Fraction of the damping that is left after each cycle with the same target.
const FADING: f64 = 0.7;
/// Fraction of a joint's velocity limit that null-space motion uses while the target moves.
const NULL_SPACE_SPEED: f64 = 0.5;
/// Time constant of null-space motion, seconds.
const NULL_SPACE_TIME: f64 = 0.03;
/// Time constant of null-space motion while the tool keeps to a straight line, seconds.
const NULL_SPACE_TIME_ON_LINE: f64 = 0.15;
/// Fraction of an acceleration limit with which null-space motion ends while the tool keeps to a straight line.
const NULL_SPACE_SHARE_ON_LINE: f64 = 0.2;
/// Fraction of an acceleration limit that null-space motion uses.
const NULL_SPACE_ACCELERATION: f64 = 0.1;
/// Time in which null-space motion gains its full speed without acceleration limits, seconds.
const NULL_SPACE_RISE: f64 = 0.05;
/// Largest offset of the goal configuration of a stretched arm to the side of its branch, radians.
///
/// The singular configuration can move by 2e-3 rad per cycle, and the offset exceeds that. A prediction of that motion
/// instead of an offset makes the joints reverse.
const MAX_SIDE_OFFSET: f64 = 4e-3;
/// Largest offset to the side of the branch, radians per radian of the last error.
///
/// A target within reach has a small error, from lag, and so a small offset.
const SIDE_OFFSET_PER_ERROR: f64 = 20.0;
/// Distance from the last target beyond which a target is distant and approached in steps, radians.
const LEAD: f64 = 0.1;
/// Largest number of steps towards a distant target in a cycle.
const MAX_LEADS: usize = 4;
/// Speed above which a joint comes to rest for a cycle before it reverses, rad/s.
const REVERSAL_SPEED: f64 = 0.1;

/// Tolerance of rounding for a position limit at the rest position of a start state, radians or metres.
const BRAKING_TOLERANCE: f64 = 1e-9;

/// Relative tolerance of rounding for a velocity limit at a start state.
const RATE_TOLERANCE: f64 = 1e-9;

/// Servo: one joint position command per control cycle, within all joint limits; from [`Arm::servo`].
#[derive(Clone, Debug)]
pub struct Servo<'a> {
    arm: &'a Arm,
    workspace: ArmWorkspace,
    time_step: f64,
    /// Velocity limits, rad/s or m/s; infinite for none.
    velocity_limits: Vec<f64>,
    /// Acceleration limits, rad/s² or m/s²; infinite for none.
    acceleration_limits: Vec<f64>,
    /// Jerk limits, rad/s³ or m/s³; infinite for none.
    jerk_limits: Vec<f64>,
    limits: Vec<CycleLimits>,
    /// Square of the damping after its conversion to metres per radian, m² per rad².
    damping: f64,
    /// Fraction of the damping that is left for a resting target, 0 to 1.
    fading: f64,
    target: Option<Placement<f64>>,
    /// Intermediate target of the goal configuration. It approaches a distant target in steps.
    approached: Placement<f64>,
    /// Motion of the intermediate target along a straight line, if enabled.
    line: Option<StraightLine>,
    branch: Branch,
    goal: Vec<f64>,
    /// Error of the goal configuration, radians; metres convert by `metres_per_radian`.
    goal_error: f64,
    history: GoalHistory,
    /// True while the arm moves to a distant target.
    catches_up: bool,
    /// Largest null-space motion of the last cycle, radians.
    null_space_step: f64,
    joints: Vec<JointMotion>,
    next: Vec<JointMotion>,
    q: Vec<f64>,
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
    held: Vec<Option<HeldBy>>,
    collisions: Vec<Collision>,
}

impl<'a> Servo<'a> {
    /// Servo of an arm at rest at a validated start.
    pub(super) fn new(arm: &'a Arm, start: &[f64], time_step: f64) -> Result<Self, QueryError> {
        if !(time_step > 0.0 && time_step <= MAX_TIME_STEP) {
            return Err(QueryError::TimeStep(time_step));
        }
        let n = arm.joint_count();
        let map = &arm.serial.map;
        let ends = map.lower().iter().zip(map.upper());
        let goal = start.iter().zip(ends).map(|(q, (l, u))| q.max(*l).min(*u));
        let goal: Vec<f64> = goal.collect();
        let unset = CycleLimits {
            lower: f64::NEG_INFINITY,
            upper: f64::INFINITY,
            step: 0.0,
            change: 0.0,
            change_rate: 0.0,
        };
        let mut servo = Self {
            arm,
            workspace: ArmWorkspace::new(&arm.serial, &arm.options)?,
            time_step,
            velocity_limits: arm.velocity_limits().to_vec(),
            acceleration_limits: arm.acceleration_limits().to_vec(),
            jerk_limits: arm.jerk_limits().to_vec(),
            limits: vec![unset; n],
            damping: 0.0,
            fading: 1.0,
            target: None,
            approached: arm.base_from_tool(&goal)?,
            line: None,
            branch: Branch::begin(arm, &goal),
            history: GoalHistory::resting_at(&goal),
            goal,
            goal_error: 0.0,
            catches_up: false,
            null_space_step: 0.0,
            joints: start.iter().map(|q| JointMotion::at_rest(*q)).collect(),
            next: vec![JointMotion::default(); n],
            q: start.to_vec(),
            velocity: vec![0.0; n],
            acceleration: vec![0.0; n],
            held: vec![None; n],
            collisions: Vec::new(),
        };
        servo.set_damping(DAMPING);
        servo.set_cycle_limits();
        Ok(servo)
    }
}

impl Servo<'_> {
    /// Sets the velocity limits, base to tip, rad/s or m/s: at least 0, infinite for none.
    ///
    /// # Errors
    /// Returns an error for another number of limits than free joints, or a limit that is negative or NaN.
    pub fn with_velocity_limits(mut self, limits: &[f64]) -> Result<Self, ArmError> {
        self.check_limits("velocity_limits", limits, AT_LEAST_0)?;
        self.velocity_limits.copy_from_slice(limits);
        self.set_cycle_limits();
        Ok(self)
    }

    /// Sets the acceleration limits, base to tip, rad/s² or m/s²: above 0, infinite for none.
    ///
    /// # Errors
    /// Returns an error for another number of limits than free joints, or a limit that is not above 0.
    pub fn with_acceleration_limits(mut self, limits: &[f64]) -> Result<Self, ArmError> {
        self.check_limits("acceleration_limits", limits, ABOVE_0)?;
        self.acceleration_limits.copy_from_slice(limits);
        self.set_cycle_limits();
        Ok(self)
    }

    /// Sets the jerk limits, base to tip, rad/s³ or m/s³: above 0, infinite for none.
    ///
    /// # Errors
    /// Returns an error for another number of limits than free joints, or a limit that is not above 0.
    pub fn with_jerk_limits(mut self, limits: &[f64]) -> Result<Self, ArmError> {
        self.check_limits("jerk_limits", limits, ABOVE_0)?;
        self.jerk_limits.copy_from_slice(limits);
        self.set_cycle_limits();
        Ok(self)
    }

    fn check_limits(
        &self,
        option: &'static str,
        limits: &[f64],
        range: Range,
    ) -> Result<(), ArmError> {
        if limits.len() != self.q.len() {
            return Err(ArmError::JointCount {
                option,
                given: limits.len(),
                joints: self.arm.joints().map(str::to_owned).collect(),
            });
        }
        for &limit in limits {
            BadOption::check(option, limit, range)?;
        }
        Ok(())
    }

    /// Sets the damping, radians; at least 0. Default 0.01.
    ///
    /// It is the tool motion, in radians for each radian of joint motion, that runs at half of its speed. Metres convert
    /// by [`with_metres_per_radian`](super::ArmBuilder::with_metres_per_radian). Faster motions of the tool are damped
    /// less. More damping makes joints slower near singular configurations, and the tool lags there.
    ///
    /// # Errors
    /// Returns an error for a number that is negative or not finite.
    pub fn with_damping(mut self, radians: f64) -> Result<Self, ArmError> {
        BadOption::check("damping", radians, NOT_NEGATIVE)?;
        self.set_damping(radians);
        Ok(self)
    }

    /// Sets a moving start state: velocities (rad/s or m/s) and accelerations (rad/s² or m/s²) of the free joints.
    ///
    /// Set the limits before: the state is checked against the current ones.
    ///
    /// # Errors
    /// Returns an error, which names the joint, for:
    /// - Slices of the wrong length or not finite.
    /// - A joint whose state violates a velocity or acceleration limit.
    /// - A joint whose acceleration cannot end before a velocity limit.
    /// - A joint that cannot brake before a position limit.
    pub fn with_motion(
        mut self,
        velocity: &[f64],
        acceleration: &[f64],
    ) -> Result<Self, QueryError> {
        let n = self.q.len();
        self.arm.check_length("the velocity", velocity.len(), n)?;
        self.arm
            .check_length("the acceleration", acceleration.len(), n)?;
        self.arm.check_finite("the velocity", velocity)?;
        self.arm.check_finite("the acceleration", acceleration)?;
        let t = self.time_step;
        for i in 0..n {
            let limits = &self.limits[i];
            let state = JointMotion {
                step: velocity[i] * t,
                change: acceleration[i] * t * t,
                ..self.joints[i]
            };
            let joint = || self.arm.names.variables[i].clone();
            let rates = [
                ("velocity", velocity[i], self.velocity_limits[i]),
                ("acceleration", acceleration[i], self.acceleration_limits[i]),
            ];
            for (rate, value, limit) in rates {
                if value.abs() > limit {
                    let joint = joint();
                    return Err(QueryError::RateLimit {
                        joint,
                        rate,
                        value,
                        limit,
                    });
                }
            }
            let coasting = state.coasting_step(limits);
            if coasting.abs() > limits.step.max(state.step.abs()) * (1.0 + RATE_TOLERANCE) {
                return Err(QueryError::CannotCoast {
                    joint: joint(),
                    velocity: coasting / t,
                    limit: self.velocity_limits[i],
                });
            }
            let stop = state.stop(limits);
            let above = state.q + stop.highest - limits.upper;
            let below = limits.lower - (state.q + stop.lowest);
            let distance = above.max(below);
            if distance > BRAKING_TOLERANCE {
                return Err(QueryError::CannotBrake {
                    joint: joint(),
                    distance,
                    limit: if above > below {
                        limits.upper
                    } else {
                        limits.lower
                    },
                });
            }
            self.joints[i] = state;
        }
        self.velocity.copy_from_slice(velocity);
        self.acceleration.copy_from_slice(acceleration);
        Ok(self)
    }

    /// Keeps the tool on the straight line to its target: position straight, rotation about one axis. Default false.
    ///
    /// The tool slows down to stay on the line. Without this option each joint takes the shortest time, and the tool's
    /// path to a distant target is curved. The tool leaves the line near singular configurations and position limits,
    /// and while it brakes for a collision or a [stop](Self::stop).
    #[must_use]
    pub fn with_straight_line(mut self, straight: bool) -> Self {
        self.line = straight.then(|| StraightLine::at_rest(self.q.len()));
        self
    }

    fn set_damping(&mut self, radians: f64) {
        let metres = radians * self.arm.options.metres_per_radian;
        self.damping = metres * metres;
    }

    /// Sets the limits per cycle, reduced by the rounding of positions.
    fn set_cycle_limits(&mut self) {
        let map = &self.arm.serial.map;
        for (i, limits) in self.limits.iter_mut().enumerate() {
            let (lower, upper) = (map.lower()[i], map.upper()[i]);
            let bounds = [lower.min(self.q[i]), upper.max(self.q[i])];
            let rates = [
                self.velocity_limits[i],
                self.acceleration_limits[i],
                self.jerk_limits[i],
            ];
            let unlimited = UNLIMITED_STEP / self.arm.scale[i];
            *limits = CycleLimits::new(bounds, self.q[i], self.time_step, rates, unlimited);
        }
    }

    /// Velocity limits of the free joints, base to tip, rad/s or m/s; infinite for none.
    #[must_use]
    pub fn velocity_limits(&self) -> &[f64] {
        &self.velocity_limits
    }

    /// Acceleration limits of the free joints, base to tip, rad/s² or m/s²; infinite for none.
    #[must_use]
    pub fn acceleration_limits(&self) -> &[f64] {
        &self.acceleration_limits
    }

    /// Jerk limits of the free joints, base to tip, rad/s³ or m/s³; infinite for none.
    #[must_use]
    pub fn jerk_limits(&self) -> &[f64] {
        &self.jerk_limits
    }

    /// Commanded joint positions, radians or metres.
    #[must_use]
    pub fn q(&self) -> &[f64] {
        &self.q
    }

    /// Commanded velocities of the joints, rad/s or m/s.
    #[must_use]
    pub fn velocity(&self) -> &[f64] {
        &self.velocity
    }

    /// Commanded accelerations of the joints, rad/s² or m/s².
    #[must_use]
    pub fn acceleration(&self) -> &[f64] {
        &self.acceleration
    }

    /// Pairs that blocked the motion of the last cycle, or that are in contact: those of [`ServoStep::collisions`].
    #[must_use]
    pub fn collisions(&self) -> &[Collision] {
        &self.collisions
    }

    /// Limits that determined the motion of the joints in the last cycle, base to tip; `None` for a joint without one.
    #[must_use]
    pub fn held(&self) -> &[Option<HeldBy>] {
        &self.held
    }

    /// Runs one control cycle towards a target, a placement from tool to base coordinates, and returns the command.
    ///
    /// Send [`q`](ServoStep::q) to the robot. [`stop`](Self::stop) brings a moving arm to rest. Allocates nothing, unless
    /// there is a collision.
    ///
    /// # Errors
    /// Returns an error for a target that is not a rigid motion; the state is then unchanged.
    pub fn step(
        &mut self,
        base_from_tool: impl Into<Placement<f64>>,
    ) -> Result<ServoStep<'_>, QueryError> {
        let target = base_from_tool.into();
        self.arm.check_query(None, &target, &self.goal)?;
        let rests = self.target.replace(target) == Some(target);
        let ended = self.advance_goal(&target, rests);
        self.history.push(&self.goal);
        let limited = self.meet_goal();
        self.catches_up &= limited;
        #[cfg(feature = "collision")]
        let contact = self.avoid_collisions()?;
        self.commit();
        let errors = self.errors_at_q(&target);
        let status = self.status(&errors, limited, ended);
        #[cfg(feature = "collision")]
        let status = contact.unwrap_or(status);
        self.fading = match rests && !limited {
            true => self.fading * FADING,
            false => 1.0,
        };
        Ok(self.report(status, errors))
    }

    /// Runs one control cycle of a stop: every joint brakes as hard as its limits allow.
    ///
    /// Call it once per cycle until the status is [`Stopped`](ServoStatus::Stopped); the next [`step`](Self::step)
    /// continues from there.
    pub fn stop(&mut self) -> ServoStep<'_> {
        for (i, next) in self.next.iter_mut().enumerate() {
            let joint = &self.joints[i];
            let limits = &self.limits[i];
            *next = joint.after(joint.braking_change(limits)).within(limits);
        }
        self.collisions.clear();
        self.held.fill(None);
        self.commit();
        self.follow_own_motion();
        let errors = match self.target {
            Some(target) => self.errors_at_q(&target),
            None => Errors::default(),
        };
        let status = match self.joints.iter().all(JointMotion::is_at_rest) {
            true => ServoStatus::Stopped,
            false => ServoStatus::Stopping,
        };
        self.report(status, errors)
    }

    /// Errors of the commanded configuration.
    fn errors_at_q(&mut self, target: &Placement<f64>) -> Errors {
        self.workspace.set_target(target);
        self.workspace.x.copy_from_slice(&self.q);
        self.workspace.judge_x()
    }

    /// Sets the goal configuration to the one at which the arm comes to rest.
    fn follow_own_motion(&mut self) {
        let map = &self.arm.serial.map;
        for (i, goal) in self.goal.iter_mut().enumerate() {
            let joint = &self.joints[i];
            let end = joint.q + joint.stop(&self.limits[i]).end;
            *goal = end.max(map.lower()[i]).min(map.upper()[i]);
        }
        self.history.rest_at(&self.goal);
        if let Ok(approached) = self.arm.base_from_tool(&self.goal) {
            self.approached = approached;
        }
        if let Some(line) = &mut self.line {
            line.rest();
        }
        self.catches_up = false;
        self.null_space_step = 0.0;
        self.fading = 1.0;
    }

    fn report(&self, status: ServoStatus, errors: Errors) -> ServoStep<'_> {
        ServoStep {
            q: &self.q,
            velocity: &self.velocity,
            acceleration: &self.acceleration,
            status,
            position_error: errors.position,
            orientation_error: errors.orientation,
            collisions: &self.collisions,
            held: &self.held,
            names: &self.arm.names.variables,
        }
    }

    /// Advances the goal configuration to the target, and finds the joints that push against a position limit.
    fn advance_goal(&mut self, target: &Placement<f64>, rests: bool) -> Termination {
        let arm = self.arm;
        let mut ended = Termination::IterationLimit;
        self.drop_free_parts(target);
        if self.line.is_none() && pose_distance(arm, target, &self.approached) > LEAD && !rests {
            self.follow_own_motion();
            self.drop_free_parts(target);
            self.catches_up = true;
        }
        for lead in 0..MAX_LEADS {
            let distance = pose_distance(arm, target, &self.approached);
            let share = match &mut self.line {
                Some(line) => {
                    let ends = [&self.approached, target];
                    line.advance(arm, &mut self.workspace, &self.goal, &self.limits, ends)
                }
                None => (LEAD / distance).min(1.0),
            };
            // On a line, one step per cycle.
            let arrives = share >= 1.0 || self.line.is_some();
            self.approached = match share >= 1.0 {
                true => *target,
                false => self.approached.interpolated(target, share),
            };
            self.workspace.set_target(&self.approached);
            self.bound_goal();
            self.workspace.x.copy_from_slice(&self.goal);
            if lead == 0 {
                self.branch.take_target(rests);
                self.lead_null_space(rests);
                let offset = MAX_SIDE_OFFSET.min(SIDE_OFFSET_PER_ERROR * self.goal_error);
                self.branch.offset_to_side(&mut self.workspace, offset);
            }
            let descent = LocalDescent {
                steps: GOAL_STEPS,
                anchor: self.damping * self.fading,
                deadline: None,
            };
            (ended, _) = self.workspace.descend(&descent);
            // In flat valleys short steps converge slowly.
            if arrives && ended == Termination::IterationLimit && self.branch.has_come_to_rest() {
                (ended, _) = self.workspace.converge(None);
            }
            self.goal.copy_from_slice(&self.workspace.x);
            if arrives {
                break;
            }
        }
        let errors = self.workspace.judge_x();
        let position = errors.position / arm.options.metres_per_radian;
        let square = position * position + errors.orientation * errors.orientation;
        self.goal_error = square.sqrt();
        self.hold_at_limits(errors.reached);
        self.branch
            .end_step(self.arm, &mut self.workspace, errors.reached);
        ended
    }

    /// Sets the free components of the intermediate target to those of the target, so that only the others approach it.
    fn drop_free_parts(&mut self, target: &Placement<f64>) {
        let goal = &self.arm.options.goal;
        if !goal.is_full_pose() {
            self.approached.rotation = target.rotation;
        }
        if !goal.is_exact_in_position() {
            self.approached.translation = target.translation;
        }
    }

    /// Sets the bounds of the goal configuration in a cycle: the position limits and a largest displacement.
    fn bound_goal(&mut self) {
        let map = &self.arm.serial.map;
        let question = &mut self.workspace.question;
        for (i, &goal) in self.goal.iter().enumerate() {
            let most = (UNLIMITED_STEP / self.arm.scale[i]).max(2.0 * self.limits[i].step);
            question.lower[i] = map.lower()[i].max(within(goal, -most));
            question.upper[i] = map.upper()[i].min(within(goal, most));
        }
    }

    /// Adds null-space motion to the goal configuration.
    fn lead_null_space(&mut self, rests: bool) {
        if !self.arm.has_null_space() {
            return;
        }
        let (mut step, mut change) = (MAX_NULL_SPACE_STEP, f64::INFINITY);
        for (limits, scale) in self.limits.iter().zip(&self.arm.scale) {
            if limits.step > 0.0 {
                step = step.min(limits.step * scale);
                change = change.min(limits.change * scale);
            }
        }
        if !rests {
            step *= NULL_SPACE_SPEED;
        }
        let mut time = NULL_SPACE_TIME;
        if self.line.is_some() {
            // The motion ends within its time constant, with the acceleration that motion along the line leaves.
            time = NULL_SPACE_TIME_ON_LINE;
            step = step.min(NULL_SPACE_SHARE_ON_LINE * change * time / self.time_step);
        }
        let rise = (self.time_step / NULL_SPACE_RISE).min(1.0);
        let gain = (NULL_SPACE_ACCELERATION * change).min(rise * step);
        // While the arm is far from its goal, the goal's null-space motion does not show.
        let (longest, share) = match rests && self.catches_up {
            true => (MAX_NULL_SPACE_STEP, STEP_FRACTION),
            false => (
                step.min(self.null_space_step + gain),
                self.time_step / (self.time_step + time),
            ),
        };
        self.null_space_step =
            self.branch
                .move_to_nominal_posture(self.arm, &mut self.workspace, longest, share);
    }

    /// Finds the joints that push against a position limit at the goal configuration.
    fn hold_at_limits(&mut self, reached: bool) {
        self.held.fill(None);
        let map = &self.arm.serial.map;
        let at_limit = |i: usize, x: f64| x <= map.lower()[i] || x >= map.upper()[i];
        let mut ends = self.workspace.x.iter().enumerate();
        if reached || !ends.any(|(i, x)| at_limit(i, *x)) {
            return;
        }
        let negligible = self.workspace.compute_gradient();
        let ArmWorkspace { x, gradient, .. } = &self.workspace;
        for (i, held) in self.held.iter_mut().enumerate() {
            if x[i] <= map.lower()[i] && gradient[i] > negligible {
                *held = Some(HeldBy::Limit(Side::Lower));
            } else if x[i] >= map.upper()[i] && gradient[i] < -negligible {
                *held = Some(HeldBy::Limit(Side::Upper));
            }
        }
    }

    /// Chooses the next step of every joint. Returns true if a rate limit keeps one from its goal.
    fn meet_goal(&mut self) -> bool {
        let map = &self.arm.serial.map;
        let reversal = REVERSAL_SPEED * self.time_step;
        let mut limited = false;
        for (i, joint) in self.joints.iter().enumerate() {
            let limits = &self.limits[i];
            let (mut lower, mut upper) = joint.viable_changes(limits);
            // A fast joint does not reverse in this cycle.
            let step = joint.step;
            if step.abs() * self.arm.scale[i] > reversal {
                if step > 0.0 {
                    lower = lower.max(-step).min(upper);
                } else {
                    upper = upper.min(-step).max(lower);
                }
            }
            let (motion, goal) = (self.history.motions()[i], self.goal[i]);
            let (change, beyond) = joint.change_to_meet(goal, (lower, upper), motion, limits);
            self.next[i] = joint.after(change).within(limits);
            limited |= beyond.is_ne();
            let rate = |side| match self.next[i].step.abs() >= limits.step * (1.0 - 1e-9) {
                true => HeldBy::Speed(side),
                false => HeldBy::Acceleration(side),
            };
            let rate = match beyond {
                Ordering::Less => Some(rate(Side::Lower)),
                Ordering::Equal => None,
                Ordering::Greater => Some(rate(Side::Upper)),
            };
            let outside = match joint.q {
                q if q > map.upper()[i] => Some(HeldBy::Outside(Side::Upper)),
                q if q < map.lower()[i] => Some(HeldBy::Outside(Side::Lower)),
                _ => None,
            };
            self.held[i] = outside.or(rate).or(self.held[i]);
        }
        limited
    }

    /// Replaces the cycle by a braking cycle if the arm could not come to rest before a collision after it.
    ///
    /// Returns the status if there is a collision ahead or a contact.
    #[cfg(feature = "collision")]
    fn avoid_collisions(&mut self) -> Result<Option<ServoStatus>, QueryError> {
        let (arm, workspace) = (self.arm, &mut self.workspace);
        self.collisions.clear();
        let Some(kept) = &arm.collisions else {
            return Ok(None);
        };
        let room = workspace
            .collision_workspace
            .get_or_insert_with(|| kept.workspace());
        // Configuration at which the arm would come to rest.
        for (i, x) in workspace.x.iter_mut().enumerate() {
            *x = self.next[i].q + self.next[i].stop(&self.limits[i]).end;
        }
        let way = kept.way_from_contact(arm, room, &self.q, &workspace.x)?;
        let touches = way.begins_touching();
        let Some(by) = way.blocked_by else {
            if touches {
                for (x, next) in workspace.x.iter_mut().zip(&self.next) {
                    *x = next.q;
                }
                self.collisions = kept.collisions(arm, room, &workspace.x)?;
            }
            let touching = (!self.collisions.is_empty()).then_some(ServoStatus::Touching);
            return Ok(touching);
        };
        let instant = self
            .limits
            .iter()
            .all(|limits| limits.change.is_infinite() && limits.change_rate.is_infinite());
        if instant {
            let share = kept.cautious_fraction(arm, room, &self.q, &workspace.x)?;
            for (i, x) in workspace.x.iter_mut().enumerate() {
                *x = self.q[i] + share * (*x - self.q[i]);
                let step = *x - self.q[i];
                self.next[i] = JointMotion {
                    q: *x,
                    step,
                    change: step - self.joints[i].step,
                };
            }
        } else {
            for (i, x) in workspace.x.iter_mut().enumerate() {
                let joint = &self.joints[i];
                self.next[i] = joint.after(joint.braking_change(&self.limits[i]));
                *x = self.next[i].q;
            }
        }
        if touches {
            self.collisions = kept.collisions(arm, room, &workspace.x)?;
        }
        let status = match self.collisions.is_empty() {
            true => ServoStatus::Blocked,
            false => ServoStatus::Touching,
        };
        if !self.collisions.iter().any(|own| own.is_of_same_pair(&by)) {
            self.collisions.push(by);
        }
        Ok(Some(status))
    }

    /// Applies the chosen states of the joints.
    fn commit(&mut self) {
        let (map, t) = (&self.arm.serial.map, self.time_step);
        for (i, joint) in self.joints.iter_mut().enumerate() {
            *joint = self.next[i];
            self.q[i] = joint.q;
            self.velocity[i] = joint.step / t;
            self.acceleration[i] = joint.change / (t * t);
            // A joint that returns from outside its limits does not go back there.
            self.limits[i].lower = map.lower()[i].min(joint.q);
            self.limits[i].upper = map.upper()[i].max(joint.q);
        }
    }

    fn status(&self, errors: &Errors, limited: bool, ended: Termination) -> ServoStatus {
        let at_rest = self.joints.iter().all(|joint| joint.step == 0.0);
        if errors.reached {
            ServoStatus::OnTarget
        } else if limited {
            ServoStatus::SpeedLimited
        } else if at_rest && ended != Termination::NonFinite {
            ServoStatus::Nearest
        } else {
            ServoStatus::Settling
        }
    }
}
