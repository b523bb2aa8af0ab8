//! Rotation task of a bone in the model.

use glam::{DQuat, DVec4};

use crate::animation::rotation::exponential::share_of;
use crate::problem::{ProblemBuilder, TaskId};
use crate::skeleton::{BoneId, Skeleton};
use crate::spatial::{Matrix3, Quaternion};
use crate::task::Orientation;

/// Bone whose rotation follows the clip, or a target by a weight.
#[derive(Clone, Debug)]
pub(super) struct Held {
    pub(super) bone: BoneId,
    pub(super) task: TaskId<Orientation>,
    pub(super) weight: f64,
    wanted: DQuat,
}

impl Held {
    /// Adds the task, with weight 0.
    pub(super) fn new(skeleton: &Skeleton, bone: BoneId, builder: &mut ProblemBuilder<'_>) -> Self {
        let at_first = Matrix3::identity();
        Self {
            bone,
            task: builder.add(Orientation::new(skeleton.tail(bone), at_first)),
            weight: 0.0,
            wanted: DQuat::IDENTITY,
        }
    }

    /// Sets the target rotation as a quaternion of any length. Returns false if it is zero or not finite.
    pub(super) fn set(&mut self, rotation: Quaternion<f64>, weight: f64) -> bool {
        let unit = DVec4::from(DQuat::from(rotation)).try_normalize();
        if let Some(unit) = unit {
            (self.wanted, self.weight) = (DQuat::from_vec4(unit), weight);
        }
        unit.is_some()
    }

    /// The clip's rotation, interpolated to the target by the weight along the shortest arc.
    pub(super) fn target(&self, clip: DQuat) -> Matrix3<f64> {
        let mut turned = clip;
        if self.weight > 0.0 {
            turned = share_of(self.wanted * clip.conjugate(), self.weight) * clip;
        }
        Quaternion::from(turned).to_matrix()
    }
}
