//! Rotations in robot files.

use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::{Matrix3, Quaternion, Vector3};

/// Largest sine or cosine that is rounded to 0. Files cannot state multiples of π/2 exactly.
const QUARTER_TURN_TOLERANCE: f64 = 1e-15;

/// Sine and cosine of an angle in radians, with exact zeros at multiples of π/2 so that axes stay aligned along a
/// chain.
pub(crate) fn clean_sin_cos(angle: f64) -> (f64, f64) {
    let (sin, cos) = elementary::sin_cos(angle);
    let clean = |value: f64| match value.abs() < QUARTER_TURN_TOLERANCE {
        true => 0.0,
        false => value,
    };
    (clean(sin), clean(cos))
}

/// Rotation matrix of a quaternion w, x, y, z; `None` if it is zero.
pub(crate) fn rotation_of_wxyz(wxyz: [f64; 4]) -> Option<Matrix3<f64>> {
    let largest = wxyz.iter().fold(0.0_f64, |max, c| max.max(c.abs()));
    if largest == 0.0 {
        return None;
    }
    let [w, x, y, z] = wxyz.map(|c| c / largest);
    let length = (w * w + x * x + y * y + z * z).sqrt();
    let (w, v) = (w / length, Vector3::new(x / length, y / length, z / length));
    Some(Quaternion { w, v }.to_matrix())
}
