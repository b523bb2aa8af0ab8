//! Several `f64` in SIMD lanes, as one [`Scalar`].
//!
//! Each operation is a loop over an array, which the compiler vectorises for the target of the surrounding function.
//! There are no intrinsics. `FMA` selects `mul_add` as one instruction. Without that instruction it would be a slow
//! library call, so portable lanes multiply and add.

use std::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, MulAssign, Neg, Not, Sub, SubAssign};

use kinopt_kinematics::each;
use kinopt_kinematics::scalar::trigonometry::{reduced_sin_cos, turned};
use kinopt_kinematics::scalar::{Mask, Scalar, elementary};

/// `L` numbers in SIMD lanes; `FMA` selects fused multiply-add.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub struct Lanes<const L: usize, const FMA: bool>(pub [f64; L]);

/// One truth value per lane: all bits set or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C, align(32))]
pub struct LaneMask<const L: usize>(pub [u64; L]);

/// A scalar whose lanes can be read and written one by one.
pub trait LaneScalar: Scalar {
    /// Number of lanes.
    const WIDTH: usize;
    /// A single number in the same arithmetic.
    type One: LaneScalar;
    /// Four numbers in the same arithmetic.
    type Four: LaneScalar;

    /// Fills up to four lanes from single-precision numbers; further lanes are zero.
    fn from_singles(values: &[f32; 4]) -> Self;

    /// Returns the value in `lane`, which must be below [`WIDTH`](Self::WIDTH).
    fn lane(&self, lane: usize) -> f64;

    /// Replaces the value in `lane`.
    fn set_lane(&mut self, lane: usize, value: f64);

    /// Returns a bit mask: bit `i` is set if lane `i` is true.
    fn mask_bits(mask: Self::Mask) -> u32;

    /// Returns true if any lane is true; faster than [`mask_bits`](Self::mask_bits).
    fn any(mask: Self::Mask) -> bool;
}

impl<const L: usize, const FMA: bool> LaneScalar for Lanes<L, FMA> {
    const WIDTH: usize = L;
    type One = Lanes<1, FMA>;
    type Four = Lanes<4, FMA>;

    #[inline(always)]
    fn from_singles(values: &[f32; 4]) -> Self {
        let mut out = [0.0; L];
        for i in 0..L.min(4) {
            out[i] = f64::from(values[i]);
        }
        Self(out)
    }

    #[inline(always)]
    fn lane(&self, lane: usize) -> f64 {
        self.0[lane]
    }

    #[inline(always)]
    fn set_lane(&mut self, lane: usize, value: f64) {
        self.0[lane] = value;
    }

    #[inline(always)]
    fn mask_bits(mask: LaneMask<L>) -> u32 {
        let (mut bits, mut i) = (0, 0);
        while i < L {
            bits |= ((mask.0[i] >> 63) as u32) << i;
            i += 1;
        }
        bits
    }

    #[inline(always)]
    fn any(mask: LaneMask<L>) -> bool {
        let (mut all, mut i) = (0, 0);
        while i < L {
            all |= mask.0[i];
            i += 1;
        }
        all != 0
    }
}

#[cfg(all(debug_assertions, target_arch = "x86_64"))]
impl<const L: usize, const FMA: bool> Lanes<L, FMA> {
    /// [`mul_add`](Scalar::mul_add) for debug builds.
    ///
    /// They would not inline it into functions that have the instruction, and would call the library for each lane.
    #[target_feature(enable = "avx2,fma")]
    #[allow(clippy::disallowed_methods)] // One instruction here.
    fn fused_mul_add(self, factor: Self, addend: Self) -> Self {
        Self(each!(
            L,
            i,
            0.0,
            self.0[i].mul_add(factor.0[i], addend.0[i])
        ))
    }
}

impl<const L: usize, const FMA: bool> Scalar for Lanes<L, FMA> {
    type Mask = LaneMask<L>;

