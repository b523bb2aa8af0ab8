//! Joint jumps in JSON and text.

use kinopt::ik::JointJump;
use serde::Serialize;

use crate::number_format::six_digits;

/// Joint jump with the name of its joint.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct JumpDocument {
    /// Index of the row or target at the end of the step, from 0.
    index: usize,
    /// Joint with the largest displacement.
    joint: String,
    /// Displacement in radians; of a prismatic joint, weighted metres.
    distance: f64,
    /// True for a jump to another branch; false if smaller steps also lead there.
    reconfiguration: bool,
}

impl JumpDocument {
    /// Document of a jump of a model or an arm with these joints.
    pub(crate) fn of(jump: &JointJump, joints: &[&str]) -> Self {
        let joint = joints.get(jump.joint).copied().unwrap_or_default();
        Self {
            index: jump.index,
            joint: joint.to_owned(),
            distance: jump.distance,
            reconfiguration: jump.reconfiguration,
        }
    }

    /// Line of text.
    pub(crate) fn text(&self) -> String {
        let kind = match self.reconfiguration {
            true => "a reconfiguration: the branch ends there",
            false => "continuous: a fast motion or a coarse path",
        };
        let (index, joint, distance) = (self.index, &self.joint, six_digits(self.distance));
        format!("step {index}: `{joint}` moves by {distance} rad, {kind}")
    }
}
