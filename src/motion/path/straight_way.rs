//! The tool's way from one point of a path to the next.

use crate::spatial::Placement;

/// A place on the straight way, turned evenly.
pub(super) fn between(from: &Placement<f64>, to: &Placement<f64>, share: f64) -> Placement<f64> {
    from.interpolated(to, share).made_rigid()
}