    #[inline(always)]
    fn is_finite(self) -> bool {
        self.0.iter().all(|value| value.is_finite())
    }

    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self([value; L])
    }

    #[inline(always)]
    #[allow(clippy::disallowed_methods)] // One instruction for lanes with `FMA`.
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        #[cfg(all(debug_assertions, target_arch = "x86_64"))]
        if FMA {
            // SAFETY: the drivers use such lanes only if the processor has the instructions. Faster in debug builds.
            #[allow(unsafe_code)]
            return unsafe { self.fused_mul_add(factor, addend) };
        }
        Self(if FMA {
            each!(L, i, 0.0, self.0[i].mul_add(factor.0[i], addend.0[i]))
        } else {
            each!(L, i, 0.0, self.0[i] * factor.0[i] + addend.0[i])
        })
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(each!(L, i, 0.0, self.0[i].sqrt()))
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (rounded, sin, cos) = reduced_sin_cos(self);
        let (mut s, mut c, mut i) = ([0.0; L], [0.0; L], 0);
        while i < L {
            (s[i], c[i]) = turned(rounded.0[i], sin.0[i], cos.0[i]);
            i += 1;
        }
        (Self(s), Self(c))
    }

    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        Self(each!(L, i, 0.0, elementary::atan2(self.0[i], x.0[i])))
    }

    #[inline(always)]
    fn exp(self) -> Self {
        Self(each!(L, i, 0.0, elementary::exp(self.0[i])))
    }

    #[inline(always)]
    fn ln(self) -> Self {
        Self(each!(L, i, 0.0, elementary::ln(self.0[i])))
    }

    #[inline(always)]
    fn less_than(self, other: Self) -> LaneMask<L> {
        LaneMask(each!(
            L,
            i,
            0,
            if self.0[i] < other.0[i] { u64::MAX } else { 0 }
        ))
    }

    #[inline(always)]
    fn select(mask: LaneMask<L>, yes: Self, no: Self) -> Self {
        Self(each!(L, i, 0.0, {
            let (m, y, n) = (mask.0[i], yes.0[i].to_bits(), no.0[i].to_bits());
            f64::from_bits((m & y) | (!m & n))
        }))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(each!(L, i, 0.0, self.0[i].abs()))
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // This order of the comparison compiles to one instruction (`minpd`). If the left side is NaN, the result is
        // the right.
        Self(each!(L, i, 0.0, {
            let (a, b) = (self.0[i], other.0[i]);
            if a < b { a } else { b }
        }))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(each!(L, i, 0.0, {
            let (a, b) = (self.0[i], other.0[i]);
            if a > b { a } else { b }
        }))
    }
}

macro_rules! lanewise {
    ($($trait:ident $method:ident $assign_trait:ident $assign:ident $op:tt;)*) => {$(
        impl<const L: usize, const FMA: bool> $trait for Lanes<L, FMA> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(each!(L, i, 0.0, self.0[i] $op other.0[i]))
            }
        }
        impl<const L: usize, const FMA: bool> $assign_trait for Lanes<L, FMA> {
            #[inline(always)]
            fn $assign(&mut self, other: Self) {
                *self = *self $op other;
            }
        }
    )*};
}
lanewise! {
    Add add AddAssign add_assign +;
    Sub sub SubAssign sub_assign -;
    Mul mul MulAssign mul_assign *;
}

impl<const L: usize, const FMA: bool> Div for Lanes<L, FMA> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self(each!(L, i, 0.0, self.0[i] / other.0[i]))
    }
}

impl<const L: usize, const FMA: bool> Neg for Lanes<L, FMA> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(each!(L, i, 0.0, -self.0[i]))
    }
}

impl<const L: usize> Mask for LaneMask<L> {}

impl<const L: usize> BitAnd for LaneMask<L> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(each!(L, i, 0, self.0[i] & other.0[i]))
    }
}

impl<const L: usize> BitOr for LaneMask<L> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(each!(L, i, 0, self.0[i] | other.0[i]))
    }
}

impl<const L: usize> Not for LaneMask<L> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(each!(L, i, 0, !self.0[i]))
    }
}
