//! The three solver variables of a ball joint: derivatives of its quaternion and bounds.

use super::{BallLimits, RotationChart};
use crate::model::Limits;
use crate::spatial::{Quaternion, Vector3};

/// The three variables of a ball joint.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[doc(hidden)]
pub struct BallVariables {
    /// Index of its first quaternion component in a configuration.
    #[doc(hidden)]
    pub coordinate: usize,
    /// Index of its first variable.
    #[doc(hidden)]
    pub variable: usize,
    /// Map from the variables to a rotation.
    #[doc(hidden)]
    pub chart: RotationChart,
    /// Half axes of the ellipse that bounds the first two variables, radians; `None`: no cone.
    #[doc(hidden)]
    pub swing: Option<[f64; 2]>,
    /// Largest total rotation angle, radians; `None`: no limit.
    #[cfg_attr(feature = "serde", serde(default))]
    #[doc(hidden)]
    pub angle: Option<f64>,
}

/// Largest half angle of a swing, radians.
///
/// At π the same quaternion belongs to every swing direction, each with another twist. This far below π, rounding
/// leaves nine digits of the direction.
const MAX_SWING: f64 = std::f64::consts::PI - 1e-7;

impl BallVariables {
    /// The variables of a joint whose quaternion starts at `coordinate` and whose variables start at `variable`.
    pub(in crate::model) fn new(
        coordinate: usize,
        variable: usize,
        axis: Vector3<f64>,
        limits: Option<&BallLimits>,
    ) -> Self {
        let cone = limits.filter(|limits| limits.has_cone());
        Self {
            coordinate,
            variable,
            chart: RotationChart::new(axis, limits),
            swing: cone.map(|limits| limits.swing.map(|half| half.min(MAX_SWING))),
            angle: limits.and_then(|limits| limits.angle),
        }
    }

    /// The three variables in `x`; `None` if `x` is too short.
    #[doc(hidden)]
    pub fn of<S: Copy>(&self, x: &[S]) -> Option<[S; 3]> {
        x.get(self.variable..)?.first_chunk().copied()
    }

    /// Angle of the rotation from one x to another, radians; 0 if an x is too short.
    #[doc(hidden)]
    pub fn angle_between(&self, from: &[f64], to: &[f64]) -> f64 {
        let angle = self.of(from).zip(self.of(to)).map(|(from, to)| {
            let inverse = self.chart.rotation(from).conjugate();
            (inverse * self.chart.rotation(to)).log().norm()
        });
        angle.unwrap_or(0.0)
    }

    /// Derivatives of w, x, y and z by each variable: ½ ω q with the angular velocity ω of a unit rate.
    pub(in crate::model) fn slopes(&self, x: [f64; 3]) -> [[f64; 3]; 4] {
        let rotation = self.chart.rotation(x);
        let mut slopes = [[0.0; 3]; 4];
        for (k, omega) in self.chart.axes(x).into_iter().enumerate() {
            let half = Quaternion {
                w: 0.0,
                v: omega * 0.5,
            };
            let Quaternion { w, v } = half * rotation;
            for (slopes, component) in slopes.iter_mut().zip([w, v.x, v.y, v.z]) {
                slopes[k] = component;
            }
        }
        slopes
    }

    /// Bounds of the three variables, radians.
    pub(in crate::model) fn bounds(&self, limits: Option<&BallLimits>) -> [Limits; 3] {
        match (self.swing, limits) {
            (Some([a, b]), Some(limits)) => [Limits::new(-a, a), Limits::new(-b, b), limits.twist],
            _ => [Limits::UNBOUNDED; 3],
        }
    }
}
