//! Rotation exponential and logarithm, exact in values and derivatives at 0, near 0 and near π.
//!
//! Both use the unit quaternion. Its half angle avoids the angles at which the matrix formulas lose half the digits.
//!
//! - Grassia 1998, "Practical parameterization of rotations using the exponential map".
//! - Shepperd 1978: the quaternion of a matrix.

use std::ops::Mul;

use super::{Matrix3, Vector3};
use crate::scalar::{Scalar, elementary};

/// A quaternion w + xi + yj + zk.
///
/// A unit quaternion is a rotation; q and −q are the same rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Quaternion<S> {
    /// Real part, cos(θ/2) for a rotation by θ.
    pub w: S,
    /// Imaginary part, axis · sin(θ/2).
    pub v: Vector3<S>,
}

impl<S: Scalar> Quaternion<S> {
    /// The rotation by the rotation vector `omega` (axis × angle in radians).
    #[inline(always)]
    pub fn exp(omega: Vector3<S>) -> Self {
        let squared = omega.norm_squared();
        let small = squared.less_than(S::constant(1e-4));
        let angle = S::select(small, S::one(), squared).sqrt();
        let half = S::constant(0.5);
        let (sin, cos) = (angle * half).sin_cos();
        // sin(θ/2)/θ and cos(θ/2) as polynomials in θ²; the next terms are below 1e-17 here.
        let near_zero_sin = polynomial(
            squared,
            &[1.0 / 2.0, -1.0 / 48.0, 1.0 / 3840.0, -1.0 / 645_120.0],
        );
        let near_zero_cos = polynomial(squared, &[1.0, -1.0 / 8.0, 1.0 / 384.0, -1.0 / 46_080.0]);
        Self {
            w: S::select(small, near_zero_cos, cos),
            v: omega * S::select(small, near_zero_sin, sin / angle),
        }
    }

    /// The rotation vector (axis × angle in radians, angle within [0, π]) of a unit quaternion.
    #[inline(always)]
    pub fn log(self) -> Vector3<S> {
        let negative = self.w.less_than(S::zero());
        let w = S::select(negative, -self.w, self.w);
        let v = Vector3::select(negative, -self.v, self.v);
        let squared = v.norm_squared();
        let small = squared.less_than(S::constant(1e-6));
        let length = S::select(small, S::one(), squared).sqrt();
        let angle_over_length = S::constant(2.0) * length.atan2(w) / length;
        // 2 atan(t)/t / w with t = |v|/w; here t² < 1.1e-6, so the next term is below 1e-19.
        let safe_w = S::select(small, w, S::one());
        let ratio = squared / (safe_w * safe_w);
        let near_zero = polynomial(ratio, &[2.0, -2.0 / 3.0, 2.0 / 5.0]) / safe_w;
        v * S::select(small, near_zero, angle_over_length)
    }

    /// The quaternion of a rotation matrix.
    ///
    /// Uses the one of Shepperd's four formulas with the largest divisor, which loses no digits.
    #[inline(always)]
    pub fn from_matrix(m: &Matrix3<S>) -> Self {
        let (xx, yy, zz) = (m.x.x, m.y.y, m.z.z);
        let one = S::one();
        // Each row is 4·c·(w, x, y, z) for one component c, so its entry for c is 4c².
        let four_ww = one + xx + yy + zz;
        let four_xx = one + xx - yy - zz;
        let four_yy = one - xx + yy - zz;
        let four_zz = one - xx - yy + zz;
        let (wx, wy, wz) = (m.y.z - m.z.y, m.z.x - m.x.z, m.x.y - m.y.x);
        let (xy, xz, yz) = (m.x.y + m.y.x, m.x.z + m.z.x, m.y.z + m.z.y);

        let mut best = four_ww;
        let mut row = Self {
            w: four_ww,
            v: Vector3::new(wx, wy, wz),
        };
        let candidates = [
            (four_xx, wx, Vector3::new(four_xx, xy, xz)),
            (four_yy, wy, Vector3::new(xy, four_yy, yz)),
            (four_zz, wz, Vector3::new(xz, yz, four_zz)),
        ];
        for (size, w, v) in candidates {
            let better = best.less_than(size);
            best = S::select(better, size, best);
            row.w = S::select(better, w, row.w);
            row.v = Vector3::select(better, v, row.v);
        }
        let scale = S::constant(0.5) / best.sqrt();
        Self {
            w: row.w * scale,
            v: row.v * scale,
        }
    }

