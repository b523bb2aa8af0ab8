//! Decomposition and interpolation of affine maps.
//!
//! The rotation of the result is interpolated as a rotation, so a map halfway between two rotations is a rotation.
//!
//! Shoemake & Duff 1992, "Matrix animation and polar decomposition".

mod plane;
mod space;

pub use plane::{PlaneDecomposition, interpolate_plane_affine};
pub use space::{Decomposition, NotFinite, interpolate_affine};
