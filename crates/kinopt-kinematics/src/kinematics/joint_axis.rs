//! Access to the joints of a tree one by one, for methods that move one joint at a time.

use super::{FrameSlot, Tree, TreeState};
use crate::spatial::Vector3;

/// The axis of a moving joint after the last forward pass, in world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(hidden)]
pub struct JointAxis {
    /// True if the joint rotates, false if it translates.
    #[doc(hidden)]
    pub turns: bool,
    /// Direction of the axis, of unit length.
    #[doc(hidden)]
    pub direction: Vector3<f64>,
    /// Origin of the joint; for a rotating joint, a point on its axis.
    #[doc(hidden)]
    pub origin: Vector3<f64>,
}

impl Tree {
    /// Number of moving joints, which are indexed parents first.
    #[doc(hidden)]
    pub fn joints(&self) -> usize {
        self.nodes.len()
    }

    /// The moving joint that carries this one.
    #[doc(hidden)]
    pub fn joint_above(&self, joint: usize) -> Option<usize> {
        self.nodes[joint].parent
    }

    /// The moving joint that carries a frame.
    #[doc(hidden)]
    pub fn joint_carrying(&self, slot: FrameSlot) -> Option<usize> {
        self.leaves[slot].node
    }

    /// The variable that moves a joint, and the joint's ratio: joint units per variable unit.
    #[doc(hidden)]
    pub fn variable_of(&self, joint: usize) -> (usize, f64) {
        (self.nodes[joint].variable, self.nodes[joint].ratio)
    }

    /// True if the joint rotates, false if it translates.
    #[doc(hidden)]
    pub fn turns(&self, joint: usize) -> bool {
        self.nodes[joint].motion.turns()
    }

    /// The axis of a joint.
    #[doc(hidden)]
    pub fn axis(&self, state: &TreeState<f64>, joint: usize) -> JointAxis {
        let origin_from_node = &state.origin_from_node[joint];
        let motion = &self.nodes[joint].motion;
        JointAxis {
            turns: motion.turns(),
            direction: motion.world_axis(origin_from_node, &state.ball_axes),
            origin: self.origin + origin_from_node.translation,
        }
    }

    /// The node that carries a frame, and the frame's position relative to the tree's origin.
    ///
    /// A position relative to the world's origin would lose digits of levers. Computed on demand because few frames
    /// need it.
    #[inline(always)]
    pub(super) fn carrier_and_position(
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

    /// A point fixed to a joint, from joint coordinates to world coordinates.
    #[doc(hidden)]
    pub fn carried(
        &self,
        state: &TreeState<f64>,
        joint: usize,
        local: Vector3<f64>,
    ) -> Vector3<f64> {
        self.origin + state.origin_from_node[joint].apply(local)
    }

    /// A point fixed to a joint, from world coordinates to joint coordinates.
    #[doc(hidden)]
    pub fn local_to(
        &self,
        state: &TreeState<f64>,
        joint: usize,
        world: Vector3<f64>,
    ) -> Vector3<f64> {
        let relative = world - self.origin;
        state.origin_from_node[joint].inverse().apply(relative)
    }
}
