//! Rotation task of a bone in the model.

use glam::{DQuat, DVec4};

use crate::animation::rotation::exponential::partial_rotation;
use kinopt_kinematics::skeleton::{BoneId, Skeleton};
use kinopt_kinematics::spatial::{Matrix3, Quaternion};
use kinopt_solver::problem::{ProblemBuilder, TaskId};
use kinopt_solver::task::Orientation;

/// Bone whose rotation follows the clip, or a target by a weight.
#[derive(Clone, Debug)]
pub(super) struct HeldRotation {
    pub(super) bone: BoneId,
    pub(super) task: TaskId<Orientation>,
    pub(super) weight: f64,
    target_rotation: DQuat,
}

impl HeldRotation {
    /// Adds the task, with weight 0.
    pub(super) fn new(skeleton: &Skeleton, bone: BoneId, builder: &mut ProblemBuilder<'_>) -> Self {
        let initial = Matrix3::identity();
        Self {
            bone,
            task: builder.add(Orientation::new(skeleton.tail(bone), initial)),
            weight: 0.0,
            target_rotation: DQuat::IDENTITY,
        }
    }

    /// Sets the target rotation as a quaternion of any length. Returns false if it is zero or not finite.
    pub(super) fn set(&mut self, rotation: Quaternion<f64>, weight: f64) -> bool {
        let unit = DVec4::from(DQuat::from(rotation)).try_normalize();
        if let Some(unit) = unit {
            (self.target_rotation, self.weight) = (DQuat::from_vec4(unit), weight);
        }
        unit.is_some()
    }

    /// The clip's rotation, interpolated to the target by the weight along the shortest arc.
    pub(super) fn target(&self, clip: DQuat) -> Matrix3<f64> {
        let mut rotation = clip;
        if self.weight > 0.0 {
            rotation =
                partial_rotation(self.target_rotation * clip.conjugate(), self.weight) * clip;
        }
        Quaternion::from(rotation).to_matrix()
    }
}
