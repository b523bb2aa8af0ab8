//! Markers of C3D files, the format of optical motion capture systems.
//!
//! The crate c3dio reads the files. Markers that were not seen are gaps: C3D marks them by a negative residual. Positions
//! are converted to metres by the unit of the file.

mod markers;
#[cfg(feature = "c3d")]
mod read;

pub use markers::{MarkerCapture, MarkerError};
#[cfg(feature = "c3d")]
pub use read::{from_bytes, read};
