//! Random convex shapes with support functions independent of the library.

use super::random::Random;
use kinopt::collision::Shape;
use kinopt::spatial::{Placement, Vector3};
use nalgebra as na;

/// Shape data independent of the library's types.
#[derive(Clone, Debug)]
pub enum Solid {
    Sphere(f64),
    Capsule(f64, f64),
    Cylinder(f64, f64),
    Cuboid([f64; 3]),
    Convex(Vec<na::Vector3<f64>>),
}

impl Solid {
    /// Random shape of one of the five kinds. Lengths are between 0.05 and 1 m; some shapes are very thin.
    pub fn random(random: &mut Random) -> Self {
        let kind = random.below(5);
        Self::of_kind(kind, random)
    }

    pub fn of_kind(kind: usize, random: &mut Random) -> Self {
        let mut length = || match random.below(10) {
            0 => random.within(1e-4, 1e-3),
            _ => random.within(0.05, 1.0),
        };
        match kind {
            0 => Self::Sphere(length()),
            1 => Self::Capsule(length(), length()),
            2 => Self::Cylinder(length(), length()),
            3 => Self::Cuboid([length(), length(), length()]),
            _ => {
                let count = 4 + random.below(12);
                Self::Convex((0..count).map(|_| random.vector(0.6)).collect())
            }
        }
    }

    pub fn shape(&self) -> Shape {
        match self {
            Self::Sphere(r) => Shape::sphere(*r),
            Self::Capsule(r, l) => Shape::capsule(*r, *l),
            Self::Cylinder(r, l) => Shape::cylinder(*r, *l),
            Self::Cuboid(size) => Shape::cuboid(*size),
            Self::Convex(points) => {
                let points: Vec<_> = points.iter().map(|&p| Vector3::from(p)).collect();
                Shape::convex(&points)
            }
        }
        .unwrap()
    }

    /// Support function: largest extent along a direction in the shape's coordinates.
    pub fn reach(&self, u: na::Vector3<f64>) -> f64 {
        match self {
            Self::Sphere(r) => r * u.norm(),
            Self::Capsule(r, l) => r * u.norm() + 0.5 * l * u.z.abs(),
            Self::Cylinder(r, l) => r * u.xy().norm() + 0.5 * l * u.z.abs(),
            Self::Cuboid(size) => 0.5 * u.abs().dot(&na::Vector3::from(*size)),
            Self::Convex(points) => points.iter().map(|p| p.dot(&u)).fold(f64::MIN, f64::max),
        }
    }

    /// Support function along a direction in world coordinates, at a placement.
    pub fn reach_at(&self, at: &Placement<f64>, u: na::Vector3<f64>) -> f64 {
        let at = na::Isometry3::from(*at);
        self.reach(at.inverse_transform_vector(&u)) + at.translation.vector.dot(&u)
    }
}

/// Gap between two shapes along a unit direction from the first to the second. It is at most their distance; if
/// negative, its magnitude is at least their penetration depth.
pub fn gap_along(
    first: (&Solid, &Placement<f64>),
    second: (&Solid, &Placement<f64>),
    u: na::Vector3<f64>,
) -> f64 {
    -second.0.reach_at(second.1, -u) - first.0.reach_at(first.1, u)
}
