//! The tool's way from one point of a path to the next.

use crate::spatial::{Placement, Quaternion, rotation_exp};

/// A place on the straight way, turned evenly.
pub(super) fn between(from: &Placement<f64>, to: &Placement<f64>, share: f64) -> Placement<f64> {
    let turn = Quaternion::from_matrix(&(from.rotation.transpose() * to.rotation)).log();
    let way = to.translation - from.translation;
    let rotation = from.rotation * rotation_exp(turn * share);
    Placement::new(rotation, from.translation + way * share).made_rigid()
}
