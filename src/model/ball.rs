//! How far a ball joint may go: a cone for its swing and a range for its twist.

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
}

impl BallLimits {
    /// A circular cone of this half angle, and a range of twist, in radians.
    #[must_use]
    pub fn cone(swing: f64, twist: Limits) -> Self {
        Self {
            swing: [swing; 2],
            twist,
            about: None,
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
        }
    }

    /// What is wrong with it for a joint of this axis, if anything.
    pub(super) fn fault(&self, axis: Vector3<f64>) -> Option<&'static str> {
        let angle = |swing: f64| swing > 0.0 && swing <= std::f64::consts::PI;
        let turn = |end: f64| end.abs() <= std::f64::consts::PI || end.is_infinite();
        let ends = [self.twist.lower, self.twist.upper];
        if !self.swing.iter().all(|&swing| angle(swing)) {
            return Some("a swing that is not above 0 and at most π");
        }
        if !self.twist.is_valid() || !ends.into_iter().all(turn) {
            return Some("a twist that is no range within [-π, π]");
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
