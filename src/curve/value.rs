//! Value types of curves: numbers and vectors in single or double precision.

use std::ops::{Add, Div, Mul, Neg, Sub};

use glam::{DVec2, DVec3, DVec4, Vec2, Vec3, Vec3A, Vec4};

use crate::scalar::elementary::{self, single};

/// Scalar type of curves: `f32` or `f64`.
pub trait Real:
    Copy
    + std::fmt::Debug
    + PartialOrd
    + From<f32>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Power of a non-negative number.
    #[must_use]
    fn power(self, exponent: Self) -> Self;
    /// True if the number is neither NaN nor infinite.
    #[must_use]
    fn is_finite(self) -> bool;
    /// Conversion to double precision.
    #[must_use]
    fn as_f64(self) -> f64;
    /// Nearest number of this precision.
    #[must_use]
    fn from_f64(number: f64) -> Self;
}

/// Number or vector that can be added and scaled.
pub trait CurveValue:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<<Self as CurveValue>::Real, Output = Self>
{
    /// Scalar type of scale factors and times.
    type Real: Real;
    /// Euclidean length.
    #[must_use]
    fn length(self) -> Self::Real;
    /// True if all components are finite.
    #[must_use]
    fn all_finite(self) -> bool;
}

macro_rules! real {
    ($($real:ty: $power:path),*) => {$(
        impl Real for $real {
            fn power(self, exponent: Self) -> Self {
                $power(self, exponent)
            }
            fn is_finite(self) -> bool {
                <$real>::is_finite(self)
            }
            fn as_f64(self) -> f64 {
                f64::from(self)
            }
            fn from_f64(number: f64) -> Self {
                number as $real
            }
        }
        impl CurveValue for $real {
            type Real = $real;
            fn length(self) -> $real {
                self.abs()
            }
            fn all_finite(self) -> bool {
                <$real>::is_finite(self)
            }
        }
    )*};
}

macro_rules! vector {
    ($($vector:ty: $real:ty),*) => {$(
        impl CurveValue for $vector {
            type Real = $real;
            fn length(self) -> $real {
                <$vector>::length(self)
            }
            fn all_finite(self) -> bool {
                <$vector>::is_finite(self)
            }
        }
    )*};
}

real!(f32: single::pow, f64: elementary::pow);
vector!(Vec2: f32, Vec3: f32, Vec3A: f32, Vec4: f32, DVec2: f64, DVec3: f64, DVec4: f64);
