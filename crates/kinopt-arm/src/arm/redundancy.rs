//! Null-space motion of a redundant arm while it follows a path or a target.
//!
//! Among the solutions of its target, a redundant arm goes to the one nearest to a nominal posture. That is the start,
//! moved off its limits, or a given posture. A convex function measures the distance: a spring, and a pull away from
//! limits, which grows near them. The slope at the posture is subtracted, so that the posture is the minimum (a Bregman
//! distance). The gradient is projected into the null space (Liégeois 1977, "Automatic supervisory control of the
//! configuration and behavior of multibody mechanisms"). The configuration then depends on the target, not on the path
//! to it.

use super::arm::Arm;
use super::null_space::Factor;
use super::singularity_branch::SingularityBranch;
use super::workspace::ArmWorkspace;

/// Fraction of a joint's half range beyond which its limit pulls.
const FREE_RANGE_FRACTION: f64 = 0.6;
/// Largest fraction of a joint's half range for a nominal posture.
const MAX_POSTURE_FRACTION: f64 = 0.95;
/// Fraction of the distance to the minimum that one step takes.
pub(super) const STEP_FRACTION: f64 = 0.5;
/// Longest null-space motion of a joint per step, radians.
pub(super) const MAX_NULL_SPACE_STEP: f64 = 0.02;
/// Longest motion in one step, as a fraction of the distance to the nearest singularity, within which the null space
/// rotates.
const MAX_SINGULARITY_FRACTION: f64 = 0.5;
/// Tool motion that counts as none for a stretched arm, as a fraction of the longest Jacobian column.
const NULL_SPACE_TOLERANCE: f64 = 1e-3;
/// Largest measured stiffness, radians per radian: moving targets change the slope, too.
const MAX_STIFFNESS: f64 = 20.0;
/// Largest motion of a joint that counts as none, radians.
const POSTURE_TOLERANCE: f64 = 1e-9;

/// Nominal posture of an arm that begins at `start`.
pub(super) fn nominal_posture_from(arm: &Arm, start: &[f64]) -> Vec<f64> {
    if let Some(posture) = &arm.options.posture {
        return posture.clone();
    }
    let map = &arm.serial.map;
    let bounds = map.lower().iter().zip(map.upper());
    let off_limits = start.iter().zip(bounds).map(|(&q, (&lower, &upper))| {
        let (middle, half) = (0.5 * (lower + upper), 0.5 * (upper - lower));
        match half.is_finite() && arm.options.limit_avoidance > 0.0 {
            true => q.clamp(
                middle - MAX_POSTURE_FRACTION * half,
                middle + MAX_POSTURE_FRACTION * half,
            ),
            false => q,
        }
    });
    off_limits.collect()
}

/// Writes the pull on every joint, radians.
fn write_pull(arm: &Arm, q: &[f64], nominal_posture: &[f64], pull: &mut [f64]) {
    let map = &arm.serial.map;
    let avoidance = arm.options.limit_avoidance;
    for (i, pull) in pull.iter_mut().enumerate() {
        let (lower, upper) = (map.lower()[i], map.upper()[i]);
        let approach =
            limit_nearness(q[i], lower, upper) - limit_nearness(nominal_posture[i], lower, upper);
        *pull = (nominal_posture[i] - q[i]) * arm.scale[i] - avoidance * approach;
    }
}

/// Growth of the pull at q along a motion, radians per radian; at least 1, the spring's.
fn pull_stiffness(arm: &Arm, q: &[f64], motion: &[f64]) -> f64 {
    let map = &arm.serial.map;
    let avoidance = arm.options.limit_avoidance;
    let (mut growth, mut length) = (0.0, 0.0);
    for (i, joint_motion) in motion.iter().enumerate() {
        let limit_stiffness =
            avoidance * limit_nearness_slope(q[i], map.lower()[i], map.upper()[i]) / arm.scale[i];
        growth += (1.0 + limit_stiffness) * joint_motion * joint_motion;
        length += joint_motion * joint_motion;
    }
    growth / length
}

/// Parameters of a null-space step.
pub(super) struct NullSpaceStep<'e> {
    pub(super) nominal_posture: &'e [f64],
    /// Side to keep, of a stretched arm that does not reach its target.
    pub(super) stretched: Option<&'e SingularityBranch>,
    /// Fraction of the distance to the minimum that is taken, 0 to 1.
    pub(super) fraction: f64,
    /// Last motion, radians per joint.
    pub(super) last_motion: &'e [f64],
    /// Slope before that motion, radians per joint; its change shows the stiffness of the null space.
    pub(super) last_slope: &'e [f64],
    /// Smallest stiffness along the motion, radians per radian.
    pub(super) stiffness: f64,
    /// Longest motion of a joint, radians.
    pub(super) max_joint_motion: f64,
    /// Factor at x by [`factor_without_bounds`](ArmWorkspace::factor_without_bounds), if known.
    pub(super) factor: Option<&'e Factor>,
}

