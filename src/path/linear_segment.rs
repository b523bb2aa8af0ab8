//! Linear segment between two points of a path.

use crate::spatial::Placement;

/// Returns the pose at a fraction of the segment, with linear translation and constant rotation rate.
pub(super) fn interpolate(
    from: &Placement<f64>,
    to: &Placement<f64>,
    fraction: f64,
) -> Placement<f64> {
    from.interpolated(to, fraction).made_rigid()
}
