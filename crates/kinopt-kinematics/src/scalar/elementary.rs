//! Elementary functions that are bitwise reproducible on every machine.
//!
//! The standard library calls the operating system's functions, whose last bits differ between systems and, with glibc,
//! between processors. The `libm` crate is a Rust port of musl. It uses only additions, multiplications, divisions and
//! roots, whose results IEEE 754 fixes. Clippy rejects the functions of the standard library and of glam in this crate;
//! see `clippy.toml`.

/// Double precision, angles in radians.
#[doc(hidden)]
pub use libm::{
    acos, asin, atan2, cbrt, cos, cosh, exp, hypot, log as ln, log1p as ln_1p, log10, pow, sin,
    sincos as sin_cos, sinh,
};

/// Largest sine or cosine that is rounded to 0. Decimal numbers cannot state multiples of π/2 exactly.
const QUARTER_TURN_TOLERANCE: f64 = 1e-15;

/// Sine and cosine of an angle in radians, with exact zeros at multiples of π/2 so that axes stay aligned along a
/// chain.
#[doc(hidden)]
pub fn clean_sin_cos(angle: f64) -> (f64, f64) {
    let (sin, cos) = sin_cos(angle);
    let clean = |value: f64| match value.abs() < QUARTER_TURN_TOLERANCE {
        true => 0.0,
        false => value,
    };
    (clean(sin), clean(cos))
}

/// Single precision, angles in radians.
#[doc(hidden)]
pub mod single {
    #[doc(hidden)]
    pub use libm::{atan2f as atan2, expf as exp, powf as pow, sincosf as sin_cos, sinf as sin};
}
