//! Scratch memory for checks.

use std::sync::Arc;

use super::Checker;
use super::continuous_check::{MonitoredItem, NearPair, SlidingPair};
use super::motion_bound::BoundWorkspace;
use super::parts::Part;
use super::scene_placements::SceneWorkspace;
use kinopt_kinematics::kinematics::{ForwardKinematics, KinematicsError};
use kinopt_kinematics::model::FrameId;
use kinopt_kinematics::spatial::Placement;

/// Scratch memory for the checks of a [`Checker`].
///
/// Some of it is rebuilt when it is used with another robot or other attached obstacles.
#[derive(Clone, Debug)]
pub struct CheckerWorkspace {
    kinematics: ForwardKinematics<f64>,
    /// Parts whose frames `kinematics` computes.
    parts: Arc<Vec<Part>>,
    scene: SceneWorkspace,
    pub(super) bound: BoundWorkspace,
    /// A configuration in a motion, and the pairs monitored there.
    pub(super) configuration: Vec<f64>,
    pub(super) monitored_items: Vec<MonitoredItem>,
    /// Initial contacts of a motion.
    pub(super) contacts: Vec<NearPair>,
    /// Sliding pairs by the index of their monitor, and the configuration at which they are tested.
    pub(super) sliding_pairs: Vec<(usize, SlidingPair)>,
    pub(super) sliding_configuration: Vec<f64>,
}

impl CheckerWorkspace {
    pub(super) fn new(checker: &Checker) -> Self {
        Self {
            kinematics: kinematics_of(checker),
            parts: Arc::clone(&checker.scene.parts),
            scene: SceneWorkspace::default(),
            bound: BoundWorkspace::default(),
            configuration: Vec::new(),
            monitored_items: Vec::new(),
            contacts: Vec::new(),
            sliding_pairs: Vec::new(),
            sliding_configuration: Vec::new(),
        }
    }

    /// World placements of the parts at a configuration, and the workspace for a visit.
    pub(super) fn place(
        &mut self,
        checker: &Checker,
        q: &[f64],
    ) -> Result<(&[Placement<f64>], &mut SceneWorkspace), KinematicsError> {
        if !Arc::ptr_eq(&self.parts, &checker.scene.parts) {
            self.parts = Arc::clone(&checker.scene.parts);
            self.kinematics = kinematics_of(checker);
        }
        Ok((self.kinematics.place(q)?, &mut self.scene))
    }

    /// As [`place`](Self::place) within a motion whose bound is computed.
    pub(super) fn place_in_motion(
        &mut self,
        q: &[f64],
    ) -> Result<(&[Placement<f64>], &mut SceneWorkspace, &BoundWorkspace), KinematicsError> {
        Ok((self.kinematics.place(q)?, &mut self.scene, &self.bound))
    }
}

fn kinematics_of(checker: &Checker) -> ForwardKinematics<f64> {
    let frames: Vec<FrameId> = checker.scene.frames().collect();
    ForwardKinematics::of_configurations(checker.model.model(), &frames)
}
