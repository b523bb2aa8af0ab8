//! How far a ball joint may go: a cone for its swing, a range for its twist, an angle for both together.

use std::f64::consts::PI;

use super::Limits;
use crate::spatial::Vector3;

/// Limits of a ball joint, of its rotation parted into a twist about its axis and then a swing, which
/// tips that axis without turning about it (Grassia 1998, "Practical parameterization of rotations using
/// the exponential map", section 4).
///
/// The swing's rotation vector (axis × angle, across the twist axis) stays within an ellipse whose half axes
/// are the half angles of the cone: a circular cone where both are the same.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct BallLimits {
    /// How far the joint's axis may tip, in radians, within (0, π]: about [`about`](Self::about), and about what
    /// is across that and the joint's axis.
    pub swing: [f64; 2],
    /// How far it may turn about its axis, in radians.
    pub twist: Limits,
    /// The first axis of the ellipse, in the joint's own frame; what of it is along the joint's axis does not
    /// count. `None`: any, as for a circular cone.
    pub about: Option<Vector3<f64>>,
    /// How far it may turn in all, about whatever axis, in radians, above 0; `None`: as far as swing and twist let
    /// it. A whole turn there and back is π: more is no limit.
    #[cfg_attr(feature = "serde", serde(default))]
    pub angle: Option<f64>,
}

impl BallLimits {
    /// A circular cone of this half angle, and a range of twist, in radians.
    #[must_use]
    pub fn cone(swing: f64, twist: Limits) -> Self {
        Self {
            swing: [swing; 2],
            twist,
            about: None,
            angle: None,
        }
    }

    /// A turn about any axis by this angle at most, in radians.
    #[must_use]
    pub fn within_angle(angle: f64) -> Self {
        Self::cone(PI, Limits::UNBOUNDED).with_angle(angle)
    }

    /// The same with the whole rotation within an angle, in radians.
    #[must_use]
    pub fn with_angle(self, angle: f64) -> Self {
        Self {
            angle: Some(angle),
            ..self
        }
    }

    /// An elliptic cone: half angles of swing about `about` and about what is across that and the joint's
    /// axis, and a range of twist, in radians.
    #[must_use]
    pub fn elliptic(about: impl Into<Vector3<f64>>, swing: [f64; 2], twist: Limits) -> Self {
        Self {
            swing,
            twist,
            about: Some(about.into()),
            angle: None,
        }
    }

    /// Whether swing or twist are limited at all.
    pub(super) fn has_cone(&self) -> bool {
        let Limits { lower, upper } = self.twist;
        self.swing.iter().any(|&half| half < PI) || lower > -PI || upper < PI
    }

    /// What is wrong with it for a joint of this axis, if anything.
    pub(super) fn fault(&self, axis: Vector3<f64>) -> Option<&'static str> {
        let angle = |swing: f64| swing > 0.0 && swing <= PI;
        let turn = |end: f64| end.abs() <= PI || end.is_infinite();
        let ends = [self.twist.lower, self.twist.upper];
        if !self.swing.iter().all(|&swing| angle(swing)) {
            return Some("a swing that is not above 0 and at most π");
        }
        if !self.twist.is_valid() || !ends.into_iter().all(turn) {
            return Some("a twist that is no range within [-π, π]");
        }
        let least = self.twist.clamp(0.0).abs();
        if self
            .angle
            .is_some_and(|angle| angle <= least || angle.is_nan())
        {
            return Some("a whole angle that is not above 0, or below the least twist");
        }
        let about = self
            .about
            .map(|about| (about - axis * axis.dot(about)).norm());
        match about {
            Some(across) if !(across > 1e-9 && across.is_finite()) => {
                Some("a swing about the joint's own axis")
            }
            _ => None,
        }
    }
}
