//! Sine and cosine without branches, by argument reduction and the polynomials of fdlibm.
//!
//! The reduction subtracts the nearest multiple of π/2, stored in three parts of 33 bits (Cody and Waite 1980). It is
//! exact for |x| up to [`MAX_ANGLE`]. On [−π/4, π/4], sin and cos are the minimax polynomials of fdlibm's `k_sin.c` and
//! `k_cos.c` (Sun Microsystems 1993). The error is below 1e-15 for every |x| ≤ [`MAX_ANGLE`].

use super::{Scalar, elementary};

/// The largest |angle| for which the polynomials keep their accuracy, radians.
#[doc(hidden)]
pub const MAX_ANGLE: f64 = 1.0e6;

const TWO_OVER_PI: f64 = std::f64::consts::FRAC_2_PI;
/// The first 33 bits of π/2, the next 33, and the rest: a multiple by k < 2²⁰ is exact.
const HALF_PI: [f64; 3] = [
    f64::from_bits(0x3FF9_21FB_5440_0000),
    f64::from_bits(0x3DD0_B461_1A60_0000),
    f64::from_bits(0x3BA3_198A_2E03_7073),
];
/// 1.5 · 2⁵²: added to a small number, it leaves the nearest integer in the low bits.
#[doc(hidden)]
pub const ROUNDER: f64 = 6_755_399_441_055_744.0;

// The digits as published.
#[allow(clippy::excessive_precision)]
const SIN: [f64; 6] = [
    -1.666_666_666_666_663_243_48e-1,
    8.333_333_333_322_489_461_24e-3,
    -1.984_126_982_985_794_931_34e-4,
    2.755_731_370_707_006_767_89e-6,
    -2.505_076_025_340_686_341_95e-8,
    1.589_690_995_211_550_102_21e-10,
];
#[allow(clippy::excessive_precision)]
const COS: [f64; 6] = [
    4.166_666_666_666_660_190_37e-2,
    -1.388_888_888_887_410_957_49e-3,
    2.480_158_728_947_672_941_78e-5,
    -2.755_731_435_139_066_330_35e-7,
    2.087_572_321_298_174_827_90e-9,
    -1.135_964_755_778_819_482_65e-11,
];

/// Sine and cosine of x reduced by multiples of π/2, and the number with that multiple in its low bits.
///
/// Returns (multiple, sine, cosine), the arguments of [`turned`].
#[cfg_attr(not(debug_assertions), inline(always))]
#[doc(hidden)]
pub fn reduced_sin_cos<S: Scalar>(x: S) -> (S, S, S) {
    let c = S::constant;
    let rounded = x.mul_add(c(TWO_OVER_PI), c(ROUNDER));
    let k = rounded - c(ROUNDER);
    let r = k.mul_add(c(-HALF_PI[0]), x);
    let r = k.mul_add(c(-HALF_PI[1]), r);
    let r = k.mul_add(c(-HALF_PI[2]), r);

    let z = r * r;
    let sin = (z * r).mul_add(horner(z, &SIN), r);
    let cos = (z * z).mul_add(horner(z, &COS), z.mul_add(c(-0.5), S::one()));
    (rounded, sin, cos)
}

/// Sine and cosine of the full angle from those of the reduced angle.
///
/// The low bits of `rounded` count quarter rotations. Odd counts swap sine and cosine. Bit 1 of the count is the sign
/// of the sine; bit 1 of the next count is the sign of the cosine.
#[cfg_attr(not(debug_assertions), inline(always))]
#[doc(hidden)]
pub fn turned(rounded: f64, sin: f64, cos: f64) -> (f64, f64) {
    let quarter = rounded.to_bits();
    let swap = 0u64.wrapping_sub(quarter & 1);
    let (sin, cos) = (sin.to_bits(), cos.to_bits());
    let s = (sin & !swap) | (cos & swap);
    let c = (cos & !swap) | (sin & swap);
    (
        f64::from_bits(s ^ ((quarter & 2) << 62)),
        f64::from_bits(c ^ ((quarter.wrapping_add(1) & 2) << 62)),
    )
}

/// Sines and cosines of many angles, in one loop that vectorises.
///
/// Angles above [`MAX_ANGLE`] go through [`elementary::sin_cos`].
pub(super) fn sin_cos_all(angles: &[f64], sines: &mut [f64], cosines: &mut [f64]) {
    for ((&angle, sin), cos) in angles.iter().zip(&mut *sines).zip(&mut *cosines) {
        let (rounded, s, c) = reduced_sin_cos(angle);
        (*sin, *cos) = turned(rounded, s, c);
    }
    let largest = angles
        .iter()
        .fold(0.0, |max, a| if a.abs() > max { a.abs() } else { max });
    if largest > MAX_ANGLE {
        for ((&angle, sin), cos) in angles.iter().zip(sines).zip(cosines) {
            if angle.abs() > MAX_ANGLE {
                (*sin, *cos) = elementary::sin_cos(angle);
            }
        }
    }
}

/// Σ cₖ zᵏ by Horner's rule.
#[cfg_attr(not(debug_assertions), inline(always))]
fn horner<S: Scalar>(z: S, coefficients: &[f64; 6]) -> S {
    let c = |k: usize| S::constant(coefficients[k]);
    c(5).mul_add(z, c(4))
        .mul_add(z, c(3))
        .mul_add(z, c(2))
        .mul_add(z, c(1))
        .mul_add(z, c(0))
}
