//! Sines, arc tangents and their like with the same bits on every machine.
//!
//! The standard library asks the operating system for these, whose answers differ in the last place
//! from system to system, and with glibc even from processor to processor. The `libm` crate is
//! musl's in Rust: additions, multiplications, divisions and roots only, which IEEE 754 fixes to
//! the bit. Clippy refuses the standard library's (and glam's, which call them) in this crate; see
//! `clippy.toml`.

/// In double precision, angles in radians.
pub(crate) use libm::{
    acos, asin, atan2, cbrt, cos, cosh, exp, hypot, log as ln, log1p as ln_1p, log10, pow, sin,
    sincos as sin_cos, sinh,
};

/// In single precision, angles in radians.
pub(crate) mod single {
    pub(crate) use libm::{
        atan2f as atan2, expf as exp, powf as pow, sincosf as sin_cos, sinf as sin,
    };
}
