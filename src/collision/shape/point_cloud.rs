//! Point clouds.

use super::ShapeError;
use super::error::{check_points, size};
use crate::collision::aabb_tree::AabbTree;
use crate::collision::bounding_box::BoundingBox;
use crate::spatial::Vector3;

/// Spheres of one radius about a set of points.
#[derive(Clone, Debug)]
pub struct PointCloud {
    positions: Vec<Vector3<f64>>,
    radius: f64,
    tree: AabbTree,
}

impl PointCloud {
    pub(super) fn new(positions: Vec<Vector3<f64>>, radius: f64) -> Result<Self, ShapeError> {
        let radius = size("radius of the points", radius)?;
        if positions.is_empty() {
            return Err(ShapeError::TooFew {
                shape: "cloud",
                what: "point",
                needed: 1,
                given: 0,
            });
        }
        check_points("point", "points", &positions)?;
        Ok(Self {
            tree: AabbTree::of_points(&positions),
            positions,
            radius,
        })
    }

    /// Positions of the points, metres.
    #[must_use]
    pub fn positions(&self) -> &[Vector3<f64>] {
        &self.positions
    }

    /// Radius of the sphere about each point, metres.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    #[must_use]
    pub(crate) fn tree(&self) -> &AabbTree {
        &self.tree
    }

    #[must_use]
    pub(super) fn bounding_box(&self) -> BoundingBox {
        self.tree.bounds().grown(self.radius)
    }
}
