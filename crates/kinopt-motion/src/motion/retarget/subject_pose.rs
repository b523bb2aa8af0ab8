//! Pose of a subject in a capture frame, with z up.

use glam::DQuat;

use super::{Capture, UpAxis};
use kinopt_kinematics::spatial::{Matrix3, Quaternion, Vector3};

/// Joints of a capture frame, with z up.
#[derive(Clone, Copy, Debug)]
pub(super) struct SubjectPose<'a> {
    up: UpAxis,
    positions: &'a [Vector3<f64>],
    /// Rotations from the joints to the capture's world, if the source has them.
    rotations: Option<&'a [DQuat]>,
}

impl<'a> SubjectPose<'a> {
    pub(super) fn new(
        up: UpAxis,
        positions: &'a [Vector3<f64>],
        rotations: Option<&'a [DQuat]>,
    ) -> Self {
        Self {
            up,
            positions,
            rotations,
        }
    }

    /// Returns the pose of a capture frame, or `None` beyond the last one.
    pub(super) fn of_frame(capture: &'a Capture, frame: usize, up: UpAxis) -> Option<Self> {
        let positions = capture.frame(frame)?;
        let n = positions.len();
        let rotations = capture
            .posed()
            .and_then(|posed| posed.rotations.get(frame * n..(frame + 1) * n));
        Some(Self::new(up, positions, rotations))
    }

    /// Position of a joint, in the capture's unit.
    pub(super) fn position(&self, joint: usize) -> Vector3<f64> {
        self.up.upright(self.positions[joint])
    }

    /// Rotation from a joint to the upright world, if the source has it.
    pub(super) fn rotation(&self, joint: usize) -> Option<Matrix3<f64>> {
        let q = self.rotations?.get(joint)?;
        let v = self.up.upright(Vector3::new(q.x, q.y, q.z));
        let [x, y, z] = Vector3::UNITS.map(|axis| self.up.upright(axis));
        let axes = Matrix3::from_columns(x, y, z);
        // With v turned, q is the rotation in upright axes of an upright joint.
        Some(Quaternion { w: q.w, v }.to_matrix() * axes)
    }
}
