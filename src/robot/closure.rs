//! Loops of a robot that its tree of joints leaves open.

use super::Robot;
use crate::model::FrameId;
use crate::spatial::Placement;

/// Two places on a robot that its file holds together. No joint knows of it: a configuration may leave it open.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Closure {
    /// Its name, which few have.
    pub name: Option<String>,
    /// What is held together.
    pub kind: ClosureKind,
    /// The frames that the places are on.
    pub frames: [FrameId; 2],
    /// Where on them: what is to fall together.
    pub frame_from_place: [Placement<f64>; 2],
}

/// What two places have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ClosureKind {
    /// Their origins, as by a ball joint.
    Connect,
    /// Origins and axes.
    Weld,
}

impl Robot {
    getters! {
        /// The loops that the robot's file closes (MJCF: `connect` and `weld` that are active); none for other files.
        pub fn closures(&self) -> &[Closure] = &self.closures;
    }
}
