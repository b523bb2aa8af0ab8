//! Charts of the rotation of a ball joint by three solver variables.
//!
//! Without a cone, the variables are the rotation vector. Its derivatives are exact for angles below 2π; a vector
//! longer than π is the same rotation as one within π. With a cone, the variables are the two angles of the swing and
//! the twist. The twist then has bounds and the swing an ellipse. This chart is singular only at a swing of π.

use std::f64::consts::PI;

use super::BallLimits;
use crate::model::{Limits, quaternion_at};
use crate::random::RandomStream;
use crate::scalar::Scalar;
use crate::spatial::{Quaternion, Vector3, rotation_exp_jacobian};

/// A map from three numbers to a rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[doc(hidden)]
pub enum RotationChart {
    /// Rotation vector, radians.
    Exponential,
    /// Swing about two axes perpendicular to the twist axis, and twist, radians.
    SwingTwist(SwingFrame),
}

/// The axes of swing and twist, orthonormal, in the joint frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[doc(hidden)]
pub struct SwingFrame {
    first: Vector3<f64>,
    second: Vector3<f64>,
    axis: Vector3<f64>,
}

impl RotationChart {
    /// The chart of a ball joint with this unit axis.
    pub(in crate::model) fn new(axis: Vector3<f64>, limits: Option<&BallLimits>) -> Self {
        let cone = limits.filter(|limits| limits.has_cone());
        cone.map_or(Self::Exponential, |limits| {
            Self::SwingTwist(SwingFrame::new(axis, limits.about))
        })
    }

    /// The rotation at `x`, radians.
    #[doc(hidden)]
    pub fn rotation<S: Scalar>(&self, x: [S; 3]) -> Quaternion<S> {
        match self {
            Self::Exponential => Quaternion::exp(Vector3::new(x[0], x[1], x[2])),
            Self::SwingTwist(frame) => {
                let twist = Quaternion::exp(Vector3::constant(frame.axis) * x[2]);
                Quaternion::exp(frame.swing([x[0], x[1]])) * twist
            }
        }
    }

    /// The variables of a unit quaternion; −q gives the variables of q.
    #[doc(hidden)]
    pub fn variables<S: Scalar>(&self, rotation: Quaternion<S>) -> [S; 3] {
        match self {
            Self::Exponential => rotation.log().to_array(),
            Self::SwingTwist(frame) => frame.swing_and_twist(rotation),
        }
    }

    /// True if a rotation is within the limits, up to `rounding` in radians and relative to the cone.
    pub(in crate::model) fn is_within(
        &self,
        rotation: Quaternion<f64>,
        limits: &BallLimits,
        rounding: f64,
    ) -> bool {
        let within_cone = match self {
            Self::Exponential => true,
            Self::SwingTwist(frame) => {
                let [first, second, twist] = frame.swing_and_twist(rotation);
                let [a, b] = limits.swing;
                let share = (first / a) * (first / a) + (second / b) * (second / b);
                let Limits { lower, upper } = limits.twist;
                share.sqrt() <= 1.0 + rounding
                    && (lower - rounding..=upper + rounding).contains(&twist)
            }
        };
        let angle = || rotation.log().norm();
        within_cone
            && limits
                .angle
                .is_none_or(|max_angle| angle() <= max_angle + rounding)
    }

    /// A sampled rotation within a cone and a range of twist, or within the angle of a joint without a cone.
    pub(in crate::model) fn sample(
        &self,
        limits: &BallLimits,
        random: &mut RandomStream,
    ) -> Quaternion<f64> {
        match self {
            Self::Exponential => {
                let max_angle = limits.angle.unwrap_or(PI).min(PI);
                Quaternion::exp(Vector3::from(sample_in_ball(random)) * max_angle)
            }
            Self::SwingTwist(_) => {
                let [first, second] = sample_in_ball(random);
                let [a, b] = limits.swing;
                let (lower, upper) = limits.twist.sampling_range(0.0, PI);
                let twist = lower + (upper - lower) * random.unit();
                self.rotation([a * first, b * second, twist])
            }
        }
    }

