//! Uniform scaling of shapes.

use super::{Shape, ShapeError, ShapeKind};
use crate::spatial::Vector3;

impl Shape {
    /// The shape scaled by the factor `times` about its origin. A half-space does not change.
    ///
    /// # Errors
    /// Returns an error if a scaled length or coordinate is out of range.
    pub fn scaled(&self, times: f64) -> Result<Self, ShapeError> {
        let all =
            |points: &[Vector3<f64>]| -> Vec<_> { points.iter().map(|p| *p * times).collect() };
        match &self.kind {
            ShapeKind::Sphere { radius } => Self::sphere(radius * times),
            ShapeKind::Capsule { radius, length } => Self::capsule(radius * times, length * times),
            ShapeKind::Cylinder { radius, length } => {
                Self::cylinder(radius * times, length * times)
            }
            ShapeKind::Cuboid { size } => Self::cuboid(size.map(|length| length * times)),
            ShapeKind::HalfSpace => Ok(self.clone()),
            ShapeKind::Convex(hull) => Self::convex(&all(hull.vertices())),
            ShapeKind::Mesh(mesh) => Self::mesh(all(mesh.vertices()), mesh.triangles().to_vec()),
            ShapeKind::HeightField(field) => {
                let heights = field.heights().iter().map(|height| height * times);
                let spacing = field.spacing().map(|length| length * times);
                Self::height_field(heights.collect(), field.columns(), spacing)
            }
            ShapeKind::Points(cloud) => {
                Self::points(all(cloud.positions()), cloud.radius() * times)
            }
        }
    }
}
