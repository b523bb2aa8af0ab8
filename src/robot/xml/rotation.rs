//! Rotations as files write them.

use crate::scalar::elementary;
use crate::spatial::{Matrix3, Quaternion, Vector3};

/// A sine or cosine below this is that of a quarter turn, which no file can write exactly.
const QUARTER_TURN_WITHIN: f64 = 1e-15;

/// Sine and cosine; exact zeros at quarter turns, so that axes stay aligned along a chain.
pub(crate) fn clean_sin_cos(angle: f64) -> (f64, f64) {
    let (sin, cos) = elementary::sin_cos(angle);
    let clean = |value: f64| match value.abs() < QUARTER_TURN_WITHIN {
        true => 0.0,
        false => value,
    };
    (clean(sin), clean(cos))
}

/// A quaternion w, x, y, z of any length but zero.
pub(crate) fn rotation_of_wxyz(wxyz: [f64; 4]) -> Option<Matrix3<f64>> {
    let largest = wxyz.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
    if largest == 0.0 {
        return None;
    }
    let [w, x, y, z] = wxyz.map(|c| c / largest);
    let length = (w * w + x * x + y * y + z * z).sqrt();
    let (w, v) = (w / length, Vector3::new(x / length, y / length, z / length));
    Some(Quaternion { w, v }.to_matrix())
}
