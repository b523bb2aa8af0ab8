//! Reverse mode: the gradient of a scalar without its Jacobian, in one sweep from tips to root.
//!
//! Each frame pushes with a force and a moment; bones add up what they carry, and every joint reads
//! its own component off, as in the backward pass of recursive Newton-Euler (Featherstone 2008,
//! "Rigid Body Dynamics Algorithms", section 5.3). O(joints + frames).

use super::{FrameSlot, Tree, TreeState};
use crate::spatial::Vector3;

/// A force and the moment about some point, in world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Wrench {
    /// ∂cost/∂velocity.
    pub(crate) force: Vector3<f64>,
    /// ∂cost/∂angular velocity, about the frame's own origin.
    pub(crate) moment: Vector3<f64>,
}

impl Wrench {
    /// No force, no moment.
    pub(crate) fn zero() -> Self {
        Self {
            force: Vector3::zero(),
            moment: Vector3::zero(),
        }
    }

    /// The same wrench about a point from which the old one is seen at `lever`.
    fn shifted(self, lever: Vector3<f64>) -> Self {
        Self {
            force: self.force,
            moment: self.moment + lever.cross(self.force),
        }
    }
}

/// Scratch memory of a reverse sweep: the wrench each node carries, about its own origin.
#[derive(Clone, Debug)]
pub(crate) struct Wrenches {
    on_node: Vec<Wrench>,
}

impl Wrenches {
    /// Memory for `tree`, all zero.
    pub(crate) fn new(tree: &Tree) -> Self {
        Self {
            on_node: vec![Wrench::zero(); tree.nodes.len()],
        }
    }

    /// Forgets every push.
    pub(crate) fn clear(&mut self) {
        self.on_node.fill(Wrench::zero());
    }
}

impl Tree {
    /// Pushes on a frame; `wrench` is about the frame's origin.
    pub(crate) fn push(
        &self,
        state: &TreeState<f64>,
        slot: FrameSlot,
        wrench: Wrench,
        wrenches: &mut Wrenches,
    ) {
        if let Some((node, at)) = self.hung(state, slot) {
            let lever = at - state.origin_from_node[node].translation;
            let moved = wrench.shifted(lever);
            wrenches.on_node[node].force += moved.force;
            wrenches.on_node[node].moment += moved.moment;
        }
    }

    /// Sweeps the pushes down to the root and adds each joint's share to `gradient` (shape:
    /// [`variables`](Self::variables)). The pushes are used up.
    pub(crate) fn sweep(
        &self,
        state: &TreeState<f64>,
        wrenches: &mut Wrenches,
        gradient: &mut [f64],
    ) {
        self.sweep_by(state, wrenches, |variable, share| {
            gradient[variable] += share;
        });
    }

    /// As [`sweep`](Self::sweep), with each variable's share handed to `add`.
    pub(crate) fn sweep_by(
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
                let above = &state.origin_from_node[parent];
                let lever = origin_from_node.translation - above.translation;
                let moved = carried.shifted(lever);
                wrenches.on_node[parent].force += moved.force;
                wrenches.on_node[parent].moment += moved.moment;
            }
        }
    }
}
