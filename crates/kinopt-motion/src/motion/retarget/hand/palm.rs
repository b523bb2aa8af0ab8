//! Axes of a palm.

use kinopt_kinematics::spatial::{Matrix3, Vector3};

/// Length below which a direction is undetermined, relative to the hand.
const MIN_LENGTH: f64 = 1e-6;

/// Returns the axes of a palm as columns: along the fingers, across them towards the index finger, and their normal.
///
/// `bases` are the bases of the fingers, from the index finger outward.
pub(super) fn axes(along: Vector3<f64>, bases: &[Vector3<f64>]) -> Option<Matrix3<f64>> {
    let [first, .., last] = bases else {
        return None;
    };
    let across = *first - *last;
    let normal = along.cross(across);
    let size = along.norm().max(across.norm());
    if normal.norm() <= MIN_LENGTH * size * size {
        return None;
    }
    let [x, z] = [along, normal].map(|v| v * (1.0 / v.norm()));
    Some(Matrix3::from_columns(x, z.cross(x), z))
}
