//! Euler angles in the twelve orders, accurate in and near gimbal lock.
//!
//! Conversion from a quaternion by Bernardes & Viollet 2022, "Quaternion to Euler angles conversion: a direct, general
//! and computationally efficient method". Two arc tangents give half the sum and half the difference of the outer
//! angles. Neither loses digits if the other is undefined.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DMat3, DQuat, DVec3};

use super::exponential::rotation_about_f64;
use kinopt_kinematics::scalar::elementary::{self, hypot};

/// Axis order of three angles. For the order ABC the rotation is R = R_A(angle 0) · R_B(angle 1) · R_C(angle 2).
///
/// Read from the left, each rotation is about an axis rotated by the previous ones (intrinsic). Read from the right,
/// the axes are fixed (extrinsic). R_z(γ) R_y(β) R_x(α), "about x, then y, then z", is [`Zyx`](Self::Zyx) with the
/// angles γ, β, α.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "lowercase")]
#[allow(missing_docs, reason = "the names are the axes")]
pub enum EulerOrder {
    /// Twist, bend, twist: the order of the bones of a [`Skeleton`](kinopt_kinematics::Skeleton).
    Xzx,
    Xyx,
    Yxy,
    Yzy,
    Zxz,
    Zyz,
    Xyz,
    Xzy,
    Yxz,
    Yzx,
    Zxy,
    Zyx,
}

/// Three Euler angles of one order, with a flag for gimbal lock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EulerAngles {
    /// Angles in radians, in axis order. The middle angle is within [0, π] for the six proper orders and [−π/2, π/2]
    /// for the six Tait-Bryan orders. The outer angles are within [−π, π].
    pub angles: [f64; 3],
    /// The middle angle is at an end of its range. The outer angles then rotate about one line, only their sum or
    /// difference is defined, and the last is set to zero.
    pub gimbal_lock: bool,
}

/// Distance in radians from an end of the middle angle's range that counts as gimbal lock. It bounds the rotation's
/// error.
const GIMBAL_LOCK_TOLERANCE: f64 = 1e-9;

impl EulerOrder {
    /// All twelve orders.
    pub const ALL: [Self; 12] = [
        Self::Xzx,
        Self::Xyx,
        Self::Yxy,
        Self::Yzy,
        Self::Zxz,
        Self::Zyz,
        Self::Xyz,
        Self::Xzy,
        Self::Yxz,
        Self::Yzx,
        Self::Zxy,
        Self::Zyx,
    ];

    /// Axis indices: x is 0, y 1, z 2.
    #[must_use]
    pub fn axes(self) -> [usize; 3] {
        match self {
            Self::Xzx => [0, 2, 0],
            Self::Xyx => [0, 1, 0],
            Self::Yxy => [1, 0, 1],
            Self::Yzy => [1, 2, 1],
            Self::Zxz => [2, 0, 2],
            Self::Zyz => [2, 1, 2],
            Self::Xyz => [0, 1, 2],
            Self::Xzy => [0, 2, 1],
            Self::Yxz => [1, 0, 2],
            Self::Yzx => [1, 2, 0],
            Self::Zxy => [2, 0, 1],
            Self::Zyx => [2, 1, 0],
        }
    }

    /// True if the first and the last axis are equal.
    #[must_use]
    pub fn is_proper(self) -> bool {
        let [first, _, last] = self.axes();
        first == last
    }

    /// Unit quaternion of the angles in radians.
    #[must_use]
    pub fn to_quaternion(self, angles: [f64; 3]) -> DQuat {
        let [a, b, c] = self.axes().map(|axis| DVec3::AXES[axis]);
        let [alpha, beta, gamma] = angles;
        rotation_about_f64(a, alpha) * rotation_about_f64(b, beta) * rotation_about_f64(c, gamma)
    }

    /// Rotation matrix of the angles in radians.
    #[must_use]
    pub fn to_matrix(self, angles: [f64; 3]) -> DMat3 {
        DMat3::from_quat(self.to_quaternion(angles))
    }

    /// Euler angles of a rotation matrix.
    #[must_use]
    pub fn from_matrix(self, rotation: &DMat3) -> EulerAngles {
        self.from_quaternion(DQuat::from_mat3(rotation).normalize())
    }

    /// Euler angles of a unit quaternion.
    #[must_use]
    pub fn from_quaternion(self, q: DQuat) -> EulerAngles {
        // The paper uses fixed axes, so the last axis comes first.
        let [k, j, i] = self.axes();
        let proper = self.is_proper();
        // For proper orders the axis that does not occur is the third one.
        let k = if proper { 3 - i - j } else { k };
        let sign = if (j + 3 - i) % 3 == 1 { 1.0 } else { -1.0 };
        let v = q.xyz().to_array();
        let [x, y, z] = [v[i], v[j], v[k] * sign];
        let [a, b, c, d] = if proper {
            [q.w, x, y, z]
        } else {
            // After a quarter turn about the middle axis, the order is a proper one.
            [q.w - y, x + z, y + q.w, z - x]
        };
        let middle = 2.0 * elementary::atan2(hypot(c, d), hypot(a, b));
        let [half_sum, half_difference] = [elementary::atan2(b, a), elementary::atan2(d, c)];
        let [near_zero, near_pi] = [
            middle < GIMBAL_LOCK_TOLERANCE,
            PI - middle < GIMBAL_LOCK_TOLERANCE,
        ];
        let [first, last] = if near_zero {
            [2.0 * half_sum, 0.0]
        } else if near_pi {
            [2.0 * half_difference, 0.0]
        } else {
            [half_sum + half_difference, half_sum - half_difference]
        };
        let [first, middle] = if proper {
            [first, middle]
        } else {
            [first * sign, middle - FRAC_PI_2]
        };
        EulerAngles {
            angles: [wrapped(first), middle, wrapped(last)],
            gimbal_lock: near_zero || near_pi,
        }
    }
}

/// Wraps an angle to [−π, π].
fn wrapped(angle: f64) -> f64 {
    if angle > PI {
        angle - 2.0 * PI
    } else if angle < -PI {
        angle + 2.0 * PI
    } else {
        angle
    }
}
