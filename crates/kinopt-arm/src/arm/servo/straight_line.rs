//! Straight-line motion of the tool: slower rather than off the line.
//!
//! The target of the goal configuration moves straight to the servo's target, with rotation about one axis. The joint
//! limits determine its speed, acceleration and jerk along the line: with u = dq/ds, q̇ = u ṡ and q̈ = u s̈ + u′ ṡ².
//! Fractions of the limits are reserved for u′ and its change. The limits of the joints hold in any case.

use nalgebra::Vector6;

use crate::arm::arm::Arm;
use crate::arm::workspace::ArmWorkspace;
use kinopt_kinematics::spatial::{Placement, Quaternion};
use kinopt_solver::motion_limits::{CycleLimits, GoalMotion, JointMotion};

/// Fraction of the joints' velocity limits for motion along the line.
const VELOCITY_SHARE: f64 = 0.9;
/// Fraction of the joints' acceleration limits for motion along the line.
const ACCELERATION_SHARE: f64 = 0.5;
/// Fraction of the joints' jerk limits for motion along the line.
const JERK_SHARE: f64 = 0.3;
/// Fraction of the acceleration limits for the bend of the joint path.
const BEND_SHARE: f64 = 0.3;
/// Fraction of the acceleration and jerk along the line with which its stop is planned: the joints may allow less
/// there.
const STOP_SHARE: f64 = 0.4;
/// Tool motion below which a direction is singular, as a fraction of the longest Jacobian column.
const SINGULAR: f64 = 0.02;
/// Length below which a line counts as its target, radians.
const SHORTEST: f64 = 1e-9;
/// Largest relative change of the target's motion in a cycle with which a target that was met is followed directly.
const STEADY: f64 = 0.5;
/// Longest motion of such a target in a cycle, radians.
const LONGEST_STEADY: f64 = 0.1;

/// Motion along the line to the target, radians; metres convert by their weight.
#[derive(Clone, Debug)]
pub(super) struct StraightLine {
    motion: JointMotion,
    target: Option<Placement<f64>>,
    /// Last motion of the target per cycle.
    target_step: Vector6<f64>,
    /// True if the last cycle met the target.
    met: bool,
    /// Joint motion along the line in the last cycle.
    joints: Vec<f64>,
}

impl StraightLine {
    pub(super) fn at_rest(joint_count: usize) -> Self {
        Self {
            motion: JointMotion::at_rest(0.0),
            target: None,
            target_step: Vector6::zeros(),
            met: false,
            joints: vec![0.0; joint_count],
        }
    }

    /// Resets the motion, for an arm at rest.
    pub(super) fn rest(&mut self) {
        self.motion = JointMotion::at_rest(0.0);
        self.target = None;
        self.target_step.fill(0.0);
        self.met = false;
        self.joints.fill(0.0);
    }

    /// Fraction of the motion from `from` to the target that the next cycle takes, 0 to 1.
    ///
    /// `goal` is the goal configuration.
    pub(super) fn advance(
        &mut self,
        arm: &Arm,
        workspace: &mut ArmWorkspace,
        goal: &[f64],
        limits: &[CycleLimits],
        [from, target]: [&Placement<f64>; 2],
    ) -> f64 {
        let line = difference(arm, from, target);
        let length = line.norm();
        let step = match &self.target {
            Some(last) => difference(arm, last, target),
            None => Vector6::zeros(),
        };
        let last = std::mem::replace(&mut self.target_step, step);
        self.target = Some(*target);
        let met = std::mem::replace(&mut self.met, true);
        if length <= SHORTEST {
            self.motion = JointMotion::at_rest(0.0);
            return 1.0;
        }
        let steady = (step - last).norm() <= STEADY * step.norm();
        if met && steady && length <= LONGEST_STEADY {
            self.motion.change = length - self.motion.step;
            self.motion.step = length;
            return 1.0;
        }
        let along = line / length;
        // Speed of the target along the line, if its last two motions agree.
        let own = step.dot(&along).min(last.dot(&along)).max(0.0);
        let limits = self.limits_along(arm, workspace, goal, limits, &along);
        self.motion.q = 0.0;
        let range = self.motion.viable_changes(&limits);
        let goal = GoalMotion {
            step: own.min(limits.step),
            change: 0.0,
        };
        let stop = CycleLimits {
            change: STOP_SHARE * limits.change,
            change_rate: STOP_SHARE * limits.change_rate,
            ..limits
        };
        let (change, _) = self.motion.change_to_meet(length, range, goal, &stop);
        self.motion = self.motion.after(change);
        self.motion.step = self.motion.step.clamp(0.0, length);
        // A lag of less than a cycle is caught up by following directly.
        self.met = length - self.motion.step <= step.norm();
        self.motion.step / length
    }

    /// Limits of the motion along a line.
    fn limits_along(
        &mut self,
        arm: &Arm,
        workspace: &mut ArmWorkspace,
        goal: &[f64],
        limits: &[CycleLimits],
        along: &Vector6<f64>,
    ) -> CycleLimits {
        workspace.compute_twists(arm, goal);
        let weighted = along * arm.options.metres_per_radian;
        workspace.joint_motion_of(goal, &weighted, SINGULAR);
        let mut line = CycleLimits {
            lower: f64::NEG_INFINITY,
            upper: f64::INFINITY,
            step: f64::INFINITY,
            change: f64::INFINITY,
            change_rate: f64::INFINITY,
        };
        for (i, limits) in limits.iter().enumerate() {
            let by = workspace.projected[i] / arm.scale[i];
            let size = by.abs().max(1e-12);
            line.step = line.step.min(VELOCITY_SHARE * limits.step / size);
            line.change = line.change.min(ACCELERATION_SHARE * limits.change / size);
            line.change_rate = line.change_rate.min(JERK_SHARE * limits.change_rate / size);
            let bend = (by - self.joints[i]).abs();
            let step = self.motion.step;
            // u′ ṡ² is the bend of a cycle times its step.
            if step > 0.0 && bend * step > BEND_SHARE * limits.change {
                line.step = line
                    .step
                    .min((BEND_SHARE * limits.change * step / bend).sqrt());
            }
            self.joints[i] = by;
        }
        line
    }
}

/// Motion between two placements, radians (metres by their weight): linear, then angular, in base axes.
fn difference(arm: &Arm, from: &Placement<f64>, to: &Placement<f64>) -> Vector6<f64> {
    let by = (to.translation - from.translation) * arm.options.metres_per_radian.recip();
    let turn = Quaternion::from_matrix(&(to.rotation * from.rotation.transpose())).log();
    Vector6::new(by.x, by.y, by.z, turn.x, turn.y, turn.z)
}
