//! A bone whose rotation in the model is a task of the optimiser.

use glam::{DQuat, DVec4};

use crate::animation::rotation::exponential::share_of;
use crate::problem::{ProblemBuilder, TaskId};
use crate::skeleton::{BoneId, Skeleton};
use crate::spatial::{Matrix3, Quaternion};
use crate::task::Orientation;

/// A bone that is held as the clip has it, or turned by a weight.
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

    /// Sets the rotation wanted, of any length; whether it is one.
    pub(super) fn set(&mut self, rotation: Quaternion<f64>, weight: f64) -> bool {
        let unit = DVec4::from(DQuat::from(rotation)).try_normalize();
        if let Some(unit) = unit {
            (self.wanted, self.weight) = (DQuat::from_vec4(unit), weight);
        }
        unit.is_some()
    }

    /// The clip's rotation, turned by the weight's share of the shortest arc to the one wanted.
    pub(super) fn target(&self, clip: DQuat) -> Matrix3<f64> {
        let mut turned = clip;
        if self.weight > 0.0 {
            turned = share_of(self.wanted * clip.conjugate(), self.weight) * clip;
        }
        Quaternion::from(turned).to_matrix()
    }
}