    /// Angular velocity for a unit rate of each variable, in the joint frame before its rotation.
    #[inline(always)]
    #[doc(hidden)]
    pub fn axes<S: Scalar>(&self, x: [S; 3]) -> [Vector3<S>; 3] {
        match self {
            Self::Exponential => {
                let columns = rotation_exp_jacobian(Vector3::new(x[0], x[1], x[2]));
                [columns.x, columns.y, columns.z]
            }
            Self::SwingTwist(frame) => {
                let swing = frame.swing([x[0], x[1]]);
                let swing_jacobian = rotation_exp_jacobian(swing);
                let swing_rotation = Quaternion::exp(swing).to_matrix();
                [
                    swing_jacobian * Vector3::constant(frame.first),
                    swing_jacobian * Vector3::constant(frame.second),
                    swing_rotation * Vector3::constant(frame.axis),
                ]
            }
        }
    }
}

impl SwingFrame {
    /// The axes for a joint's unit axis and the first axis of its ellipse.
    fn new(axis: Vector3<f64>, about: Option<Vector3<f64>>) -> Self {
        let [x, y, _] = Vector3::UNITS;
        // Any perpendicular direction works: take the coordinate axis farther from the joint axis.
        let perpendicular_axis = match axis.x.abs() < axis.y.abs() {
            true => x,
            false => y,
        };
        let about = about.unwrap_or(perpendicular_axis);
        let perpendicular = about - axis * axis.dot(about);
        let first = perpendicular * (1.0 / perpendicular.norm());
        Self {
            first,
            second: axis.cross(first),
            axis,
        }
    }

    /// The rotation vector of a swing, radians.
    #[inline(always)]
    fn swing<S: Scalar>(&self, x: [S; 2]) -> Vector3<S> {
        Vector3::constant(self.first) * x[0] + Vector3::constant(self.second) * x[1]
    }

    /// Splits a rotation into swing, by the two perpendicular axes, and twist, radians.
    fn swing_and_twist<S: Scalar>(&self, rotation: Quaternion<S>) -> [S; 3] {
        let (one, zero) = (S::one(), S::zero());
        let along = Vector3::constant(self.axis).dot(rotation.v);
        let negative = rotation.w.less_than(zero);
        let w = S::select(negative, -rotation.w, rotation.w);
        let along = S::select(negative, -along, along);
        let v = Vector3::select(negative, -rotation.v, rotation.v);
        let squared = w * w + along * along;
        // At a swing of π the twist is undetermined; it is set to zero.
        let none = squared.less_than(S::constant(f64::MIN_POSITIVE));
        let length = S::select(none, one, squared).sqrt();
        let (cos, sin) = (
            S::select(none, one, w / length),
            S::select(none, zero, along / length),
        );
        let untwisted = Quaternion {
            w: cos,
            v: Vector3::constant(self.axis) * -sin,
        };
        let swing = (Quaternion { w, v } * untwisted).log();
        [
            Vector3::constant(self.first).dot(swing),
            Vector3::constant(self.second).dot(swing),
            S::constant(2.0) * sin.atan2(cos),
        ]
    }
}

/// A rotation sampled uniformly over all rotations: a normalised point of the four-dimensional unit ball.
pub(in crate::model) fn sample_rotation(random: &mut RandomStream) -> Quaternion<f64> {
    let components: [f64; 4] = sample_in_ball(random);
    quaternion_at(&components).unwrap_or(Quaternion::exp(Vector3::zero()))
}

/// A point sampled uniformly within the `N`-dimensional unit ball.
fn sample_in_ball<const N: usize>(random: &mut RandomStream) -> [f64; N] {
    for _ in 0..1000 {
        let point: [f64; N] = std::array::from_fn(|_| 2.0 * random.unit() - 1.0);
        if point.iter().map(|c| c * c).sum::<f64>() < 1.0 {
            return point;
        }
    }
    [0.0; N]
}
