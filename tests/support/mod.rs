//! Random models with an evaluation of their own, written with nalgebra alone, so that no promise
//! is judged by the code that it is about.
#![allow(
    dead_code,
    unreachable_pub,
    reason = "every test file uses another part of this module"
)]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

pub mod bones;
pub mod maps;
pub mod random;
pub mod tasks;
pub mod trees;

use kinopt::spatial::{Placement, Vector3};
use nalgebra as na;

/// A rigid motion of the independent evaluation.
pub type Rigid = na::IsometryMatrix3<f64>;

/// The same rigid motion as the library takes it, bit for bit.
pub fn placement(rigid: &Rigid) -> Placement<f64> {
    Placement::new(
        rigid.rotation.into_inner().into(),
        rigid.translation.vector.into(),
    )
}

pub fn rigid(rotation: na::Rotation3<f64>, translation: na::Vector3<f64>) -> Rigid {
    Rigid::from_parts(na::Translation3::from(translation), rotation)
}

/// The largest difference between two placements, entry by entry.
pub fn apart(ours: &Placement<f64>, theirs: &Rigid) -> f64 {
    let rotation: na::Matrix3<f64> = ours.rotation.into();
    let translation: na::Vector3<f64> = ours.translation.into();
    let turned = (rotation - theirs.rotation.matrix()).amax();
    turned.max((translation - theirs.translation.vector).amax())
}

pub fn vector(v: na::Vector3<f64>) -> Vector3<f64> {
    v.into()
}
