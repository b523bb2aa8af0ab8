//! Uniform scaling of shapes.

use super::{Shape, ShapeError, ShapeKind};
use kinopt_kinematics::spatial::Vector3;

impl Shape {
    /// The shape scaled by `factor` about its origin. A half-space does not change.
    ///
    /// # Errors
    /// Returns an error if a scaled length or coordinate is out of range.
    pub fn scaled(&self, factor: f64) -> Result<Self, ShapeError> {
        let scale_all =
            |points: &[Vector3<f64>]| -> Vec<_> { points.iter().map(|p| *p * factor).collect() };
        match &self.kind {
            ShapeKind::Sphere { radius } => Self::sphere(radius * factor),
            ShapeKind::Capsule { radius, length } => {
                Self::capsule(radius * factor, length * factor)
            }
            ShapeKind::Cylinder { radius, length } => {
                Self::cylinder(radius * factor, length * factor)
            }
            ShapeKind::Cuboid { size } => Self::cuboid(size.map(|length| length * factor)),
            ShapeKind::HalfSpace => Ok(self.clone()),
            ShapeKind::Convex(hull) => Self::convex(&scale_all(hull.vertices())),
            ShapeKind::Mesh(mesh) => {
                Self::mesh(scale_all(mesh.vertices()), mesh.triangles().to_vec())
            }
            ShapeKind::HeightField(field) => {
                let heights = field.heights().iter().map(|height| height * factor);
                let spacing = field.spacing().map(|length| length * factor);
                Self::height_field(heights.collect(), field.columns(), spacing)
            }
            ShapeKind::Points(cloud) => {
                Self::points(scale_all(cloud.positions()), cloud.radius() * factor)
            }
        }
    }
}
