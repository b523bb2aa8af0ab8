//! Rotations between directions, fractions of rotations, and twists.

use glam::{DQuat, DVec3};

use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::{Quaternion, Vector3};

/// Squared length below which a vector has no direction.
const MIN_LENGTH_SQUARED: f64 = 1e-24;

/// Returns the smallest rotation that maps the direction of one vector to that of another; the identity if one of them
/// has no direction.
pub(super) fn arc(from: DVec3, to: DVec3) -> DQuat {
    if from.length_squared().min(to.length_squared()) < MIN_LENGTH_SQUARED {
        return DQuat::IDENTITY;
    }
    let (from, to) = (from.normalize(), to.normalize());
    // Half-way vector: (from × half, from · half) is the quaternion of half the angle, doubled.
    let half = from + to;
    let half = match half.length_squared() < 1e-20 {
        true => from.any_orthonormal_vector(),
        false => half.normalize(),
    };
    let axis = from.cross(half);
    DQuat::from_xyzw(axis.x, axis.y, axis.z, from.dot(half)).normalize()
}

/// Returns a rotation vector (axis × angle in radians) of at most half a turn.
pub(super) fn rotation_vector(rotation: DQuat) -> DVec3 {
    let v = Vector3::new(rotation.x, rotation.y, rotation.z);
    let log = Quaternion { w: rotation.w, v }.log();
    DVec3::from_array(log.to_array())
}

/// Returns the rotation of a rotation vector (axis × angle in radians).
pub(super) fn from_rotation_vector(vector: DVec3) -> DQuat {
    let q = Quaternion::exp(Vector3::from(vector.to_array()));
    DQuat::from_xyzw(q.v.x, q.v.y, q.v.z, q.w)
}

/// Returns a rotation about the same axis by a fraction of the angle.
pub(super) fn fraction(rotation: DQuat, fraction: f64) -> DQuat {
    from_rotation_vector(rotation_vector(rotation) * fraction)
}

/// Returns the rotation at a fraction of the shortest way between two rotations.
pub(super) fn between(from: DQuat, to: DQuat, at: f64) -> DQuat {
    match at {
        0.0 => from,
        1.0 => to,
        _ => (fraction(to * from.conjugate(), at) * from).normalize(),
    }
}

/// Returns the angle in radians, within ±π, of the twist of a rotation about an axis: R = swing · twist.
pub(super) fn twist_angle(rotation: DQuat, axis: DVec3) -> f64 {
    let along = rotation.xyz().dot(axis.normalize_or_zero());
    let (along, w) = match rotation.w < 0.0 {
        true => (-along, -rotation.w),
        false => (along, rotation.w),
    };
    2.0 * elementary::atan2(along, w)
}

/// Returns the rotation about z between the horizontal directions of two vectors; the identity if one is vertical.
pub(super) fn heading(from: DVec3, to: DVec3) -> DQuat {
    let flat = |v: DVec3| DVec3::new(v.x, v.y, 0.0);
    let (from, to) = (flat(from), flat(to));
    let half = arc(from, to);
    // Opposite directions have many smallest rotations: the one about z is meant.
    match from.dot(to) < 0.0 && from.cross(to).z.abs() < 1e-9 * from.length() * to.length() {
        true => DQuat::from_xyzw(0.0, 0.0, 1.0, 0.0),
        false => half,
    }
}

/// Returns the rotation whose x axis is along `x` and whose y axis is near `y`; `None` if they are parallel.
pub(super) fn axes(x: DVec3, y: DVec3) -> Option<DQuat> {
    let x = x.try_normalize()?;
    let y = (y - x * y.dot(x)).try_normalize()?;
    let matrix = glam::DMat3::from_cols(x, y, x.cross(y));
    Some(DQuat::from_mat3(&matrix).normalize())
}
