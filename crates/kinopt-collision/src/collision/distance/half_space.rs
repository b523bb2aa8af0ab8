//! Signed distance of a half-space and any shape, from the shape's lowest point.

use crate::collision::shape::ShapeKind;
use kinopt_kinematics::spatial::{Placement, Vector3};

use super::core_and_radius::{Core, Gap};

/// The gap of the half-space z < 0 and a shape; `None` for a shape without a lowest point.
pub(super) fn gap(other: &ShapeKind, half_from_other: &Placement<f64>) -> Option<Gap> {
    let up = half_from_other.rotation.transpose_mul(Vector3::UNITS[2]);
    let (lowest, radius) = match other {
        ShapeKind::HalfSpace => return Some(between_half_spaces(half_from_other)),
        ShapeKind::Mesh(mesh) => (lowest(mesh.vertices().iter().copied(), up), 0.0),
        ShapeKind::Points(cloud) => (
            lowest(cloud.positions().iter().copied(), up),
            cloud.radius(),
        ),
        ShapeKind::HeightField(field) => {
            let corners = (0..field.triangle_count()).flat_map(|i| field.triangle(i));
            (lowest(corners, up), 0.0)
        }
        _ => {
            let (core, radius) = Core::of(other)?;
            (core.support(-up), radius)
        }
    };
    let mut on_b = half_from_other.apply(lowest);
    on_b.z -= radius;
    Some(gap_above(on_b))
}

fn gap_above(on_b: Vector3<f64>) -> Gap {
    Gap {
        distance: on_b.z,
        on_a: Vector3::new(on_b.x, on_b.y, 0.0),
        on_b,
        normal: Vector3::UNITS[2],
    }
}

fn unbounded_overlap(at: Vector3<f64>) -> Gap {
    Gap {
        distance: f64::NEG_INFINITY,
        ..gap_above(Vector3::new(at.x, at.y, 0.0))
    }
}

/// Two half-spaces. They are apart only if they face exactly away from each other, else they meet without bound.
fn between_half_spaces(half_from_other: &Placement<f64>) -> Gap {
    let origin = half_from_other.translation;
    match half_from_other.rotation.z.z <= -1.0 {
        true => gap_above(origin),
        false => unbounded_overlap(origin),
    }
}

fn lowest(points: impl Iterator<Item = Vector3<f64>>, up: Vector3<f64>) -> Vector3<f64> {
    let first = (f64::INFINITY, Vector3::zero());
    let lowest = points.fold(first, |lowest, point| {
        let height = up.dot(point);
        if height < lowest.0 {
            (height, point)
        } else {
            lowest
        }
    });
    lowest.1
}
