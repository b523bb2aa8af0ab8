//! Quaternions of files.

use crate::spatial::Quaternion;

/// How far a file's quaternion may be from unit length: written with four digits.
const OFF: f64 = 1e-3;

/// A quaternion of unit length next to a given one, or what is wrong with it.
pub(super) fn unit_quaternion(given: Quaternion<f64>) -> Result<Quaternion<f64>, String> {
    let Quaternion { w, v } = given;
    let length = w.mul_add(w, v.norm_squared()).sqrt();
    if (length - 1.0).abs() <= OFF {
        let scale = length.recip();
        return Ok(Quaternion {
            w: w * scale,
            v: v * scale,
        });
    }
    Err(format!(
        "the quaternion's length is {length}, not 1 within {OFF}"
    ))
}
