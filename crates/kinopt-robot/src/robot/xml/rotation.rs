//! Rotations in robot files.

use kinopt_kinematics::spatial::{Matrix3, Quaternion, Vector3};

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
