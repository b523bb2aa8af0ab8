//! Bounding spheres and axis-aligned bounding boxes of shapes.

use super::{Shape, ShapeKind};
use crate::collision::bounding_box::BoundingBox;
use kinopt_kinematics::scalar::elementary::hypot;
use kinopt_kinematics::spatial::Vector3;

/// A ball, for instance the bounding sphere of a shape. Lengths are in metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ball {
    /// Centre.
    pub centre: Vector3<f64>,
    /// Radius; infinite for a half-space.
    pub radius: f64,
}

impl Shape {
    /// The axis-aligned bounding box in the shape's frame. For a half-space it is infinite in all directions but +z.
    #[must_use]
    pub fn bounding_box(&self) -> BoundingBox {
        let symmetric = |x: f64, y: f64, z: f64| BoundingBox {
            min: Vector3::new(-x, -y, -z),
            max: Vector3::new(x, y, z),
        };
        match self.kind() {
            ShapeKind::Sphere { radius } => symmetric(*radius, *radius, *radius),
            ShapeKind::Capsule { radius, length } => {
                symmetric(*radius, *radius, 0.5 * length + radius)
            }
            ShapeKind::Cylinder { radius, length } => symmetric(*radius, *radius, 0.5 * length),
            ShapeKind::Cuboid { size: [x, y, z] } => symmetric(0.5 * x, 0.5 * y, 0.5 * z),
            ShapeKind::HalfSpace => BoundingBox {
                max: Vector3::new(f64::INFINITY, f64::INFINITY, 0.0),
                ..BoundingBox::UNBOUNDED
            },
            ShapeKind::Convex(hull) => BoundingBox::around(hull.vertices().iter().copied()),
            ShapeKind::Mesh(mesh) => mesh.bounding_box(),
            ShapeKind::HeightField(field) => field.bounding_box(),
            ShapeKind::Points(cloud) => cloud.bounding_box(),
        }
    }

    /// A bounding sphere in the shape's frame.
    ///
    /// The sphere is the smallest about the centre of the bounding box, or about the origin.
    #[must_use]
    pub fn bounding_sphere(&self) -> Ball {
        let about_origin = |radius| Ball {
            centre: Vector3::zero(),
            radius,
        };
        let around = |points: &[Vector3<f64>], grown: f64| {
            let centre = BoundingBox::around(points.iter().copied()).centre();
            let squared_distance = |p: &Vector3<f64>| (*p - centre).norm_squared();
            let radius = points
                .iter()
                .map(squared_distance)
                .fold(0.0, f64::max)
                .sqrt()
                + grown;
            Ball { centre, radius }
        };
        match self.kind() {
            ShapeKind::Sphere { radius } => about_origin(*radius),
            ShapeKind::Capsule { radius, length } => about_origin(0.5 * length + radius),
            ShapeKind::Cylinder { radius, length } => about_origin(hypot(*radius, 0.5 * length)),
            ShapeKind::Cuboid { size } => about_origin(0.5 * Vector3::from(*size).norm()),
            ShapeKind::HalfSpace => about_origin(f64::INFINITY),
            ShapeKind::HeightField(field) => {
                let bounds = field.bounding_box();
                let (centre, radius) = (bounds.centre(), bounds.half_diagonal());
                Ball { centre, radius }
            }
            ShapeKind::Convex(hull) => around(hull.vertices(), 0.0),
            ShapeKind::Mesh(mesh) => around(mesh.vertices(), 0.0),
            ShapeKind::Points(cloud) => around(cloud.positions(), cloud.radius()),
        }
    }
}