    /// The rotation matrix of a unit quaternion.
    #[inline(always)]
    pub fn to_matrix(self) -> Matrix3<S> {
        let Vector3 { x, y, z } = self.v;
        let w = self.w;
        let (x2, y2, z2) = (x + x, y + y, z + z);
        let one = S::one();
        Matrix3::from_columns(
            Vector3::new(one - y * y2 - z * z2, x * y2 + w * z2, x * z2 - w * y2),
            Vector3::new(x * y2 - w * z2, one - x * x2 - z * z2, y * z2 + w * x2),
            Vector3::new(x * z2 + w * y2, y * z2 - w * x2, one - x * x2 - y * y2),
        )
    }

    /// The inverse of a unit quaternion.
    #[inline(always)]
    pub fn conjugate(self) -> Self {
        Self {
            w: self.w,
            v: -self.v,
        }
    }
}

impl<S: Scalar> Mul for Quaternion<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self {
            w: self.w * other.w - self.v.dot(other.v),
            v: other.v * self.w + self.v * other.w + self.v.cross(other.v),
        }
    }
}

/// The rotation matrix of a rotation vector (axis × angle in radians).
#[inline(always)]
pub fn rotation_exp<S: Scalar>(omega: Vector3<S>) -> Matrix3<S> {
    Quaternion::exp(omega).to_matrix()
}

/// The rotation vector (axis × angle in radians, angle within [0, π]) of a rotation matrix.
///
/// At exactly π both signs of the axis are right; returns one of them, with its one-sided derivative.
#[inline(always)]
pub fn rotation_log<S: Scalar>(rotation: &Matrix3<S>) -> Vector3<S> {
    Quaternion::from_matrix(rotation).log()
}

/// Derivative of the rotation vector φ when its rotation is rotated further about world axes.
///
/// ∂ log(exp(ω) exp(φ)) / ∂ω at ω = 0 is the inverse of the left Jacobian:
/// `J_l⁻¹ = I − ½[φ] + (1 − (θ/2) cot(θ/2)) [φ]²/θ²` (Chirikjian 2012, eq. 10.86).
#[must_use]
pub fn rotation_log_jacobian(phi: Vector3<f64>) -> Matrix3<f64> {
    let squared = phi.norm_squared();
    let half = 0.5 * squared.sqrt();
    let coefficient = if squared < 1e-3 {
        polynomial(
            squared,
            &[1.0 / 12.0, 1.0 / 720.0, 1.0 / 30_240.0, 1.0 / 1_209_600.0],
        )
    } else {
        let (sin, cos) = elementary::sin_cos(half);
        (1.0 - half * cos / sin) / squared
    };
    let column = |unit: Vector3<f64>| {
        let crossed = phi.cross(unit);
        unit - crossed * 0.5 + phi.cross(crossed) * coefficient
    };
    let [x, y, z] = Vector3::UNITS.map(column);
    Matrix3::from_columns(x, y, z)
}

/// Left Jacobian: maps the rate φ̇ of a rotation vector to the angular velocity ω = J_l φ̇, in the reference frame.
///
/// `J_l = I + (1 − cos θ)/θ² [φ] + (θ − sin θ)/θ³ [φ]²` (Chirikjian 2012, eq. 10.86).
#[inline(always)]
pub fn rotation_exp_jacobian<S: Scalar>(phi: Vector3<S>) -> Matrix3<S> {
    let squared = phi.norm_squared();
    let small = squared.less_than(S::constant(1e-2));
    let safe = S::select(small, S::one(), squared);
    let angle = safe.sqrt();
    let (sin, cos) = angle.sin_cos();
    // Polynomials in θ²; the next terms are below 1e-17 here.
    let near_once = polynomial(
        squared,
        &[
            1.0 / 2.0,
            -1.0 / 24.0,
            1.0 / 720.0,
            -1.0 / 40_320.0,
            1.0 / 3_628_800.0,
            -1.0 / 479_001_600.0,
        ],
    );
    let near_twice = polynomial(
        squared,
        &[
            1.0 / 6.0,
            -1.0 / 120.0,
            1.0 / 5040.0,
            -1.0 / 362_880.0,
            1.0 / 39_916_800.0,
            -1.0 / 6_227_020_800.0,
        ],
    );
    let first_coefficient = S::select(small, near_once, (S::one() - cos) / safe);
    let second_coefficient = S::select(small, near_twice, (angle - sin) / (safe * angle));
    let column = |unit: Vector3<f64>| {
        let unit = Vector3::constant(unit);
        let crossed = phi.cross(unit);
        unit + crossed * first_coefficient + phi.cross(crossed) * second_coefficient
    };
    let [x, y, z] = Vector3::UNITS;
    Matrix3::from_columns(column(x), column(y), column(z))
}

/// Σ cₖ xᵏ by Horner's rule.
#[inline(always)]
fn polynomial<S: Scalar>(x: S, coefficients: &[f64]) -> S {
    coefficients
        .iter()
        .rev()
        .fold(S::zero(), |sum, &c| sum.mul_add(x, S::constant(c)))
}
