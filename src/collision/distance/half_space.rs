//! A half-space and any shape: the shape's lowest point.

use crate::collision::shape::{BoundingBox, ShapeKind};
use crate::spatial::{Placement, Vector3};

use super::core::{Core, Gap};

/// How far a shape is above z = 0.
pub(super) fn gap(other: &ShapeKind, half_from_other: &Placement<f64>) -> Option<Gap> {
    let up = half_from_other.rotation.transpose_mul(Vector3::UNITS[2]);
    let (lowest, radius) = match other {
        ShapeKind::HalfSpace => return Some(two(half_from_other)),
        ShapeKind::Mesh(mesh) => (lowest(mesh.vertices(), up), 0.0),
        ShapeKind::Points(cloud) => (lowest(cloud.positions(), up), cloud.radius()),
        ShapeKind::HeightField(field) => {
            let BoundingBox { min, max } = field.tree().bounds();
            // It has no lowest point but where its bottomless depth points up.
            if up.z < 0.0 && up.x == 0.0 && up.y == 0.0 {
                (Vector3::new(min.x, min.y, max.z), 0.0)
            } else {
                return Some(bottomless(half_from_other.apply((min + max) * 0.5)));
            }
        }
        _ => {
            let (core, radius) = Core::of(other)?;
            (core.support(-up), radius)
        }
    };
    let mut on_b = half_from_other.apply(lowest);
    on_b.z -= radius;
    Some(above(on_b))
}

fn above(on_b: Vector3<f64>) -> Gap {
    Gap {
        distance: on_b.z,
        on_a: Vector3::new(on_b.x, on_b.y, 0.0),
        on_b,
        normal: Vector3::UNITS[2],
    }
}

fn bottomless(at: Vector3<f64>) -> Gap {
    Gap {
        distance: f64::NEG_INFINITY,
        ..above(Vector3::new(at.x, at.y, 0.0))
    }
}

/// Apart where they face away from each other exactly, else they meet without end.
fn two(half_from_other: &Placement<f64>) -> Gap {
    let origin = half_from_other.translation;
    match half_from_other.rotation.z.z <= -1.0 {
        true => above(origin),
        false => bottomless(origin),
    }
}

fn lowest(points: &[Vector3<f64>], up: Vector3<f64>) -> Vector3<f64> {
    let first = (up.dot(points[0]), points[0]);
    let least = points.iter().fold(first, |least, &point| {
        let height = up.dot(point);
        if height < least.0 {
            (height, point)
        } else {
            least
        }
    });
    least.1
}
