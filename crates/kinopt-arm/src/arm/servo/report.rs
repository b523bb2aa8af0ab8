//! Report of one control cycle.

use kinopt_solver::ik::Side;
use kinopt_solver::search::Collision;

/// State of a servo after a cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ServoStatus {
    /// The tool is within the tolerances of its target.
    OnTarget,
    /// Moving to the target, as fast as a velocity, acceleration or jerk limit allows.
    SpeedLimited,
    /// Moving to the target with no joint at a limit: slowed by damping, or by the plan of a straight line.
    #[default]
    Settling,
    /// At rest at the closest pose of the current branch; the target is out of reach there.
    Nearest,
    /// Braking or at rest before a collision that the arm [avoids](crate::arm::Arm::with_checker); nothing is in contact.
    Blocked,
    /// A pair that was in contact at the start of the servo still is.
    ///
    /// The penetration never grows: the servo stops if the target leads farther in, and separates the pair if it leads
    /// away.
    Touching,
    /// Braking on request, see [`Servo::stop`](super::Servo::stop).
    Stopping,
    /// At rest after [`Servo::stop`](super::Servo::stop).
    Stopped,
}

/// Limit that determines a joint's motion in a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum HeldBy {
    /// Position limit on this side.
    Limit(Side),
    /// Velocity limit towards this side.
    Speed(Side),
    /// Acceleration or jerk limit towards this side, or the distance that the joint needs to brake.
    Acceleration(Side),
    /// The joint is beyond its position limit on this side and returns to it at its velocity limit.
    Outside(Side),
}

/// One control cycle of a [`Servo`](super::Servo): the commanded configuration and its errors.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct ServoStep<'s> {
    /// Commanded joint positions, radians or metres, exactly within the position limits unless the servo began outside.
    pub q: &'s [f64],
    /// Difference of `q` to the last cycle, divided by the time step, rad/s or m/s.
    pub velocity: &'s [f64],
    /// Difference of `velocity` to the last cycle, divided by the time step, rad/s² or m/s².
    pub acceleration: &'s [f64],
    /// State of the servo.
    pub status: ServoStatus,
    /// Distance of the tool from its target, metres.
    pub position_error: f64,
    /// Angle between the tool and its target, radians.
    pub orientation_error: f64,
    /// Pairs that block the motion, or that are in contact at `q`, the deepest first; empty on target.
    pub collisions: &'s [Collision],
    pub(super) held: &'s [Option<HeldBy>],
    pub(super) names: &'s [String],
}

impl<'s> ServoStep<'s> {
    /// Joints whose motion a limit determines, by name, with that limit.
    pub fn held(&self) -> impl Iterator<Item = (&'s str, HeldBy)> + 's {
        let joints = self.names.iter().zip(self.held);
        joints.filter_map(|(name, held)| held.map(|by| (name.as_str(), by)))
    }

    /// Returns true if the tool is within the tolerances of its target and nothing is in contact.
    ///
    /// The arm may still move: see `velocity`.
    #[must_use]
    pub fn reached(&self) -> bool {
        self.status == ServoStatus::OnTarget
    }
}
