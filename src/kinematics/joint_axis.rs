//! The joints of a tree one by one, for methods that turn them in turn.

use super::{FrameSlot, Tree, TreeState};
use crate::spatial::Vector3;

/// A moving joint where the last forward pass left it, in world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct JointAxis {
    /// Turning, rather than sliding.
    pub(crate) turns: bool,
    /// Of unit length.
    pub(crate) direction: Vector3<f64>,
    /// The joint's own origin, a point of a turning joint's axis.
    pub(crate) origin: Vector3<f64>,
}

impl Tree {
    /// How many moving joints there are. They are numbered parents first.
    pub(crate) fn joints(&self) -> usize {
        self.nodes.len()
    }

    /// The moving joint that carries this one.
    pub(crate) fn joint_above(&self, joint: usize) -> Option<usize> {
        self.nodes[joint].parent
    }

    /// The moving joint that carries a frame.
    pub(crate) fn joint_carrying(&self, slot: FrameSlot) -> Option<usize> {
        self.leaves[slot].node
    }

    /// The variable that moves a joint, and by how much of its own unit for one of the variable's.
    pub(crate) fn variable_of(&self, joint: usize) -> (usize, f64) {
        (self.nodes[joint].variable, self.nodes[joint].ratio)
    }

    /// Whether a joint turns, rather than slides.
    pub(crate) fn turns(&self, joint: usize) -> bool {
        self.nodes[joint].motion.turns()
    }

    /// The axis of a joint.
    pub(crate) fn axis(&self, state: &TreeState<f64>, joint: usize) -> JointAxis {
        let origin_from_node = &state.origin_from_node[joint];
        let motion = &self.nodes[joint].motion;
        JointAxis {
            turns: motion.turns(),
            direction: motion.world_axis(origin_from_node, &state.ball_axes),
            origin: self.origin + origin_from_node.translation,
        }
    }

    /// The joint that a frame hangs on, and the frame's own place seen from the tree's origin: the world's would lose
    /// digits of levers. Few frames are asked for it, so that it is not kept for all.
    #[inline(always)]
    pub(super) fn hung(
        &self,
        state: &TreeState<f64>,
        slot: FrameSlot,
    ) -> Option<(usize, Vector3<f64>)> {
        let leaf = &self.leaves[slot];
        leaf.node.map(|node| {
            (
                node,
                (&state.origin_from_node[node] * &leaf.node_from_frame).translation,
            )
        })
    }

    /// A point that a joint carries, from the joint's coordinates to the world's.
    pub(crate) fn carried(
        &self,
        state: &TreeState<f64>,
        joint: usize,
        local: Vector3<f64>,
    ) -> Vector3<f64> {
        self.origin + state.origin_from_node[joint].apply(local)
    }

    /// The same from the world's coordinates to the joint's.
    pub(crate) fn local_to(
        &self,
        state: &TreeState<f64>,
        joint: usize,
        world: Vector3<f64>,
    ) -> Vector3<f64> {
        let seen = world - self.origin;
        state.origin_from_node[joint].inverse().apply(seen)
    }
}
