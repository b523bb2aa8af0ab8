//! Memory for checks.

use super::continuous_check::{Contact, Slow, Watched};
use super::motion_bound::BoundRoom;
use super::scene_placements::SceneRoom;
use crate::kinematics::{ForwardKinematics, KinematicsError};
use crate::model::{FrameId, Model};
use crate::spatial::Placement;

/// Places the parts of one [`Checker`](super::Checker) again and again.
#[derive(Clone, Debug)]
pub struct CheckerWorkspace {
    kinematics: ForwardKinematics<f64>,
    scene: SceneRoom,
    pub(super) bound: BoundRoom,
    /// A configuration on a way, and what is watched there.
    pub(super) between: Vec<f64>,
    pub(super) watched: Vec<Watched>,
    /// What is nearer than the margin where a way begins, and may be.
    pub(super) contacts: Vec<Contact>,
    /// What slides, by the place of what is watched, and where that is looked at.
    pub(super) slow: Vec<(usize, Slow)>,
    pub(super) there: Vec<f64>,
}

impl CheckerWorkspace {
    pub(super) fn new(model: &Model, frames: impl Iterator<Item = FrameId>) -> Self {
        let frames: Vec<FrameId> = frames.collect();
        Self {
            kinematics: ForwardKinematics::of_configurations(model, &frames),
            scene: SceneRoom::default(),
            bound: BoundRoom::default(),
            between: Vec::new(),
            watched: Vec::new(),
            contacts: Vec::new(),
            slow: Vec::new(),
            there: Vec::new(),
        }
    }

    /// Where the parts stand at a configuration, and room for a visit.
    pub(super) fn place(
        &mut self,
        q: &[f64],
    ) -> Result<(&[Placement<f64>], &mut SceneRoom), KinematicsError> {
        Ok((self.kinematics.place(q)?, &mut self.scene))
    }

    /// The same on a way whose bound was taken.
    pub(super) fn place_on_way(
        &mut self,
        q: &[f64],
    ) -> Result<(&[Placement<f64>], &mut SceneRoom, &BoundRoom), KinematicsError> {
        Ok((self.kinematics.place(q)?, &mut self.scene, &self.bound))
    }
}
