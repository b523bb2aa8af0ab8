//! Balls and boxes around shapes.

use super::{Shape, ShapeKind};
use crate::scalar::elementary::hypot;
use crate::spatial::{Placement, Vector3};

/// A ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its centre.
    pub centre: Vector3<f64>,
    /// Infinite about a half-space.
    pub radius: f64,
}

/// A box along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundingBox {
    /// The least coordinates; −∞ where there is no bound.
    pub min: Vector3<f64>,
    /// The greatest coordinates; ∞ where there is no bound.
    pub max: Vector3<f64>,
}

impl BoundingBox {
    /// Around nothing.
    pub(crate) const EMPTY: Self = Self {
        min: Vector3 {
            x: f64::INFINITY,
            y: f64::INFINITY,
            z: f64::INFINITY,
        },
        max: Vector3 {
            x: f64::NEG_INFINITY,
            y: f64::NEG_INFINITY,
            z: f64::NEG_INFINITY,
        },
    };

    /// Around points.
    pub(crate) fn around(points: impl IntoIterator<Item = Vector3<f64>>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::with)
    }

    /// With one point more.
    #[inline]
    pub(crate) fn with(self, point: Vector3<f64>) -> Self {
        Self {
            min: least(self.min, point),
            max: greatest(self.max, point),
        }
    }

    /// Around both.
    #[inline]
    pub(crate) fn union(self, other: Self) -> Self {
        Self {
            min: least(self.min, other.min),
            max: greatest(self.max, other.max),
        }
    }

    /// What is in both; empty, with least above greatest, where nothing is.
    pub(crate) fn intersection(self, other: Self) -> Self {
        Self {
            min: greatest(self.min, other.min),
            max: least(self.max, other.max),
        }
    }

    /// Larger by `by` on all sides.
    pub(crate) fn grown(self, by: f64) -> Self {
        let by = Vector3::new(by, by, by);
        Self {
            min: self.min - by,
            max: self.max + by,
        }
    }

    /// Its middle.
    #[inline]
    pub(crate) fn centre(&self) -> Vector3<f64> {
        (self.min + self.max) * 0.5
    }

    /// From its middle to a corner.
    #[inline]
    pub(crate) fn half_diagonal(&self) -> f64 {
        (self.max - self.min).norm() * 0.5
    }

    /// From a point to it, squared; 0 inside.
    #[inline]
    pub(crate) fn squared_distance(&self, point: Vector3<f64>) -> f64 {
        let nearest = greatest(self.min, least(self.max, point));
        (point - nearest).norm_squared()
    }

    /// Around the same box placed elsewhere.
    #[must_use]
    pub fn placed(&self, world_from_shape: &Placement<f64>) -> Self {
        let corner = |i: u8| {
            let pick = |bit, min, max| if i & bit == 0 { min } else { max };
            let x = pick(1, self.min.x, self.max.x);
            let y = pick(2, self.min.y, self.max.y);
            Vector3::new(x, y, pick(4, self.min.z, self.max.z))
        };
        match (self.max - self.min).norm().is_finite() {
            true => Self::around((0..8).map(|i| world_from_shape.apply(corner(i)))),
            false => Self::EVERYWHERE,
        }
    }

    /// Without bounds.
    const EVERYWHERE: Self = Self {
        min: Self::EMPTY.max,
        max: Self::EMPTY.min,
    };
}

#[inline]
fn least(a: Vector3<f64>, b: Vector3<f64>) -> Vector3<f64> {
    Vector3::new(a.x.min(b.x), a.y.min(b.y), a.z.min(b.z))
}

#[inline]
fn greatest(a: Vector3<f64>, b: Vector3<f64>) -> Vector3<f64> {
    Vector3::new(a.x.max(b.x), a.y.max(b.y), a.z.max(b.z))
}

impl Shape {
    /// The box around it in its own coordinates; infinite for a half-space in all directions but up.
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
                ..BoundingBox::EVERYWHERE
            },
            ShapeKind::Convex(hull) => BoundingBox::around(hull.vertices().iter().copied()),
            ShapeKind::Mesh(mesh) => mesh.bounding_box(),
            ShapeKind::HeightField(field) => field.bounding_box(),
            ShapeKind::Points(cloud) => cloud.bounding_box(),
        }
    }

    /// A ball around it in its own coordinates: the least one about the middle of the bounding box, or the origin.
    #[must_use]
    pub fn bounding_sphere(&self) -> Ball {
        let about_origin = |radius| Ball {
            centre: Vector3::zero(),
            radius,
        };
        let around = |points: &[Vector3<f64>], grown: f64| {
            let centre = BoundingBox::around(points.iter().copied()).centre();
            let far = |p: &Vector3<f64>| (*p - centre).norm_squared();
            let radius = points.iter().map(far).fold(0.0, f64::max).sqrt() + grown;
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
