//! Extent of a shape along a direction.

use super::core_and_radius::Core;
use crate::collision::{Shape, ShapeKind};
use kinopt_kinematics::spatial::{Placement, Vector3};

impl Shape {
    #[doc(hidden)]
    pub fn is_half_space(&self) -> bool {
        matches!(self.kind(), ShapeKind::HalfSpace)
    }

    /// The largest coordinate along a unit world direction of the shape at a placement, metres.
    ///
    /// For a half-space, `along` must be its normal. `None` for shapes that are not convex.
    pub(crate) fn reach_along(&self, at: &Placement<f64>, along: Vector3<f64>) -> Option<f64> {
        if self.is_half_space() {
            return Some(at.translation.dot(along));
        }
        let (core, radius) = Core::of(self.kind())?;
        let farthest = core.approximate_support(at.rotation.transpose_mul(along));
        Some(at.apply(farthest).dot(along) + radius)
    }
}
