//! Path through the joint tree from one frame, or the world, to another.

use super::{FrameId, JointId, Model};

/// The joints between two frames, without the common ancestors.
#[derive(Clone, Debug, PartialEq)]
#[doc(hidden)]
pub struct Path {
    /// From the base up to the common ancestor, excluded.
    #[doc(hidden)]
    pub up: Vec<JointId>,
    /// From the common ancestor, excluded, down to the tip.
    #[doc(hidden)]
    pub down: Vec<JointId>,
}

impl Model {
    /// The path from `base` (`None`: the world) up to the common ancestor and down to `tip`.
    #[doc(hidden)]
    pub fn path(&self, base: Option<FrameId>, tip: FrameId) -> Path {
        let mut up = base.map_or_else(Vec::new, |base| self.joints_down_to(base));
        let mut down = self.joints_down_to(tip);
        let shared = up.iter().zip(&down).take_while(|(a, b)| a == b).count();
        up.drain(..shared);
        up.reverse();
        down.drain(..shared);
        Path { up, down }
    }

    /// The joints that carry a frame, from its joint up to the root; none for a frame that is not in the model.
    pub fn joints_above(&self, frame: FrameId) -> impl Iterator<Item = JointId> + '_ {
        let first = self.frames.get(frame.index()).and_then(|f| f.joint);
        std::iter::successors(first, |joint| self.joints[joint.index()].parent)
    }

    /// The joints from the root to a frame.
    fn joints_down_to(&self, frame: FrameId) -> Vec<JointId> {
        let mut joints: Vec<JointId> = self.joints_above(frame).collect();
        joints.reverse();
        joints
    }
}
