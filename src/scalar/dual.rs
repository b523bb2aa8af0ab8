//! Forward-mode differentiation: dual numbers with several infinitesimal parts.
//!
//! Griewank and Walther, *Evaluating Derivatives*, 2nd edition, section 3.2 (vector forward mode).

use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use super::{Scalar, each, elementary};

/// A value and its derivatives along `N` directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const N: usize> {
    value: f64,
    derivatives: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// A variable: derivative 1 along `direction`, 0 along every other direction.
    ///
    /// A `direction` of `N` or more gives a constant.
    #[must_use]
    pub fn variable(value: f64, direction: usize) -> Self {
        let derivatives = each!(N, k, 0.0, f64::from(k == direction));
        Self { value, derivatives }
    }

    /// A number with given derivatives.
    #[must_use]
    pub fn new(value: f64, derivatives: [f64; N]) -> Self {
        Self { value, derivatives }
    }

    /// The value.
    #[must_use]
    pub fn value(&self) -> f64 {
        self.value
    }

    /// The derivatives along the `N` directions.
    #[must_use]
    pub fn derivatives(&self) -> [f64; N] {
        self.derivatives
    }

    /// A function of this number, from the function's value and derivative (chain rule).
    #[inline(always)]
    fn chain(self, value: f64, slope: f64) -> Self {
        Self {
            value,
            derivatives: each!(N, k, 0.0, self.derivatives[k] * slope),
        }
    }

    /// A function of two numbers, from its value and its two partial derivatives (chain rule).
    #[inline(always)]
    fn chain2(self, other: Self, value: f64, slopes: [f64; 2]) -> Self {
        Self {
            value,
            derivatives: each!(N, k, 0.0, {
                self.derivatives[k] * slopes[0] + other.derivatives[k] * slopes[1]
            }),
        }
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            derivatives: each!(N, k, 0.0, self.derivatives[k] + other.derivatives[k]),
        }
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            derivatives: each!(N, k, 0.0, self.derivatives[k] - other.derivatives[k]),
        }
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.chain2(other, self.value * other.value, [other.value, self.value])
    }
}

impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        let slope = 1.0 / other.value;
        self.chain2(other, quotient, [slope, -quotient * slope])
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}

impl<const N: usize> AddAssign for Dual<N> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const N: usize> SubAssign for Dual<N> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<const N: usize> MulAssign for Dual<N> {
    #[inline(always)]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl<const N: usize> Scalar for Dual<N> {
    type Mask = bool;

    #[inline(always)]
    fn is_finite(self) -> bool {
        self.value.is_finite()
    }

    #[inline(always)]
    fn as_f64(self) -> Option<f64> {
        Some(self.value)
    }

    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self {
            value,
            derivatives: [0.0; N],
        }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, 0.5 / root)
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = elementary::sin_cos(self.value);
        (self.chain(sin, cos), self.chain(cos, -sin))
    }

    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        // d atan2(y, x) = (x dy − y dx) / (x² + y²), also at x = 0.
        let (y, squared) = (self.value, self.value * self.value + x.value * x.value);
        let angle = elementary::atan2(y, x.value);
        self.chain2(x, angle, [x.value / squared, -(y / squared)])
    }

    #[inline(always)]
    fn exp(self) -> Self {
        let exp = elementary::exp(self.value);
        self.chain(exp, exp)
    }

    #[inline(always)]
    fn ln(self) -> Self {
        self.chain(elementary::ln(self.value), 1.0 / self.value)
    }

    #[inline(always)]
    fn less_than(self, other: Self) -> bool {
        self.value < other.value
    }

    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
}