impl NullSpaceStep<'_> {
    /// Stiffness along the last motion, by the change of the slope.
    ///
    /// The null space is curved, so the stiffness of the pull alone is too small and a step overshoots.
    fn measured_stiffness(&self, slope: &[f64]) -> f64 {
        let (mut slope_decrease, mut length) = (0.0, 0.0);
        for ((last, before), after) in self.last_motion.iter().zip(self.last_slope).zip(slope) {
            slope_decrease += last * (before - after);
            length += last * last;
        }
        match length > 0.0 {
            true => (slope_decrease / length).clamp(0.0, MAX_STIFFNESS),
            false => 0.0,
        }
    }
}

impl ArmWorkspace {
    /// Writes the null-space motion from x towards the nominal posture to `projected`, radians per joint.
    ///
    /// The workspace must hold the Jacobian at x, or [one with its null space](ArmWorkspace::compute_twists). Returns
    /// true if there is any motion, and the smallest stiffness for the next step.
    pub(super) fn compute_null_space_step(
        &mut self,
        arm: &Arm,
        x: &[f64],
        step: &NullSpaceStep<'_>,
    ) -> (bool, f64) {
        let mut pull = std::mem::take(&mut self.scratch_motion);
        write_pull(arm, x, step.nominal_posture, &mut pull);
        let max_column_norm = self.max_column_norm();
        let max_motion = if let Some(branch) = step.stretched {
            branch.remove_from(&mut pull);
            self.project_to_null(x, &pull, NULL_SPACE_TOLERANCE * max_column_norm);
            step.max_joint_motion
        } else {
            let min_singular_value = match step.factor {
                Some(factor) => self.project_without_bounds(factor, &pull),
                None => self.project_to_null(x, &pull, 0.0),
            };
            step.max_joint_motion
                .min(MAX_SINGULARITY_FRACTION * min_singular_value / max_column_norm)
        };
        self.scratch_motion = pull;
        let largest_motion = self.projected.iter();
        let largest_motion = largest_motion.fold(0.0_f64, |largest_motion, joint_motion| {
            largest_motion.max(joint_motion.abs())
        });
        let moves = largest_motion > POSTURE_TOLERANCE;
        let stiffness = step.stiffness.max(step.measured_stiffness(&self.projected));
        let fraction = match moves {
            true => {
                let stiffness = pull_stiffness(arm, x, &self.projected).max(stiffness);
                (step.fraction / stiffness).min(max_motion / largest_motion)
            }
            false => 0.0,
        };
        self.slope.copy_from_slice(&self.projected);
        for joint_motion in &mut self.projected {
            *joint_motion *= fraction;
        }
        (moves, stiffness)
    }

    /// Moves x by the motion in `projected`, clamped to the bounds.
    pub(super) fn apply_projected(&mut self) {
        for (i, x) in self.x.iter_mut().enumerate() {
            let moved = *x + self.projected[i] / self.scale[i];
            *x = self.question.clamp(i, moved);
        }
    }
}

/// Derivative of [`limit_nearness`], per radian or metre.
fn limit_nearness_slope(q: f64, lower: f64, upper: f64) -> f64 {
    let Some((u, half)) = range_position(q, lower, upper) else {
        return 0.0;
    };
    2.0 * (u.abs() - FREE_RANGE_FRACTION)
        / ((1.0 - FREE_RANGE_FRACTION) * (1.0 - FREE_RANGE_FRACTION) * half)
}

/// Nearness of a joint to its limits: 0 in the middle of its range, from −1 at its lower limit to 1 at its upper.
fn limit_nearness(q: f64, lower: f64, upper: f64) -> f64 {
    let Some((u, _)) = range_position(q, lower, upper) else {
        return 0.0;
    };
    let excess = (u.abs() - FREE_RANGE_FRACTION) / (1.0 - FREE_RANGE_FRACTION);
    excess * excess * u.signum()
}

/// Position of a joint in its range, from −1 at its lower limit to 1 at its upper, and half that range.
///
/// Returns `None` for an infinite or empty range, and in its middle.
fn range_position(q: f64, lower: f64, upper: f64) -> Option<(f64, f64)> {
    let half = 0.5 * (upper - lower);
    let from_middle = q - lower - half;
    let near_limit =
        half > 0.0 && half.is_finite() && from_middle.abs() > FREE_RANGE_FRACTION * half;
    near_limit.then(|| (from_middle / half, half))
}
