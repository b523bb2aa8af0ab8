//! Heading of the pelvis from the hip positions.

use super::limbs::Limbs;
use super::point_difference::PointDifference;
use kinopt_kinematics::model::FrameId;
use kinopt_kinematics::spatial::Vector3;

/// Weight of the rotation of the hip line, in metres of position per radian.
const ROTATION_WEIGHT: f64 = 0.3;
/// Distance of the hips below which they define no line, metres.
const MIN_HIP_DISTANCE: f64 = 1e-3;

/// Line from one hip to the other.
///
/// Hips are so close that their positions barely determine the heading of the pelvis. Without this task legs would wind
/// up.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct HipLine {
    limbs: [usize; 2],
    frames: [FrameId; 2],
    offsets: [Vector3<f64>; 2],
    stance: Vector3<f64>,
}

impl HipLine {
    /// Creates the line of the first two hips, if there are two. `stance_positions` has the end positions of all limbs in
    /// a configuration.
    pub(super) fn new(limbs: &Limbs, stance_positions: &[Vector3<f64>]) -> Option<Self> {
        let [a, b] = *limbs.hips.first_chunk::<2>()?;
        let frames = [a, b].map(|k| limbs.all[k].frame);
        let stance = stance_positions[a] - stance_positions[b];
        (stance.norm() > MIN_HIP_DISTANCE && frames[0] != frames[1]).then(|| Self {
            limbs: [a, b],
            frames,
            offsets: [a, b].map(|k| limbs.all[k].offset),
            stance,
        })
    }

    /// Creates the task of the line.
    pub(super) fn task(&self) -> PointDifference {
        let weight = ROTATION_WEIGHT / self.stance.norm();
        let mut task = PointDifference::new(self.frames, self.offsets, weight);
        task.set_target(self.stance);
        task
    }

    /// Sets the direction of the line from the targets of the hips. The direction stays if these coincide.
    pub(super) fn set_direction(&self, targets: &[Vector3<f64>], task: &mut PointDifference) {
        let [a, b] = self.limbs;
        let direction = targets[a] - targets[b];
        let length = direction.norm();
        if length > 0.0 {
            task.set_target(direction * (self.stance.norm() / length));
        }
    }
}
