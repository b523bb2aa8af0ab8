//! Forward kinematics: one pass from the root to the frames.

use super::{FrameSlot, Tree};
use crate::scalar::Scalar;
use crate::spatial::Placement;

/// Scratch memory of one tree over one scalar: what the last forward pass found.
#[derive(Clone, Debug)]
pub struct TreeState<S> {
    pub(super) world_from_node: Vec<Placement<S>>,
    world_from_frame: Vec<Placement<S>>,
    values: Vec<(S, (S, S))>,
}

impl<S: Scalar> TreeState<S> {
    /// Memory for `tree`, as if every placement were the identity.
    #[must_use]
    pub fn new(tree: &Tree) -> Self {
        let still = (S::zero(), (S::zero(), S::one()));
        Self {
            world_from_node: vec![Placement::identity(); tree.nodes.len()],
            world_from_frame: vec![Placement::identity(); tree.leaves.len()],
            values: vec![still; tree.nodes.len()],
        }
    }

    /// Where each requested frame stands in the world, by slot.
    #[must_use]
    pub fn frames(&self) -> &[Placement<S>] {
        &self.world_from_frame
    }

    /// Where one requested frame stands in the world.
    #[must_use]
    pub fn frame(&self, slot: FrameSlot) -> Option<&Placement<S>> {
        self.world_from_frame.get(slot)
    }
}

impl Tree {
    /// Places every node and frame for the variables `x` (shape: [`variables`](Self::variables)).
    pub fn forward<S: Scalar>(&self, x: &[S], state: &mut TreeState<S>) {
        // Sines first: a loop of its own pipelines better than sines between matrix products.
        for (node, value) in self.nodes.iter().zip(&mut state.values) {
            let q = x[node.variable] * S::constant(node.ratio) + S::constant(node.offset);
            value.0 = q;
            if node.motion.turns() {
                value.1 = q.sin_cos();
            }
        }
        for (index, (node, &(q, trigonometry))) in self.nodes.iter().zip(&state.values).enumerate()
        {
            let placed = match node.parent {
                Some(parent) => node.parent_from_node.after(&state.world_from_node[parent]),
                None => node.parent_from_node.after(&Placement::identity()),
            };
            state.world_from_node[index] = node.motion.apply(placed, q, trigonometry);
        }
        for (leaf, frame) in self.leaves.iter().zip(&mut state.world_from_frame) {
            *frame = match leaf.node {
                Some(node) => leaf.node_from_frame.after(&state.world_from_node[node]),
                None => leaf.node_from_frame.after(&Placement::identity()),
            };
        }
    }
}
