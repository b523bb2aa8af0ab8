//! Detection of capsules in URDF files, which write them as a cylinder with a sphere at each end.

use super::CollisionObject;
use crate::collision::{Shape, ShapeKind};
use kinopt_kinematics::spatial::Vector3;

/// Tolerance of the spheres' centres and radii, relative to the radius.
const CAP_TOLERANCE: f64 = 1e-4;

/// Replaces each cylinder that has a sphere of its radius at both ends by a capsule. A sphere may serve several
/// cylinders.
pub(super) fn with_capsules(objects: Vec<CollisionObject>) -> Vec<CollisionObject> {
    let sphere_at = |end: Vector3<f64>, radius: f64| {
        objects.iter().position(|object| match object.shape.kind() {
            ShapeKind::Sphere {
                radius: sphere_radius,
            } => {
                let distance = (object.link_from_shape.translation - end).norm();
                distance.max((sphere_radius - radius).abs()) <= CAP_TOLERANCE * radius
            }
            _ => false,
        })
    };
    let mut is_cap = vec![false; objects.len()];
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
                (is_cap[a], is_cap[b]) = (true, true);
                Some(capsule)
            }
            _ => None,
        });
    }
    let objects_with_capsules = objects.into_iter().zip(capsules).zip(is_cap);
    let remaining = objects_with_capsules.filter(|(_, is_cap)| !is_cap);
    remaining
        .map(|((object, capsule), _)| match capsule {
            Some(shape) => CollisionObject { shape, ..object },
            None => object,
        })
        .collect()
}
