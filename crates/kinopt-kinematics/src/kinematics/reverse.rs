//! Reverse-mode gradient of a scalar, in one sweep from the tips to the root, without a Jacobian.
//!
//! Each frame contributes a force and a moment. Nodes sum the wrenches of the nodes they carry, and each joint reads
//! its component. The backward pass of recursive Newton-Euler works in the same way (Featherstone 2008, "Rigid Body
//! Dynamics Algorithms", section 5.3). The cost is O(joints + frames).

use super::{FrameSlot, Tree, TreeState};
use crate::spatial::Vector3;

/// A force and a moment about some point, in world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(hidden)]
pub struct Wrench {
    /// ∂cost/∂velocity.
    #[doc(hidden)]
    pub force: Vector3<f64>,
    /// ∂cost/∂angular velocity, about the frame's origin.
    #[doc(hidden)]
    pub moment: Vector3<f64>,
}

impl Wrench {
    /// No force and no moment.
    pub(crate) fn zero() -> Self {
        Self {
            force: Vector3::zero(),
            moment: Vector3::zero(),
        }
    }

    /// The wrench about another point; `lever` is the old point relative to the new one.
    fn shifted(self, lever: Vector3<f64>) -> Self {
        Self {
            force: self.force,
            moment: self.moment + lever.cross(self.force),
        }
    }
}

/// Workspace of a reverse sweep: the wrench on each node, about the node's origin.
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct Wrenches {
    on_node: Vec<Wrench>,
}

impl Wrenches {
    /// Workspace for `tree`, all zero.
    #[doc(hidden)]
    pub fn new(tree: &Tree) -> Self {
        Self {
            on_node: vec![Wrench::zero(); tree.nodes.len()],
        }
    }

    /// Sets all wrenches to zero.
    #[doc(hidden)]
    pub fn clear(&mut self) {
        self.on_node.fill(Wrench::zero());
    }
}

impl Tree {
    /// Adds a wrench on a frame; `wrench` is about the frame's origin.
    #[doc(hidden)]
    pub fn push(
        &self,
        state: &TreeState<f64>,
        slot: FrameSlot,
        wrench: Wrench,
        wrenches: &mut Wrenches,
    ) {
        if let Some((node, position)) = self.carrier_and_position(state, slot) {
            let lever = position - state.origin_from_node[node].translation;
            let moved = wrench.shifted(lever);
            wrenches.on_node[node].force += moved.force;
            wrenches.on_node[node].moment += moved.moment;
        }
    }

    /// Sweeps the wrenches to the root, adds each joint's component to `gradient`, and consumes the wrenches.
    ///
    /// `gradient` has the length [`variables`](Self::variables).
    #[doc(hidden)]
    pub fn sweep(&self, state: &TreeState<f64>, wrenches: &mut Wrenches, gradient: &mut [f64]) {
        self.sweep_by(state, wrenches, |variable, share| {
            gradient[variable] += share;
        });
    }

    /// Does the same as [`sweep`](Self::sweep), but calls `add(variable, component)` for each joint.
    #[doc(hidden)]
    pub fn sweep_by(
        &self,
        state: &TreeState<f64>,
        wrenches: &mut Wrenches,
        mut add: impl FnMut(usize, f64),
    ) {
        for (index, node) in self.nodes.iter().enumerate().rev() {
            let origin_from_node = &state.origin_from_node[index];
            let carried = wrenches.on_node[index];
            let axis = node.motion.world_axis(origin_from_node, &state.ball_axes);
            let share = if node.motion.turns() {
                axis.dot(carried.moment)
            } else {
                axis.dot(carried.force)
            };
            add(node.variable, share * node.ratio);
            if let Some(parent) = node.parent {
                let origin_from_parent = &state.origin_from_node[parent];
                let lever = origin_from_node.translation - origin_from_parent.translation;
                let moved = carried.shifted(lever);
                wrenches.on_node[parent].force += moved.force;
                wrenches.on_node[parent].moment += moved.moment;
            }
        }
    }
}
