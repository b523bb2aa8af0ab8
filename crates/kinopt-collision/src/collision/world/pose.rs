//! Poses of obstacles in files.

use kinopt_kinematics::spatial::{Matrix3, Placement, Quaternion, Vector3};

/// Tolerance of a quaternion's length, for quaternions written with four digits.
const LENGTH_TOLERANCE: f64 = 1e-3;

/// Normalises a quaternion. The error describes a length that is off by more than [`LENGTH_TOLERANCE`].
pub(super) fn unit_quaternion(given: Quaternion<f64>) -> Result<Quaternion<f64>, String> {
    let Quaternion { w, v } = given;
    let length = (w * w + v.norm_squared()).sqrt();
    if (length - 1.0).abs() <= LENGTH_TOLERANCE {
        let scale = length.recip();
        return Ok(Quaternion {
            w: w * scale,
            v: v * scale,
        });
    }
    Err(format!(
        "the quaternion's length is {length}, not 1 within {LENGTH_TOLERANCE}"
    ))
}

/// A pose as a file writes it. The quaternion is w, x, y, z; the rotation matrix is row by row.
pub(super) struct FilePose {
    pub(super) position: [f64; 3],
    pub(super) quaternion: Option<[f64; 4]>,
    pub(super) rotation: Option<[[f64; 3]; 3]>,
}

impl FilePose {
    pub(super) fn of(placement: &Placement<f64>) -> Self {
        let mut pose = Self {
            position: placement.translation.to_array(),
            quaternion: None,
            rotation: None,
        };
        if placement.rotation == Matrix3::identity() {
            return pose;
        }
        let quaternion = Quaternion::from_matrix(&placement.rotation);
        let [x, y, z] = quaternion.v.to_array();
        pose.quaternion = Some([quaternion.w, x, y, z]);
        // A matrix reads back exactly, a quaternion not always.
        if pose.placement().as_ref() != Ok(placement) {
            let Matrix3 { x, y, z } = placement.rotation.transpose();
            pose.quaternion = None;
            pose.rotation = Some([x, y, z].map(Vector3::to_array));
        }
        pose
    }

    pub(super) fn placement(&self) -> Result<Placement<f64>, String> {
        let rotation = match (self.quaternion, self.rotation) {
            (None, None) => Matrix3::identity(),
            (Some([w, x, y, z]), None) => {
                let v = Vector3::new(x, y, z);
                unit_quaternion(Quaternion { w, v })?.to_matrix()
            }
            (None, Some(rows)) => {
                let [x, y, z] = rows.map(Vector3::from);
                Matrix3 { x, y, z }.transpose()
            }
            (Some(_), Some(_)) => return Err("has both a `quaternion` and a `rotation`".to_owned()),
        };
        Ok(Placement::new(rotation, self.position.into()))
    }
}
