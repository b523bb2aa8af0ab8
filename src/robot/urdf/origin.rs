//! `<origin>`: where something stands, and rotations as URDF writes them.

use super::version::Version;
use crate::robot::xml::{Element, Fault, RobotFileError};
use crate::scalar::elementary;
use crate::spatial::{Matrix3, Placement, Quaternion, Vector3};

/// A sine or cosine below this is that of a quarter turn, which no file can write exactly.
const QUARTER_TURN_WITHIN: f64 = 1e-15;

/// Where the child `<origin>` of an element puts it; the identity where there is none.
pub(super) fn read(
    element: &Element<'_>,
    version: Version,
) -> Result<Placement<f64>, RobotFileError> {
    let Some(origin) = element.child("origin")? else {
        return Ok(Placement::identity());
    };
    let xyz = origin.numbers::<3>("xyz")?.unwrap_or_default();
    let rpy = origin.numbers::<3>("rpy")?;
    let quaternion = origin.numbers::<4>("quat_xyzw")?;
    let bad = |problem| Err(origin.fault(Fault::BadQuaternion { problem }));
    let rotation = match (rpy, quaternion) {
        (rpy, None) => from_roll_pitch_yaw(rpy.unwrap_or_default()),
        _ if version < Version(1, 1) => return bad("needs <robot version=\"1.1\">"),
        (Some(_), Some(_)) => return bad("and `rpy` are both given"),
        (None, Some(xyzw)) if xyzw == [0.0; 4] => return bad("is zero and no rotation"),
        (None, Some(xyzw)) => from_quaternion(xyzw),
    };
    Ok(Placement::new(rotation, Vector3::from(xyz)))
}

/// Roll, pitch and yaw in radians about the parent's fixed x, y and z axes:
/// R = R_z(yaw) · R_y(pitch) · R_x(roll).
///
/// Quarter turns come out with exact zeros, within 1e-15 of what the file says, so that axes stay
/// aligned along a chain.
fn from_roll_pitch_yaw([roll, pitch, yaw]: [f64; 3]) -> Matrix3<f64> {
    Matrix3::identity()
        .rotated_about_z(sin_cos(yaw))
        .rotated_about_y(sin_cos(pitch))
        .rotated_about_x(sin_cos(roll))
}

/// A quaternion in URDF's own order x, y, z, w, of any length but zero.
fn from_quaternion(xyzw: [f64; 4]) -> Matrix3<f64> {
    let largest = xyzw.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
    let [x, y, z, w] = xyzw.map(|c| c / largest);
    let length = (x * x + y * y + z * z + w * w).sqrt();
    Quaternion {
        w: w / length,
        v: Vector3::new(x / length, y / length, z / length),
    }
    .to_matrix()
}

fn sin_cos(angle: f64) -> (f64, f64) {
    let (sin, cos) = elementary::sin_cos(angle);
    let clean = |value: f64| match value.abs() < QUARTER_TURN_WITHIN {
        true => 0.0,
        false => value,
    };
    (clean(sin), clean(cos))
}
