//! Forward kinematics: one pass from the root to the frames.

use std::ops::Range;

use super::Tree;
use super::tree::{BallNodes, Node};
use crate::scalar::Scalar;
use crate::spatial::{Placement, Vector3};

/// Workspace of one tree over one scalar: the result of the last forward pass.
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct TreeState<S> {
    /// Placement of each node, in world axes, relative to the tree's origin.
    pub(super) origin_from_node: Vec<Placement<S>>,
    /// Placement of each frame in the world, by slot.
    world_from_frame: Vec<Placement<S>>,
    /// Value of each node, radians or metres; its sine and cosine follow.
    values: Vec<S>,
    sines: Vec<S>,
    cosines: Vec<S>,
    /// For each ball joint, the rotation axis of each of its variables, in world axes.
    pub(super) ball_axes: Vec<[Vector3<S>; 3]>,
}

impl<S: Scalar> TreeState<S> {
    /// Workspace for `tree`, with identity placements.
    #[doc(hidden)]
    pub fn new(tree: &Tree) -> Self {
        Self {
            origin_from_node: vec![Placement::identity(); tree.nodes.len()],
            world_from_frame: vec![Placement::identity(); tree.leaves.len()],
            values: vec![S::zero(); tree.nodes.len()],
            sines: vec![S::zero(); tree.nodes.len()],
            cosines: vec![S::one(); tree.nodes.len()],
            ball_axes: vec![[Vector3::zero(); 3]; tree.balls.len()],
        }
    }

    /// Placement of each requested frame in the world, by slot.
    #[doc(hidden)]
    pub fn frames(&self) -> &[Placement<S>] {
        &self.world_from_frame
    }
}

impl Node {
    /// Placement of a joint at value 0; its parent must be placed.
    #[inline(always)]
    fn before_motion<S: Scalar>(&self, placed: &[Placement<S>]) -> Placement<S> {
        match self.parent {
            Some(parent) => &placed[parent] * &self.parent_from_node,
            None => &Placement::identity() * &self.parent_from_node,
        }
    }
}

impl Tree {
    /// Places a range of nodes without ball joints.
    #[inline(always)]
    fn place<S: Scalar>(&self, nodes: Range<usize>, state: &mut TreeState<S>) {
        let placed = &mut state.origin_from_node;
        let trigonometry = state.sines[nodes.clone()]
            .iter()
            .zip(&state.cosines[nodes.clone()]);
        let values = state.values[nodes.clone()].iter().zip(trigonometry);
        let moved = self.nodes[nodes.clone()].iter().zip(values);
        for (index, (node, (&q, (&sin, &cos)))) in nodes.zip(moved) {
            // origin_from_node = origin_from_parent · parent_from_node · motion(q).
            let before_motion = node.before_motion(placed);
            placed[index] = node.motion.apply(before_motion, q, (sin, cos));
        }
    }

    /// Places all nodes, ball joints included.
    #[inline(never)]
    fn place_with_balls<S: Scalar>(&self, state: &mut TreeState<S>) {
        let mut first_unplaced = 0;
        for (ball, BallNodes { last, chart }) in self.balls.iter().enumerate() {
            // origin_from_ball = origin_from_parent · parent_from_ball · rotation(x).
            let nodes = [last - 2, last - 1, *last];
            self.place(first_unplaced..nodes[0], state);
            let before_motion = self.nodes[nodes[0]].before_motion(&state.origin_from_node);
            let rotation = before_motion.rotation;
            let x = nodes.map(|node| state.values[node]);
            state.origin_from_node[nodes[0]..*last].fill(before_motion);
            state.ball_axes[ball] = chart.axes(x).map(|axis| rotation * axis);
            let rotated = rotation * chart.rotation(x).to_matrix();
            state.origin_from_node[*last] = Placement::new(rotated, before_motion.translation);
            first_unplaced = last + 1;
        }
        self.place(first_unplaced..self.nodes.len(), state);
    }

    /// Places every node and frame for the variables `x` (length: [`variables`](Self::variables)).
    #[doc(hidden)]
    pub fn forward<S: Scalar>(&self, x: &[S], state: &mut TreeState<S>) {
        for (node, value) in self.nodes.iter().zip(&mut state.values) {
            *value = x[node.variable] * S::constant(node.ratio) + S::constant(node.offset);
        }
        S::sin_cos_all(&state.values, &mut state.sines, &mut state.cosines);
        // Separate functions, so that trees without ball joints do not pay for them.
        match self.balls.is_empty() {
            true => self.place(0..self.nodes.len(), state),
            false => self.place_with_balls(state),
        }
        for (leaf, frame) in self.leaves.iter().zip(&mut state.world_from_frame) {
            match leaf.node {
                Some(node) => {
                    *frame = &state.origin_from_node[node] * &leaf.node_from_frame;
                    frame.translation += Vector3::constant(self.origin);
                }
                None => *frame = &Placement::identity() * &leaf.node_from_frame,
            }
        }
    }
}
