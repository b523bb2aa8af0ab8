//! Sine and cosine over lanes, by argument reduction and the polynomials of fdlibm.
//!
//! The argument is reduced by the nearest multiple of π/2, held in three parts of 33 bits
//! (Cody and Waite 1980), which is exact for |x| up to [`MAX_ANGLE`]; then sin and cos on
//! [−π/4, π/4] are the minimax polynomials of fdlibm's `k_sin.c` and `k_cos.c` (Sun Microsystems
//! 1993). The error is below 1e-15 for every |x| ≤ [`MAX_ANGLE`].

use super::lane::Lanes;
use crate::scalar::Scalar;

/// The largest |angle| in radians for which [`sin_cos`] keeps its accuracy.
pub const MAX_ANGLE: f64 = 1.0e6;

const TWO_OVER_PI: f64 = std::f64::consts::FRAC_2_PI;
/// The first 33 bits of π/2, the next 33, and the rest: a multiple by k < 2²⁰ is exact.
const HALF_PI: [f64; 3] = [
    f64::from_bits(0x3FF9_21FB_5440_0000),
    f64::from_bits(0x3DD0_B461_1A60_0000),
    f64::from_bits(0x3BA3_198A_2E03_7073),
];
/// 1.5 · 2⁵²: added to a small number it leaves the nearest integer in the low bits.
pub(crate) const ROUNDER: f64 = 6_755_399_441_055_744.0;

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

/// Sine and cosine of angles in radians, |x| ≤ [`MAX_ANGLE`].
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn sin_cos<const L: usize, const FMA: bool>(
    x: Lanes<L, FMA>,
) -> (Lanes<L, FMA>, Lanes<L, FMA>) {
    type C<const L: usize, const FMA: bool> = Lanes<L, FMA>;
    let rounded = x.mul_add(C::constant(TWO_OVER_PI), C::constant(ROUNDER));
    let k = rounded - C::constant(ROUNDER);
    let r = k.mul_add(C::constant(-HALF_PI[0]), x);
    let r = k.mul_add(C::constant(-HALF_PI[1]), r);
    let r = k.mul_add(C::constant(-HALF_PI[2]), r);

    let z = r * r;
    let sin = horner(z, &SIN);
    let sin = (z * r).mul_add(sin, r);
    let cos = horner(z, &COS);
    let cos = (z * z).mul_add(cos, z.mul_add(C::constant(-0.5), C::one()));

    // Quarter turns: odd ones swap sine and cosine; bit 1 of k, and of k + 1, gives the signs.
    let (mut s, mut c) = ([0.0; L], [0.0; L]);
    for i in 0..L {
        let quarter = rounded.0[i].to_bits();
        let swap = 0u64.wrapping_sub(quarter & 1);
        let (sin, cos) = (sin.0[i].to_bits(), cos.0[i].to_bits());
        let s_bits = (sin & !swap) | (cos & swap);
        let c_bits = (cos & !swap) | (sin & swap);
        s[i] = f64::from_bits(s_bits ^ ((quarter & 2) << 62));
        c[i] = f64::from_bits(c_bits ^ ((quarter.wrapping_add(1) & 2) << 62));
    }
    (Lanes(s), Lanes(c))
}

/// Σ cₖ zᵏ by Horner's rule.
#[cfg_attr(not(debug_assertions), inline(always))]
fn horner<S: Scalar>(z: S, coefficients: &[f64; 6]) -> S {
    let mut sum = S::constant(coefficients[5]);
    for k in (0..5).rev() {
        sum = sum.mul_add(z, S::constant(coefficients[k]));
    }
    sum
}

/// Angle of the point (x, y) in radians, to 1e-7: for seeds, not for results.
///
/// The polynomial is Abramowitz and Stegun 4.4.49.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn rough_atan2<S: Scalar>(y: S, x: S) -> S {
    const ATAN: [f64; 9] = [
        1.0,
        -0.333_331_452_8,
        0.199_935_508_5,
        -0.142_088_994_4,
        0.106_562_639_3,
        -0.075_289_640_0,
        0.042_909_613_8,
        -0.016_165_736_7,
        0.002_866_225_7,
    ];
    let c = S::constant;
    let (ax, ay) = (x.abs(), y.abs());
    let t = ax.min(ay) / ax.max(ay).max(c(1e-300));
    let z = t * t;
    let mut sum = c(ATAN[8]);
    for k in (0..8).rev() {
        sum = sum.mul_add(z, c(ATAN[k]));
    }
    let octant = sum * t;
    let quadrant = S::select(
        ax.less_than(ay),
        c(std::f64::consts::FRAC_PI_2) - octant,
        octant,
    );
    let half = S::select(
        x.less_than(S::zero()),
        c(std::f64::consts::PI) - quadrant,
        quadrant,
    );
    S::select(y.less_than(S::zero()), -half, half)
}
