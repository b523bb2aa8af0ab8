//! Number types for kinematics and residuals.
//!
//! The same code runs on `f64` to solve, on [`Dual`] numbers to differentiate, and on SIMD lanes for speed. Code over
//! [`Scalar`] must not branch on values, because lanes would branch differently. It compares into a [`Scalar::Mask`]
//! and picks with [`Scalar::select`].
//!
//! With the feature `num-dual`, `DualSVec64` of the crate num-dual is a [`Scalar`] too.

mod dual;
#[doc(hidden)]
pub mod elementary;
#[cfg(feature = "num-dual")]
mod num_dual;
#[doc(hidden)]
pub mod trigonometry;

/// An array of length `$n` with `$value` at index `$i`, like `std::array::from_fn`.
///
/// A loop without a closure: in debug builds the calls to a closure dominate the time of such small arrays.
#[doc(hidden)] // For the SIMD lanes of kinopt-arm.
#[macro_export]
macro_rules! each {
    ($n:ident, $i:ident, $zero:expr, $value:expr) => {{
        let mut out = [$zero; $n];
        let mut $i = 0;
        while $i < $n {
            out[$i] = $value;
            $i += 1;
        }
        out
    }};
}

use std::fmt::Debug;
use std::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, MulAssign, Neg, Not, Sub, SubAssign};

pub use dual::Dual;

/// The result of comparing two scalars: one truth value per lane.
pub trait Mask:
    Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self>
{
}

impl Mask for bool {}

/// A real number, several real numbers in SIMD lanes, or a number with its derivatives.
///
/// Comparisons of dual numbers look at the value only. [`select`](Scalar::select) keeps the derivatives of the side it
/// picks. It computes the derivatives of both sides. If one side would divide by zero or take the root of zero, replace
/// that side's argument by a harmless one first, with another `select`.
pub trait Scalar:
    Copy
    + Debug
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
{
    /// The result type of a comparison.
    type Mask: Mask;

    /// A constant: every lane holds `value`, every derivative is zero.
    fn constant(value: f64) -> Self;

    /// `self * factor + addend`, fused where the type can do so cheaply.
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }

    /// Square root. The derivative at zero is infinite: guard the argument.
    fn sqrt(self) -> Self;

    /// Sine and cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);

    /// Sines and cosines of many angles in radians. The shortest slice sets the count.
    #[inline]
    fn sin_cos_all(angles: &[Self], sines: &mut [Self], cosines: &mut [Self]) {
        for ((angle, sin), cos) in angles.iter().zip(sines).zip(cosines) {
            (*sin, *cos) = angle.sin_cos();
        }
    }

    /// Angle of the point (`x`, `self`) in radians, within [−π, π].
    fn atan2(self, x: Self) -> Self;

    /// Natural exponential.
    fn exp(self) -> Self;

    /// Natural logarithm.
    fn ln(self) -> Self;

    /// True if `self < other`, lane by lane, by value.
    fn less_than(self, other: Self) -> Self::Mask;

    /// `yes` in lanes whose mask is set, `no` in all other lanes.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// True if the value is neither NaN nor infinite, in every lane.
    fn is_finite(self) -> bool;

    /// The value without derivatives; `None` for SIMD lanes.
    #[inline(always)]
    fn as_f64(self) -> Option<f64> {
        None
    }

    /// The constant 0.
    #[inline(always)]
    fn zero() -> Self {
        Self::constant(0.0)
    }

    /// The constant 1.
    #[inline(always)]
    fn one() -> Self {
        Self::constant(1.0)
    }

    /// The absolute value.
    #[inline(always)]
    fn abs(self) -> Self {
        Self::select(self.less_than(Self::zero()), -self, self)
    }

    /// The smaller of two numbers.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(other.less_than(self), other, self)
    }

    /// The larger of two numbers.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(self.less_than(other), other, self)
    }
}

impl Scalar for f64 {
    type Mask = bool;

    #[inline(always)]
    fn constant(value: f64) -> Self {
        value
    }

    // Repeats the trait's default without its operator calls, which cost time in debug builds.
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        elementary::sin_cos(self)
    }

    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        elementary::atan2(self, x)
    }

    #[inline(always)]
    fn exp(self) -> Self {
        elementary::exp(self)
    }

    #[inline(always)]
    fn ln(self) -> Self {
        elementary::ln(self)
    }

    #[inline(always)]
    fn less_than(self, other: Self) -> bool {
        self < other
    }

    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }

    #[inline(always)]
    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }

    #[inline(always)]
    fn as_f64(self) -> Option<f64> {
        Some(self)
    }

    fn sin_cos_all(angles: &[Self], sines: &mut [Self], cosines: &mut [Self]) {
        trigonometry::sin_cos_all(angles, sines, cosines);
    }
}
