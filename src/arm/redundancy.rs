//! What an arm's freedom is spent on while it follows.
//!
//! Of the configurations that its target leaves, a redundant arm goes to the one that lies nearest to a posture
//! of ease: the one that it began in, off its limits, or another that is asked for. Near is what a convex
//! function says: a spring, and a pull away from limits that grows with the nearness to them (less its
//! slope at ease, so that ease itself is the lowest point: a Bregman distance). Its slope is projected into the
//! null space (Liégeois 1977, "Automatic supervisory control of the configuration and behavior of
//! multibody mechanisms"). So where an arm stands depends on its target and not on the way that it came.

use super::arm::Arm;
use super::elbow_side::Bend;
use super::null_space::Factor;
use super::workspace::ArmWorkspace;

/// The share of a joint's half range from which on its limit pulls.
const MIDDLE: f64 = 0.6;
/// The share of a joint's half range that a posture of ease stays within.
const OFF_LIMITS: f64 = 0.95;
/// The share of the way to ease that one step goes.
pub(super) const SHARE: f64 = 0.5;
/// The longest motion in one go, as a share of the distance from the nearest singular place: what leaves the
/// tool where it is turns within that distance.
const TURNS: f64 = 0.5;
/// Directions that move the tool by less than this share of the longest column leave it where an arm is stretched out.
const SHARP: f64 = 1e-3;
/// Largest stiffness that a measurement shows, radians a radian: targets that move change the slope, too.
const MAX_STIFFNESS: f64 = 20.0;
/// A motion that is none, radians.
const AT_EASE: f64 = 1e-9;

impl Arm {
    /// Whether there may be motions that leave the tool where it is.
    pub(super) fn has_freedom(&self) -> bool {
        self.joint_count() > self.options.goal.rows() || self.options.goal.has_room()
    }

    /// The posture that an arm's freedom is spent on that begins at `start`.
    pub(super) fn ease_from(&self, start: &[f64]) -> Vec<f64> {
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

    /// The pull on every joint, radians.
    fn pull(&self, q: &[f64], ease: &[f64], pull: &mut [f64]) {
        let map = &self.serial.map;
        let limit = self.options.limit_avoidance;
        for (i, pull) in pull.iter_mut().enumerate() {
            let (lower, upper) = (map.lower()[i], map.upper()[i]);
            let nearer = outwards(q[i], lower, upper) - outwards(ease[i], lower, upper);
            *pull = (ease[i] - q[i]) * self.scale[i] - limit * nearer;
        }
    }

    /// How fast the pull at q grows along a motion, radians a radian: at least 1, the spring's.
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

/// How an arm goes to ease.
pub(super) struct Easing<'e> {
    pub(super) ease: &'e [f64],
    /// The side that an arm keeps which is stretched out towards a target that it misses.
    pub(super) stretched: Option<&'e Bend>,
    /// Share of the distance to the lowest point that is taken, 0 to 1.
    pub(super) share: f64,
    /// Last motion, and the slope before it, radians a joint: how much the slope changed since shows how stiff the null space is.
    pub(super) last: &'e [f64],
    pub(super) last_slope: &'e [f64],
    /// Least stiffness along the motion, radians a radian.
    pub(super) stiffness: f64,
    /// The longest motion of a joint, radians.
    pub(super) longest: f64,
    /// What the workspace's [`factor_freely`](ArmWorkspace::factor_freely) gave at x, if that is known.
    pub(super) free: Option<&'e Factor>,
}

impl Easing<'_> {
    /// Stiffness along the last motion, by the change of the slope. The null space is curved: the stiffness of the pull alone is too
    /// small there, and a step by it overshoots.
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
    /// Writes into `projected` the motion to ease from x that leaves the tool where it is, radians a joint.
    /// The Jacobian at x is here (or [one](ArmWorkspace::take_twists) of its null space). Returns whether there is any motion, and the
    /// least stiffness for the next step.
    pub(super) fn aim_at_ease(&mut self, arm: &Arm, x: &[f64], how: &Easing<'_>) -> (bool, f64) {
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
        let moves = most > AT_EASE;
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

    /// Goes from x by the motion in `projected`, within the bounds.
    pub(super) fn go_by_projected(&mut self) {
        for (i, x) in self.x.iter_mut().enumerate() {
            let moved = *x + self.projected[i] / self.scale[i];
            *x = self.question.clamp(i, moved);
        }
    }
}

/// How fast [`outwards`] grows, 1 a radian or metre.
fn steepness(q: f64, lower: f64, upper: f64) -> f64 {
    let Some((u, half)) = place(q, lower, upper) else {
        return 0.0;
    };
    2.0 * (u.abs() - MIDDLE) / ((1.0 - MIDDLE) * (1.0 - MIDDLE) * half)
}

/// How near a joint is to its limits: 0 in the middle of its range, from −1 on its lower limit to 1 on
/// its upper.
fn outwards(q: f64, lower: f64, upper: f64) -> f64 {
    let Some((u, _)) = place(q, lower, upper) else {
        return 0.0;
    };
    let beyond = (u.abs() - MIDDLE) / (1.0 - MIDDLE);
    beyond * beyond * u.signum()
}

/// Where a joint is in its range, from −1 on its lower limit to 1 on its upper, and half that range; none where
/// there is no such range, and in its middle.
fn place(q: f64, lower: f64, upper: f64) -> Option<(f64, f64)> {
    let half = 0.5 * (upper - lower);
    let from_middle = q - lower - half;
    let near_limit = half > 0.0 && half.is_finite() && from_middle.abs() > MIDDLE * half;
    near_limit.then(|| (from_middle / half, half))
}
