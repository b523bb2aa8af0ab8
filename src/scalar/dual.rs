//! Forward-mode differentiation: num-dual's dual vectors behind a type of our own, so that a new
//! version of num-dual changes nothing for our users.

use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use nalgebra::{Const, SVector};
use num_dual::{Derivative, DualNum, DualSVec64};

use super::{Scalar, elementary};

/// A value and its derivatives along `N` directions at once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const N: usize>(DualSVec64<N>);

impl<const N: usize> Dual<N> {
    /// A variable: its own derivative is 1 along `direction`, 0 along the others. A `direction`
    /// of `N` or more gives a constant.
    #[must_use]
    pub fn variable(value: f64, direction: usize) -> Self {
        let mut derivatives = [0.0; N];
        if let Some(own) = derivatives.get_mut(direction) {
            *own = 1.0;
        }
        Self::new(value, derivatives)
    }

    /// A number with given derivatives.
    #[must_use]
    pub fn new(value: f64, derivatives: [f64; N]) -> Self {
        Self(DualSVec64::new(
            value,
            Derivative::some(SVector::from(derivatives)),
        ))
    }

    /// The value.
    #[must_use]
    pub fn value(&self) -> f64 {
        self.0.re
    }

    /// The derivatives along the `N` directions.
    #[must_use]
    pub fn derivatives(&self) -> [f64; N] {
        self.0.eps.unwrap_generic(Const::<N>, Const::<1>).into()
    }

    /// A function of this number, from its value and its derivative there.
    #[inline(always)]
    fn chain(self, value: f64, slope: f64) -> Self {
        Self(DualSVec64::new(value, self.0.eps * slope))
    }
}

macro_rules! forward_binary {
    ($($trait:ident :: $method:ident),*) => {$(
        impl<const N: usize> $trait for Dual<N> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0))
            }
        }
    )*};
}

macro_rules! forward_assign {
    ($($trait:ident :: $method:ident),*) => {$(
        impl<const N: usize> $trait for Dual<N> {
            #[inline(always)]
            fn $method(&mut self, other: Self) {
                self.0.$method(other.0);
            }
        }
    )*};
}

forward_binary!(Add::add, Sub::sub, Mul::mul, Div::div);
forward_assign!(
    AddAssign::add_assign,
    SubAssign::sub_assign,
    MulAssign::mul_assign
);

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl<const N: usize> Scalar for Dual<N> {
    type Mask = bool;

    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self(DualSVec64::from_re(value))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(DualNum::sqrt(&self.0))
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = elementary::sin_cos(self.0.re);
        (self.chain(sin, cos), self.chain(cos, -sin))
    }

    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        // num-dual divides by x on the way; d atan2(y, x) = (x dy − y dx) / (x² + y²) holds at x = 0 too.
        let (y, x) = (self.0, x.0);
        let squared = x.re * x.re + y.re * y.re;
        let eps = y.eps * (x.re / squared) - x.eps * (y.re / squared);
        Self(DualSVec64::new(elementary::atan2(y.re, x.re), eps))
    }

    #[inline(always)]
    fn exp(self) -> Self {
        let exp = elementary::exp(self.0.re);
        self.chain(exp, exp)
    }

    #[inline(always)]
    fn ln(self) -> Self {
        self.chain(elementary::ln(self.0.re), 1.0 / self.0.re)
    }

    #[inline(always)]
    fn less_than(self, other: Self) -> bool {
        self.0.re < other.0.re
    }

    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
}
