//! Three-dimensional vectors: points and directions.

use std::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};

use crate::scalar::Scalar;

/// A vector of three scalars.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Vector3<S> {
    /// First component.
    pub x: S,
    /// Second component.
    pub y: S,
    /// Third component.
    pub z: S,
}

impl<S: Scalar> Vector3<S> {
    /// A vector from its components.
    #[inline(always)]
    pub fn new(x: S, y: S, z: S) -> Self {
        Self { x, y, z }
    }

    /// The zero vector.
    #[inline(always)]
    pub fn zero() -> Self {
        Self::new(S::zero(), S::zero(), S::zero())
    }

    /// A vector whose derivatives are zero, the same in every lane.
    #[inline(always)]
    pub fn constant(value: Vector3<f64>) -> Self {
        Self::new(
            S::constant(value.x),
            S::constant(value.y),
            S::constant(value.z),
        )
    }

    /// Inner product.
    #[inline(always)]
    pub fn dot(self, other: Self) -> S {
        self.z
            .mul_add(other.z, self.y.mul_add(other.y, self.x * other.x))
    }

    /// Cross product, right-handed.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            self.y.mul_add(other.z, -(self.z * other.y)),
            self.z.mul_add(other.x, -(self.x * other.z)),
            self.x.mul_add(other.y, -(self.y * other.x)),
        )
    }

    /// `self * factor + addend`.
    #[inline(always)]
    pub fn mul_add(self, factor: S, addend: Self) -> Self {
        Self::new(
            self.x.mul_add(factor, addend.x),
            self.y.mul_add(factor, addend.y),
            self.z.mul_add(factor, addend.z),
        )
    }

    /// Squared Euclidean length.
    #[inline(always)]
    pub fn norm_squared(self) -> S {
        self.dot(self)
    }

    /// Euclidean length. Its derivative at zero is infinite.
    #[inline(always)]
    pub fn norm(self) -> S {
        self.norm_squared().sqrt()
    }

    /// `yes` in lanes whose mask is set, `no` in all other lanes.
    #[inline(always)]
    pub fn select(mask: S::Mask, yes: Self, no: Self) -> Self {
        Self::new(
            S::select(mask, yes.x, no.x),
            S::select(mask, yes.y, no.y),
            S::select(mask, yes.z, no.z),
        )
    }

    /// The components in order.
    #[inline(always)]
    pub fn to_array(self) -> [S; 3] {
        [self.x, self.y, self.z]
    }
}

impl Vector3<f64> {
    /// The three coordinate axes.
    pub const UNITS: [Self; 3] = [
        Self {
            x: 1.0,
            y: 0.0,
            z: 0.0,
        },
        Self {
            x: 0.0,
            y: 1.0,
            z: 0.0,
        },
        Self {
            x: 0.0,
            y: 0.0,
            z: 1.0,
        },
    ];

    /// True if every component is finite.
    #[doc(hidden)]
    pub fn is_finite(&self) -> bool {
        self.to_array().iter().all(|number| number.is_finite())
    }
}

impl<S: Scalar> From<[S; 3]> for Vector3<S> {
    #[inline(always)]
    fn from([x, y, z]: [S; 3]) -> Self {
        Self::new(x, y, z)
    }
}

impl<S: Scalar> Add for Vector3<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl<S: Scalar> Sub for Vector3<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl<S: Scalar> AddAssign for Vector3<S> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<S: Scalar> SubAssign for Vector3<S> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<S: Scalar> Neg for Vector3<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

impl<S: Scalar> Mul<S> for Vector3<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: S) -> Self {
        Self::new(self.x * factor, self.y * factor, self.z * factor)
    }
}
