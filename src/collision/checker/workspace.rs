//! Memory for checks.

use super::motion_bound::BoundRoom;
use crate::kinematics::{ForwardKinematics, KinematicsError};
use crate::model::{FrameId, Model};
use crate::spatial::Placement;

/// Places the parts of one [`Checker`](super::Checker) again and again.
#[derive(Clone, Debug)]
pub struct CheckerWorkspace {
    kinematics: ForwardKinematics<f64>,
    pub(super) bound: BoundRoom,
    /// A configuration on a way.
    pub(super) between: Vec<f64>,
}

impl CheckerWorkspace {
    pub(super) fn new(model: &Model, frames: impl Iterator<Item = FrameId>) -> Self {
        let frames: Vec<FrameId> = frames.collect();
        Self {
            kinematics: ForwardKinematics::of_configurations(model, &frames),
            bound: BoundRoom::default(),
            between: Vec::new(),
        }
    }

    /// Where the parts stand at a configuration.
    pub(super) fn place(&mut self, q: &[f64]) -> Result<&[Placement<f64>], KinematicsError> {
        self.kinematics.place(q)
    }
}
