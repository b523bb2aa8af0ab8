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
const MIDDLE: f64 = 0.6;
/// Largest fraction of a joint's half range for a nominal posture.
const OFF_LIMITS: f64 = 0.95;
/// Fraction of the distance to the minimum that one step takes.
pub(super) const SHARE: f64 = 0.5;
/// Longest motion in one step, as a fraction of the distance to the nearest singularity, within which the null space
/// rotates.
const TURNS: f64 = 0.5;
/// Tool motion that counts as none for a stretched arm, as a fraction of the longest Jacobian column.
const SHARP: f64 = 1e-3;
/// Largest measured stiffness, radians per radian: moving targets change the slope, too.
const MAX_STIFFNESS: f64 = 20.0;
/// Largest motion of a joint that counts as none, radians.
const AT_NOMINAL_POSTURE: f64 = 1e-9;

impl Arm {
    /// Returns true if the goal may leave a null space.
    pub(super) fn has_freedom(&self) -> bool {
        self.joint_count() > self.options.goal.rows() || self.options.goal.has_bounds()
    }

    /// Nominal posture of an arm that begins at `start`.
    pub(super) fn nominal_posture_from(&self, start: &[f64]) -> Vec<f64> {
        if let Some(posture) = &self.options.posture {
            return posture.clone();
        }
        let map = &self.serial.map;
        let bounds = map.lower().iter().zip(map.upper());
        let off_limits = start.iter().zip(bounds).map(|(&q, (&lower, &upper))| {
            let (middle, half) = (0.5 * (lower + upper), 0.5 * (upper - lower));
            match half.is_finite() && self.options.limit_avoidance > 0.0 {
                true => q.clamp(middle - OFF_LIMITS * half, middle + OFF_LIMITS * half),
                false => q,
            }
        });
        off_limits.collect()
    }

    /// Writes the pull on every joint, radians.
    fn pull(&self, q: &[f64], ease: &[f64], pull: &mut [f64]) {
        let map = &self.serial.map;
        let limit = self.options.limit_avoidance;
        for (i, pull) in pull.iter_mut().enumerate() {
            let (lower, upper) = (map.lower()[i], map.upper()[i]);
            let nearer = outwards(q[i], lower, upper) - outwards(ease[i], lower, upper);
            *pull = (ease[i] - q[i]) * self.scale[i] - limit * nearer;
        }
    }

    /// Growth of the pull at q along a motion, radians per radian; at least 1, the spring's.
    fn stiffness(&self, q: &[f64], motion: &[f64]) -> f64 {
        let map = &self.serial.map;
        let limit = self.options.limit_avoidance;
        let (mut grows, mut length) = (0.0, 0.0);
        for (i, by) in motion.iter().enumerate() {
            let stiff = limit * steepness(q[i], map.lower()[i], map.upper()[i]) / self.scale[i];
            grows += (1.0 + stiff) * by * by;
            length += by * by;
        }
        grows / length
    }
}

/// Parameters of a null-space step.
pub(super) struct NominalPosture<'e> {
    pub(super) ease: &'e [f64],
    /// Side to keep, of a stretched arm that does not reach its target.
    pub(super) stretched: Option<&'e SingularityBranch>,
    /// Fraction of the distance to the minimum that is taken, 0 to 1.
    pub(super) share: f64,
    /// Last motion, radians per joint.
    pub(super) last: &'e [f64],
    /// Slope before that motion, radians per joint; its change shows the stiffness of the null space.
    pub(super) last_slope: &'e [f64],
    /// Smallest stiffness along the motion, radians per radian.
    pub(super) stiffness: f64,
    /// Longest motion of a joint, radians.
    pub(super) longest: f64,
    /// Factor at x by [`factor_freely`](ArmWorkspace::factor_freely), if known.
    pub(super) free: Option<&'e Factor>,
}

impl NominalPosture<'_> {
    /// Stiffness along the last motion, by the change of the slope.
    ///
    /// The null space is curved, so the stiffness of the pull alone is too small and a step overshoots.
    fn measured_stiffness(&self, slope: &[f64]) -> f64 {
        let (mut fell, mut length) = (0.0, 0.0);
        for ((last, before), now) in self.last.iter().zip(self.last_slope).zip(slope) {
            fell += last * (before - now);
            length += last * last;
        }
        match length > 0.0 {
            true => (fell / length).clamp(0.0, MAX_STIFFNESS),
            false => 0.0,
        }
    }
}

impl ArmWorkspace {
    /// Writes the null-space motion from x towards the nominal posture to `projected`, radians per joint.
    ///
    /// The workspace must hold the Jacobian at x, or [one with its null space](ArmWorkspace::take_twists). Returns true
    /// if there is any motion, and the smallest stiffness for the next step.
    pub(super) fn aim_at_nominal_posture(
        &mut self,
        arm: &Arm,
        x: &[f64],
        how: &NominalPosture<'_>,
    ) -> (bool, f64) {
        let mut pull = std::mem::take(&mut self.wanted);
        arm.pull(x, how.ease, &mut pull);
        let reach = self.longest_column();
        let room = if let Some(bend) = how.stretched {
            bend.take_from(&mut pull);
            self.project_to_null(x, &pull, SHARP * reach);
            how.longest
        } else {
            let clearance = match how.free {
                Some(factor) => self.project_freely(factor, &pull),
                None => self.project_to_null(x, &pull, 0.0),
            };
            how.longest.min(TURNS * clearance / reach)
        };
        self.wanted = pull;
        let most = self.projected.iter();
        let most = most.fold(0.0_f64, |most, by| most.max(by.abs()));
        let moves = most > AT_NOMINAL_POSTURE;
        let stiffness = how.stiffness.max(how.measured_stiffness(&self.projected));
        let share = match moves {
            true => {
                let stiffness = arm.stiffness(x, &self.projected).max(stiffness);
                (how.share / stiffness).min(room / most)
            }
            false => 0.0,
        };
        self.slope.copy_from_slice(&self.projected);
        for by in &mut self.projected {
            *by *= share;
        }
        (moves, stiffness)
    }

    /// Moves x by the motion in `projected`, clamped to the bounds.
    pub(super) fn go_by_projected(&mut self) {
        for (i, x) in self.x.iter_mut().enumerate() {
            let moved = *x + self.projected[i] / self.scale[i];
            *x = self.question.clamp(i, moved);
        }
    }
}

/// Derivative of [`outwards`], per radian or metre.
fn steepness(q: f64, lower: f64, upper: f64) -> f64 {
    let Some((u, half)) = place(q, lower, upper) else {
        return 0.0;
    };
    2.0 * (u.abs() - MIDDLE) / ((1.0 - MIDDLE) * (1.0 - MIDDLE) * half)
}

/// Nearness of a joint to its limits: 0 in the middle of its range, from −1 at its lower limit to 1 at its upper.
fn outwards(q: f64, lower: f64, upper: f64) -> f64 {
    let Some((u, _)) = place(q, lower, upper) else {
        return 0.0;
    };
    let beyond = (u.abs() - MIDDLE) / (1.0 - MIDDLE);
    beyond * beyond * u.signum()
}

/// Position of a joint in its range, from −1 at its lower limit to 1 at its upper, and half that range.
///
/// Returns `None` for an infinite or empty range, and in its middle.
fn place(q: f64, lower: f64, upper: f64) -> Option<(f64, f64)> {
    let half = 0.5 * (upper - lower);
    let from_middle = q - lower - half;
    let near_limit = half > 0.0 && half.is_finite() && from_middle.abs() > MIDDLE * half;
    near_limit.then(|| (from_middle / half, half))
}
