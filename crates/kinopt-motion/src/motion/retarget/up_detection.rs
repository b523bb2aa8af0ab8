//! Detection of the axis that points upward in a capture.

use std::collections::BTreeMap;

use super::map_guess::parts_of_capture;
use super::{BodyPart, Capture, UpAxis};
use kinopt_kinematics::spatial::Vector3;

/// Smallest ratio of the extent along the vertical axis to that along each other axis.
const MIN_EXTENT_RATIO: f64 = 2.0;

impl Capture {
    /// Returns the axis from the ankles to the pelvis. The joints are found by their names.
    ///
    /// The mean over all capture frames decides. If it is along no axis, the rest pose of the clip decides. If both
    /// have an axis and these differ, the result is `None`, as for a subject that lies in every frame.
    ///
    /// ```
    /// use kinopt::motion::retarget::{Capture, UpAxis};
    ///
    /// let joints = ["Hips", "LeftFoot", "RightFoot"].map(str::to_owned).to_vec();
    /// let capture = Capture::new(joints, &[0.0, 0.0, 0.9, 0.1, 0.0, 0.0, -0.1, 0.0, 0.0], 30.0)?;
    /// assert_eq!(capture.up_axis(), Some(UpAxis::Z));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn up_axis(&self) -> Option<UpAxis> {
        let joints = parts_of_capture(self).joints;
        let moving = upright_axis(self, &joints);
        let resting = self.rest().and_then(|rest| {
            let legs = leg_joints(&joints)?;
            upright(pelvis_above_ankles(rest, legs))
        });
        match (moving, resting) {
            (Some(moving), Some(resting)) => (moving == resting).then_some(moving),
            (moving, resting) => moving.or(resting),
        }
    }
}

/// Returns the axis along which the pelvis is above the ankles, in the mean over all capture frames.
pub(super) fn upright_axis(
    capture: &Capture,
    joints: &BTreeMap<BodyPart, usize>,
) -> Option<UpAxis> {
    let legs = leg_joints(joints)?;
    let frames = (0..capture.frames()).filter_map(|frame| capture.frame(frame));
    let above = frames.fold(Vector3::zero(), |sum: Vector3<f64>, positions| {
        sum + pelvis_above_ankles(positions, legs)
    });
    upright(above)
}

/// Returns the joint indices of the pelvis and both ankles.
fn leg_joints(joints: &BTreeMap<BodyPart, usize>) -> Option<[usize; 3]> {
    let part = |part| joints.get(&part).copied();
    Some([
        part(BodyPart::Pelvis)?,
        part(BodyPart::LeftAnkle)?,
        part(BodyPart::RightAnkle)?,
    ])
}

fn pelvis_above_ankles(
    positions: &[Vector3<f64>],
    [pelvis, left, right]: [usize; 3],
) -> Vector3<f64> {
    positions[pelvis] - (positions[left] + positions[right]) * 0.5
}

/// Returns the axis in whose positive direction a displacement points, if one dominates.
pub(super) fn upright(above: Vector3<f64>) -> Option<UpAxis> {
    let [_, y, z] = above.to_array();
    upward(above).filter(|axis| match axis {
        UpAxis::Y => y > 0.0,
        UpAxis::Z => z > 0.0,
    })
}

/// Returns the axis along which a displacement points, up or down, if one dominates.
pub(super) fn upward(above: Vector3<f64>) -> Option<UpAxis> {
    let [x, y, z] = above.to_array().map(f64::abs);
    match () {
        () if y > MIN_EXTENT_RATIO * x.max(z) => Some(UpAxis::Y),
        () if z > MIN_EXTENT_RATIO * x.max(y) => Some(UpAxis::Z),
        () => None,
    }
}
