//! The number type over which kinematics and residuals are written once.
//!
//! The same code runs on `f64` to solve, on [`Dual`] numbers to differentiate, and on SIMD lanes to
//! go fast. Code over [`Scalar`] must not branch on values, because lanes would branch differently:
//! it compares into a [`Scalar::Mask`] and picks with [`Scalar::select`].

mod dual;
pub(crate) mod elementary;
pub(crate) mod trigonometry;

/// An array of length `$n` with `$value` at `$i`, like `std::array::from_fn`. Counted by hand and without
/// a closure: those are calls in a debug build, of which such small arrays would be the most part.
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
pub(crate) use each;

use std::fmt::Debug;
use std::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, MulAssign, Neg, Not, Sub, SubAssign};

pub use dual::Dual;

/// The result of comparing two scalars: one truth value per lane.
pub trait Mask:
    Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self>
{
}

impl Mask for bool {}

/// A real number, or several side by side, or one with its derivatives.
///
/// Comparisons of dual numbers look at the value only; [`select`](Scalar::select) keeps the
/// derivatives of the side it picks. When one side would divide by zero or take the root of zero,
/// make that side's argument harmless with a `select` first: the derivative of an unpicked branch
/// is computed all the same.
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
    /// What a comparison returns.
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

    /// Sines and cosines of many angles in radians, over the shortest of the slices.
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

    /// Whether `self < other`, lane by lane, by value.
    fn less_than(self, other: Self) -> Self::Mask;

    /// `yes` where the mask is set, `no` elsewhere.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// Whether its value is neither NaN nor infinite, in every lane.
    fn is_finite(self) -> bool;

    /// Its value, without derivatives; `None` where several stand side by side.
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

    answers! {
        #[inline(always)]
        fn constant(value: f64) -> Self = value;
        // As the trait has it, but without the calls that generic operators are in a debug build.
        #[inline(always)]
        fn mul_add(self, factor: Self, addend: Self) -> Self = self * factor + addend;
        #[inline(always)]
        fn sqrt(self) -> Self = f64::sqrt(self);
        #[inline(always)]
        fn sin_cos(self) -> (Self, Self) = elementary::sin_cos(self);
        #[inline(always)]
        fn atan2(self, x: Self) -> Self = elementary::atan2(self, x);
        #[inline(always)]
        fn exp(self) -> Self = elementary::exp(self);
        #[inline(always)]
        fn ln(self) -> Self = elementary::ln(self);
        #[inline(always)]
        fn less_than(self, other: Self) -> bool = self < other;
        #[inline(always)]
        fn select(mask: bool, yes: Self, no: Self) -> Self = if mask { yes } else { no };
        #[inline(always)]
        fn is_finite(self) -> bool = f64::is_finite(self);
        #[inline(always)]
        fn as_f64(self) -> Option<f64> = Some(self);
    }

    fn sin_cos_all(angles: &[Self], sines: &mut [Self], cosines: &mut [Self]) {
        trigonometry::sin_cos_all(angles, sines, cosines);
    }
}
