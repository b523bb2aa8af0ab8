//! The three variables of a ball joint: what they make of its quaternion, and their bounds.

use super::{BallLimits, Limits, RotationChart};
use crate::spatial::{Quaternion, Vector3};

/// The three variables of a ball joint.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct BallVariables {
    /// Where its quaternion begins in a configuration.
    pub(crate) coordinate: usize,
    /// The first of the three.
    pub(crate) variable: usize,
    /// What they mean.
    pub(crate) chart: RotationChart,
    /// The half axes of the ellipse that the first two stay in, in radians.
    pub(crate) swing: Option<[f64; 2]>,
    /// How far it may turn in all, in radians.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) angle: Option<f64>,
}

/// An axis that is swung right round is so by any swing, each with another twist: a quaternion there does not tell
/// which it was. So near to that none comes, in radians, that rounding leaves the direction to nine digits.
const WIDEST_SWING: f64 = std::f64::consts::PI - 1e-7;

impl BallVariables {
    /// Of a joint whose quaternion and variables begin here, within these limits.
    pub(super) fn new(
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
            swing: cone.map(|limits| limits.swing.map(|half| half.min(WIDEST_SWING))),
            angle: limits.and_then(|limits| limits.angle),
        }
    }

    /// Its part of x.
    pub(crate) fn of<S: Copy>(&self, x: &[S]) -> Option<[S; 3]> {
        x.get(self.variable..)?.first_chunk().copied()
    }

    /// By what angle it is turned from one x to another.
    pub(crate) fn angle_between(&self, from: &[f64], to: &[f64]) -> f64 {
        let turned = self.of(from).zip(self.of(to)).map(|(from, to)| {
            let back = self.chart.rotation(from).conjugate();
            (back * self.chart.rotation(to)).log().norm()
        });
        turned.unwrap_or(0.0)
    }

    /// The derivatives of w, x, y and z by each variable: ½ ω q for the angular velocity ω that goes with
    /// its rate.
    pub(super) fn slopes(&self, x: [f64; 3]) -> [[f64; 3]; 4] {
        let rotation = self.chart.rotation(x);
        let mut slopes = [[0.0; 3]; 4];
        for (k, omega) in self.chart.axes(x).into_iter().enumerate() {
            let half = Quaternion {
                w: 0.0,
                v: omega * 0.5,
            };
            let Quaternion { w, v } = half * rotation;
            for (slopes, part) in slopes.iter_mut().zip([w, v.x, v.y, v.z]) {
                slopes[k] = part;
            }
        }
        slopes
    }

    /// Bounds of the three.
    pub(super) fn bounds(&self, limits: Option<&BallLimits>) -> [Limits; 3] {
        match (self.swing, limits) {
            (Some([a, b]), Some(limits)) => [Limits::new(-a, a), Limits::new(-b, b), limits.twist],
            _ => [Limits::UNBOUNDED; 3],
        }
    }
}
