//! Memory for checks.

use std::sync::Arc;

use super::Checker;
use super::continuous_check::{Contact, Slow, Watched};
use super::motion_bound::BoundRoom;
use super::parts::Part;
use super::scene_placements::SceneRoom;
use crate::kinematics::{ForwardKinematics, KinematicsError};
use crate::model::FrameId;
use crate::spatial::Placement;

/// Places the parts of a [`Checker`] again and again. Where other parts are attached than before, or the checker is of another robot, what
/// is kept of the one before is made anew.
#[derive(Clone, Debug)]
pub struct CheckerWorkspace {
    kinematics: ForwardKinematics<f64>,
    /// What it places.
    parts: Arc<Vec<Part>>,
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
    pub(super) fn new(checker: &Checker) -> Self {
        Self {
            kinematics: kinematics_of(checker),
            parts: Arc::clone(&checker.scene.parts),
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
        checker: &Checker,
        q: &[f64],
    ) -> Result<(&[Placement<f64>], &mut SceneRoom), KinematicsError> {
        if !Arc::ptr_eq(&self.parts, &checker.scene.parts) {
            self.parts = Arc::clone(&checker.scene.parts);
            self.kinematics = kinematics_of(checker);
        }
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

fn kinematics_of(checker: &Checker) -> ForwardKinematics<f64> {
    let frames: Vec<FrameId> = checker.scene.frames().collect();
    ForwardKinematics::of_configurations(checker.model.model(), &frames)
}
