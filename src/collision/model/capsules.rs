//! Detection of capsules in URDF files, which write them as a cylinder with a sphere at each end.

use super::CollisionObject;
use crate::collision::{Shape, ShapeKind};
use crate::spatial::Vector3;

/// Tolerance of the spheres' centres and radii, relative to the radius.
const ROUNDING: f64 = 1e-4;

/// Replaces each cylinder that has a sphere of its radius at both ends by a capsule. A sphere may serve several
/// cylinders.
pub(super) fn joined(objects: Vec<CollisionObject>) -> Vec<CollisionObject> {
    let sphere_at = |end: Vector3<f64>, radius: f64| {
        objects.iter().position(|object| match object.shape.kind() {
            ShapeKind::Sphere { radius: own } => {
                let away = (object.link_from_shape.translation - end).norm();
                away.max((own - radius).abs()) <= ROUNDING * radius
            }
            _ => false,
        })
    };
    let mut within = vec![false; objects.len()];
    let mut capsules = Vec::with_capacity(objects.len());
    for object in &objects {
        let ShapeKind::Cylinder { radius, length } = object.shape.kind() else {
            capsules.push(None);
            continue;
        };
        let end = |z: f64| object.link_from_shape.apply(Vector3::new(0.0, 0.0, z));
        let caps = [-length / 2.0, length / 2.0].map(|z| sphere_at(end(z), *radius));
        capsules.push(match (caps, Shape::capsule(*radius, *length)) {
            ([Some(a), Some(b)], Ok(capsule)) => {
                (within[a], within[b]) = (true, true);
                Some(capsule)
            }
            _ => None,
        });
    }
    let each = objects.into_iter().zip(capsules).zip(within);
    let kept = each.filter(|(_, within)| !within);
    kept.map(|((object, capsule), _)| match capsule {
        Some(shape) => CollisionObject { shape, ..object },
        None => object,
    })
    .collect()
}
