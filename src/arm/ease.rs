//! What an arm's freedom is spent on while it follows.
//!
//! Every joint is drawn to the posture of ease (the start, or the posture asked for), and away from its
//! limits by as much more as it is nearer to them than it is at ease: the slope of a convex function of the
//! joints whose lowest point is the posture of ease (the Bregman distance of a spring and the limits'
//! pull). What of it leaves the tool where it is moves the arm, until nothing is left to move. So where
//! an arm rests depends on its target and on the posture of ease, not on the way that it came.

use super::query::Arm;
use super::workspace::Workspace;

/// The share of a joint's half range from which on its limit is felt.
const MIDDLE: f64 = 0.6;
/// A motion that is none, radians.
const AT_EASE: f64 = 1e-9;
/// The longest motion in one go, as a share of the distance from the nearest singular place, on the way
/// and at rest (where [`Pace`](super::pace::Pace) ends going back and forth).
const ON_THE_WAY: f64 = 0.4;
const AT_REST: f64 = 1.0;
/// The pull of a limit where a joint is on it, radians, for a limit avoidance of 1.
const ON_LIMIT: f64 = 8.0;

impl Arm {
    /// The pull on every joint, radians.
    pub(super) fn pull(&self, q: &[f64], ease: &[f64], pull: &mut [f64]) {
        let map = &self.serial.map;
        let limit = ON_LIMIT * self.options.limit_avoidance;
        for (i, pull) in pull.iter_mut().enumerate() {
            let (lower, upper) = (map.lower()[i], map.upper()[i]);
            let nearer = outwards(q[i], lower, upper) - outwards(ease[i], lower, upper);
            *pull = (ease[i] - q[i]) * self.scale[i] - limit * nearer;
        }
    }

    /// Whether there may be motions that leave the tool where it is.
    pub(super) fn has_freedom(&self) -> bool {
        self.joint_count() > self.options.goal.rows() || self.options.goal.has_room()
    }
}

impl Workspace {
    /// Adds to x a share of the motion to the posture of ease that leaves the tool where it is, no joint
    /// further than `most`. The Jacobian at x is here. Whether anything moved.
    pub(super) fn ease_off(
        &mut self,
        arm: &Arm,
        ease: &[f64],
        share: f64,
        rests: bool,
        most: impl Fn(usize) -> f64,
    ) -> bool {
        let mut pull = std::mem::take(&mut self.wanted);
        let mut x = std::mem::take(&mut self.x);
        arm.pull(&x, ease, &mut pull);
        let clearance = self.project_to_null(&x, &pull);
        let (mut longest, mut shortest) = (0.0_f64, 1.0_f64);
        for (i, by) in self.projected.iter_mut().enumerate() {
            *by *= share;
            longest = longest.max(by.abs() * self.scale[i]);
            let most = most(i);
            if by.abs() > most {
                shortest = shortest.min(most / by.abs());
            }
        }
        let room = if rests { AT_REST } else { ON_THE_WAY };
        // Near a singular place what leaves the tool where it is changes within that distance.
        shortest = shortest.min(room * clearance / longest);
        let moves = longest > AT_EASE;
        if moves {
            for (i, x) in x.iter_mut().enumerate() {
                let moved = *x + shortest * self.projected[i];
                *x = moved.max(self.lower[i]).min(self.upper[i]);
            }
        }
        self.x = x;
        self.wanted = pull;
        moves
    }
}

/// How near a joint is to its limits: 0 in the middle of its range, from −1 on its lower limit to 1 on
/// its upper.
pub(super) fn outwards(q: f64, lower: f64, upper: f64) -> f64 {
    let half = 0.5 * (upper - lower);
    if !(half > 0.0 && half.is_finite()) {
        return 0.0;
    }
    let u = (q - lower) / half - 1.0;
    let beyond = (u.abs() - MIDDLE).max(0.0) / (1.0 - MIDDLE);
    beyond * beyond * u.signum()
}
