//! 3×3 matrices, stored by columns: rotations and their derivatives.

use std::ops::Mul;

use super::Vector3;
use crate::scalar::{Scalar, elementary};

/// A 3×3 matrix of scalars.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Matrix3<S> {
    /// First column.
    pub x: Vector3<S>,
    /// Second column.
    pub y: Vector3<S>,
    /// Third column.
    pub z: Vector3<S>,
}

impl<S: Scalar> Matrix3<S> {
    /// A matrix from its columns.
    #[inline(always)]
    pub fn from_columns(x: Vector3<S>, y: Vector3<S>, z: Vector3<S>) -> Self {
        Self { x, y, z }
    }

    /// The identity matrix.
    #[inline(always)]
    pub fn identity() -> Self {
        let (one, zero) = (S::one(), S::zero());
        Self::from_columns(
            Vector3::new(one, zero, zero),
            Vector3::new(zero, one, zero),
            Vector3::new(zero, zero, one),
        )
    }

    /// A matrix whose derivatives are zero, the same in every lane.
    #[inline(always)]
    pub fn constant(value: Matrix3<f64>) -> Self {
        Self::from_columns(
            Vector3::constant(value.x),
            Vector3::constant(value.y),
            Vector3::constant(value.z),
        )
    }

    /// Rotation about the unit vector `axis` by the angle with the given sine and cosine (Rodrigues' formula).
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn rotation(axis: Vector3<S>, (sin, cos): (S, S)) -> Self {
        let Vector3 { x, y, z } = axis;
        let one_minus_cos = S::one() - cos;
        let (kx, ky, kz) = (x * one_minus_cos, y * one_minus_cos, z * one_minus_cos);
        let (sx, sy, sz) = (x * sin, y * sin, z * sin);
        Self::from_columns(
            Vector3::new(kx.mul_add(x, cos), kx.mul_add(y, sz), kx.mul_add(z, -sy)),
            Vector3::new(ky.mul_add(x, -sz), ky.mul_add(y, cos), ky.mul_add(z, sx)),
            Vector3::new(kz.mul_add(x, sy), kz.mul_add(y, -sx), kz.mul_add(z, cos)),
        )
    }

    /// `self · R_x(angle)`; changes two columns only.
    #[inline(always)]
    pub fn rotated_about_x(self, (sin, cos): (S, S)) -> Self {
        Self::from_columns(
            self.x,
            self.y.mul_add(cos, self.z * sin),
            self.z.mul_add(cos, -(self.y * sin)),
        )
    }

    /// `self · R_y(angle)`; changes two columns only.
    #[inline(always)]
    pub fn rotated_about_y(self, (sin, cos): (S, S)) -> Self {
        Self::from_columns(
            self.x.mul_add(cos, -(self.z * sin)),
            self.y,
            self.z.mul_add(cos, self.x * sin),
        )
    }

    /// `self · R_z(angle)`; changes two columns only.
    #[inline(always)]
    pub fn rotated_about_z(self, (sin, cos): (S, S)) -> Self {
        Self::from_columns(
            self.x.mul_add(cos, self.y * sin),
            self.y.mul_add(cos, -(self.x * sin)),
            self.z,
        )
    }

    /// The transpose, which is the inverse of a rotation.
    #[inline(always)]
    pub fn transpose(self) -> Self {
        Self::from_columns(
            Vector3::new(self.x.x, self.y.x, self.z.x),
            Vector3::new(self.x.y, self.y.y, self.z.y),
            Vector3::new(self.x.z, self.y.z, self.z.z),
        )
    }

    /// `selfᵀ · v`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn transpose_mul(self, v: Vector3<S>) -> Vector3<S> {
        Vector3::new(self.x.dot(v), self.y.dot(v), self.z.dot(v))
    }
}

impl Matrix3<f64> {
    /// Rotation from roll, pitch and yaw in radians about the fixed x, y and z axes, as in URDF: R_z(yaw) · R_y(pitch) ·
    /// R_x(roll).
    ///
    /// Sines and cosines below 1e-15 are exact zeros, so that axes stay aligned at multiples of π/2.
    #[must_use]
    pub fn from_roll_pitch_yaw([roll, pitch, yaw]: [f64; 3]) -> Self {
        Self::identity()
            .rotated_about_z(elementary::clean_sin_cos(yaw))
            .rotated_about_y(elementary::clean_sin_cos(pitch))
            .rotated_about_x(elementary::clean_sin_cos(roll))
    }
}

impl<S: Scalar> Mul<Vector3<S>> for Matrix3<S> {
    type Output = Vector3<S>;
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn mul(self, v: Vector3<S>) -> Vector3<S> {
        self.z.mul_add(v.z, self.y.mul_add(v.y, self.x * v.x))
    }
}

impl<S: Scalar> Mul for Matrix3<S> {
    type Output = Self;
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn mul(self, other: Self) -> Self {
        Self::from_columns(self * other.x, self * other.y, self * other.z)
    }
}
