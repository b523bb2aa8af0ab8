//! The way through the tree from one frame, or the world, to another.

use super::{FrameId, JointId, Model};

/// The joints from a base to a frame, without those that both stand on.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Path {
    /// From the base up to the common ancestor.
    pub(crate) up: Vec<JointId>,
    /// From the common ancestor down to the tip.
    pub(crate) down: Vec<JointId>,
}

impl Model {
    /// The way from `base` (none: the world) up to the common ancestor and down to `tip`.
    pub(crate) fn path(&self, base: Option<FrameId>, tip: FrameId) -> Path {
        let mut up = base.map_or_else(Vec::new, |base| self.joints_down_to(base));
        let mut down = self.joints_down_to(tip);
        let shared = up.iter().zip(&down).take_while(|(a, b)| a == b).count();
        up.drain(..shared);
        up.reverse();
        down.drain(..shared);
        Path { up, down }
    }

    /// The joints from the root to a frame.
    fn joints_down_to(&self, frame: FrameId) -> Vec<JointId> {
        let first = self.frames[frame.index()].joint;
        let parent = |joint: &JointId| self.joints[joint.index()].parent;
        let mut joints: Vec<JointId> = std::iter::successors(first, parent).collect();
        joints.reverse();
        joints
    }
}
