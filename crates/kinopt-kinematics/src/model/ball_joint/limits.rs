//! Limits of ball joints: a swing cone, a twist range and a total rotation angle.

use std::f64::consts::PI;

use crate::model::Limits;
use crate::spatial::Vector3;

/// Limits of a ball joint, on its rotation split into a twist about the joint axis and then a swing.
///
/// The swing tips the joint axis without rotation about it (Grassia 1998, "Practical parameterization of rotations
/// using the exponential map", section 4). The rotation vector of the swing is perpendicular to the twist axis. It
/// stays within an ellipse whose half axes are the half angles of the cone. Equal half angles give a circular cone.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct BallLimits {
    /// Half angles of the cone, radians, within (0, π].
    ///
    /// The first is about [`about`](Self::about), the second about the direction perpendicular to that and to the joint
    /// axis.
    pub swing: [f64; 2],
    /// Range of rotation about the joint axis, radians.
    pub twist: Limits,
    /// The first axis of the ellipse, in the joint's frame; its component along the joint axis is ignored.
    ///
    /// `None`: any direction, which suits a circular cone.
    pub about: Option<Vector3<f64>>,
    /// Largest total rotation angle about any axis, radians, above 0; `None`: limited by swing and twist only.
    ///
    /// Values of π or more set no limit.
    #[cfg_attr(feature = "serde", serde(default))]
    pub angle: Option<f64>,
}

impl BallLimits {
    /// A circular cone with this half angle and a range of twist, both in radians.
    #[must_use]
    pub fn cone(swing: f64, twist: Limits) -> Self {
        Self {
            swing: [swing; 2],
            twist,
            about: None,
            angle: None,
        }
    }

    /// A rotation about any axis by at most this angle, radians.
    #[must_use]
    pub fn within_angle(angle: f64) -> Self {
        Self::cone(PI, Limits::UNBOUNDED).with_angle(angle)
    }

    /// Adds a limit on the total rotation angle, radians.
    #[must_use]
    pub fn with_angle(self, angle: f64) -> Self {
        Self {
            angle: Some(angle),
            ..self
        }
    }

    /// An elliptic cone and a range of twist, in radians.
    ///
    /// `swing` holds the half angles about `about` and about the direction perpendicular to `about` and to the joint
    /// axis.
    #[must_use]
    pub fn elliptic(about: impl Into<Vector3<f64>>, swing: [f64; 2], twist: Limits) -> Self {
        Self {
            swing,
            twist,
            about: Some(about.into()),
            angle: None,
        }
    }

    /// True if swing or twist is limited.
    pub(in crate::model) fn has_cone(&self) -> bool {
        let Limits { lower, upper } = self.twist;
        self.swing.iter().any(|&half| half < PI) || lower > -PI || upper < PI
    }

    /// The reason why the limits are invalid for a joint with this unit axis; `None` if they are valid.
    pub(in crate::model) fn fault(&self, axis: Vector3<f64>) -> Option<&'static str> {
        let angle = |swing: f64| swing > 0.0 && swing <= PI;
        let is_valid_end = |end: f64| end.abs() <= PI || end.is_infinite();
        let ends = [self.twist.lower, self.twist.upper];
        if !self.swing.iter().all(|&swing| angle(swing)) {
            return Some("a swing limit outside (0, π]");
        }
        if !self.twist.is_valid() || !ends.into_iter().all(is_valid_end) {
            return Some("twist limits that are not an interval within [-π, π]");
        }
        let min_angle = self.twist.clamp(0.0).abs();
        if self
            .angle
            .is_some_and(|angle| angle <= min_angle || angle.is_nan())
        {
            return Some("an angle limit that is not above 0, or below the smallest twist");
        }
        let about = self
            .about
            .map(|about| (about - axis * axis.dot(about)).norm());
        match about {
            Some(perpendicular) if !(perpendicular > 1e-9 && perpendicular.is_finite()) => {
                Some("a swing axis parallel to the joint's axis")
            }
            _ => None,
        }
    }
}
