//! Points at a problem's joints, and the joints that position them.
//!
//! A joint whose axis passes through the next points moves only the points beyond them. Examples are the twist of a
//! bone and the rotating base of a robot. Such a joint is grouped with the joints at the next point. So the twist of an
//! upper arm and the bend of a forearm together point the forearm. Joints 3 and 4 of a seven-joint arm do the same.

use super::linkage::{Linkage, Pin};
use kinopt_kinematics::spatial::Vector3;

/// A point that a joint carries, or that is fixed in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct AttachedPoint {
    /// The joint that carries it; `None` for the world.
    pub(super) joint: Option<usize>,
    /// Position in that joint's coordinates, or in the world.
    pub(super) local: Vector3<f64>,
}

/// Joints, from the base outwards, that position the same points.
#[derive(Clone, Debug, Default)]
pub(super) struct JointGroup {
    pub(super) joints: Vec<usize>,
    pub(super) points: Vec<usize>,
    /// The point about which the joints rotate, if it is not the parent of the points they position.
    pub(super) centre: Option<usize>,
}

/// A problem's joints as points.
#[derive(Clone, Debug)]
pub(super) struct JointPoints {
    pub(super) points: Vec<AttachedPoint>,
    pub(super) groups: Vec<JointGroup>,
    /// Distance below which points coincide.
    pub(super) tolerance: f64,
    pub(super) parents: Vec<Option<usize>>,
    pub(super) rest: Vec<Vector3<f64>>,
    pub(super) pins: Vec<Pin>,
}

impl JointPoints {
    /// The points with targets.
    #[must_use]
    pub(super) fn pins(&self) -> &[Pin] {
        &self.pins
    }

    /// Positions of the points with all variables as close to zero as their bounds allow.
    #[must_use]
    pub(super) fn rest(&self) -> &[Vector3<f64>] {
        &self.rest
    }

    /// The points with their distances.
    #[must_use]
    pub(super) fn linkage(&self) -> Linkage {
        Linkage::new(self.parents.clone(), &self.rest)
    }
}
