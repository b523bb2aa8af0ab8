//! The points where a problem's joints turn, and which joints bring which points where.
//!
//! A joint stands at a point. Where its axis runs through the next points as well (a bone's twist
//! about itself, the turning base of a robot), it moves only what is beyond: it then serves
//! together with the joints there. So the last twist of an upper arm and the bend of a forearm, or
//! the joints 3 and 4 of a seven-joint arm, point the forearm together.

use super::linkage::{Linkage, Pin};
use crate::spatial::Vector3;

/// A point that a joint carries, or that is fixed in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Carried {
    /// The joint whose motion it follows; `None` for the world.
    pub(super) joint: Option<usize>,
    /// In that joint's coordinates, or the world's.
    pub(super) local: Vector3<f64>,
}

/// Joints, from the base out, that bring the same points where they should be.
#[derive(Clone, Debug, Default)]
pub(super) struct Group {
    pub(super) joints: Vec<usize>,
    pub(super) serves: Vec<usize>,
    /// The point that the joints turn about, where that is not the parent of what they serve.
    pub(super) about: Option<usize>,
}

/// A problem's joints as points.
#[derive(Clone, Debug)]
pub(super) struct JointPoints {
    pub(super) points: Vec<Carried>,
    pub(super) groups: Vec<Group>,
    /// Points nearer than this are one.
    pub(super) same: f64,
    pub(super) parents: Vec<Option<usize>>,
    pub(super) rest: Vec<Vector3<f64>>,
    pub(super) pins: Vec<Pin>,
}

impl JointPoints {
    getters! {
        /// Which points should be where.
        pub(super) fn pins(&self) -> &[Pin] = &self.pins;
        /// Where the points are with all variables next to zero.
        pub(super) fn rest(&self) -> &[Vector3<f64>] = &self.rest;
        /// The points with their distances.
        pub(super) fn linkage(&self) -> Linkage = Linkage::new(self.parents.clone(), &self.rest);
    }
}
