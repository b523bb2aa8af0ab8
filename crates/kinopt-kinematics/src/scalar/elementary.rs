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

/// Single precision, angles in radians.
#[doc(hidden)]
pub mod single {
    #[doc(hidden)]
    pub use libm::{atan2f as atan2, expf as exp, powf as pow, sincosf as sin_cos, sinf as sin};
}
