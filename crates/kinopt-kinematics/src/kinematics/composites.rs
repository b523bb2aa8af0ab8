//! JᵀJ and Jᵀr of rows that depend on one frame each, without J.
//!
//! The rows of all frames below a node combine into one symmetric 6 × 6 matrix, like the inertia of a rigid body. One
//! sweep from the tips to the root sums these matrices and gives JᵀJ. The composite rigid body algorithm computes the
//! joint-space inertia matrix in the same way (Featherstone 2008, "Rigid Body Dynamics Algorithms", section 6.2).

use super::{Partials, Tree, TreeState};
use crate::spatial::Vector3;

/// A motion (linear, angular) or a wrench (force, moment) about one common point, in world axes.
type Spatial = [f64; 6];

/// Sums over the rows of all frames, by the node that carries the frame.
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct Composites {
    /// Σ w wᵀ over rows with derivative w by the node's motion.
    stiffness: Vec<[Spatial; 6]>,
    /// Σ w r over the same rows, with r the row's value.
    push: Vec<Spatial>,
    /// For each variable, the motion of the bodies it moves at a unit rate.
    motions: Vec<f64>,
}

impl Composites {
    /// Workspace for a tree.
    #[doc(hidden)]
    pub fn new(tree: &Tree) -> Self {
        Self {
            stiffness: vec![[[0.0; 6]; 6]; tree.nodes.len()],
            push: vec![[0.0; 6]; tree.nodes.len()],
            motions: vec![0.0; 6 * tree.variables()],
        }
    }

    /// Removes all rows.
    #[doc(hidden)]
    pub fn clear(&mut self) {
        self.stiffness.fill([[0.0; 6]; 6]);
        self.push.fill([0.0; 6]);
    }

    /// For each variable, the motion of the bodies it moves at a unit rate, six numbers each.
    #[doc(hidden)]
    pub fn motions_mut(&mut self) -> &mut [f64] {
        &mut self.motions
    }

    fn motion(&self, variable: usize) -> Spatial {
        let motion = self.motions[6 * variable..].first_chunk();
        motion.copied().unwrap_or_default()
    }
}

impl Tree {
    /// True if each variable moves at most one joint.
    #[doc(hidden)]
    pub fn has_own_variables(&self) -> bool {
        let mut seen = vec![false; self.variables()];
        let mut nodes = self.nodes.iter();
        nodes.all(|node| !std::mem::replace(&mut seen[node.variable], true))
    }

    /// Reference point of motions and wrenches: near the bodies, so that levers lose no digits.
    fn reference_point(&self, state: &TreeState<f64>) -> Vector3<f64> {
        let first = self.nodes.iter().position(|node| node.motion.turns());
        first.map_or(Vector3::zero(), |node| {
            state.origin_from_node[node].translation
        })
    }

    /// Writes the motion of each variable. Call it after a forward pass.
    #[doc(hidden)]
    pub fn write_motions(&self, state: &TreeState<f64>, composites: &mut Composites) {
        let reference_point = self.reference_point(state);
        for (node, placement) in self.nodes.iter().zip(&state.origin_from_node) {
            let axis = node.motion.world_axis(placement, &state.ball_axes) * node.ratio;
            let motion = match node.motion.turns() {
                true => spatial(axis.cross(reference_point - placement.translation), axis),
                false => spatial(axis, Vector3::zero()),
            };
            composites.motions[6 * node.variable..][..6].copy_from_slice(&motion);
        }
    }

    /// Adds the rows of one frame, with values `residual`.
    #[doc(hidden)]
    pub fn add_to_composites(
        &self,
        state: &TreeState<f64>,
        partials: &Partials<'_>,
        residual: &[f64],
        composites: &mut Composites,
    ) {
        let Some((node, position)) = self.carrier_and_position(state, partials.frame) else {
            return;
        };
        let lever = position - self.reference_point(state);
        let (stiffness, push) = (&mut composites.stiffness[node], &mut composites.push[node]);
        for (k, (force, r)) in partials.linear.iter().zip(residual).enumerate() {
            let moment = partials.angular.get(k).copied();
            let moment = moment.unwrap_or(Vector3::zero()) + lever.cross(*force);
            let w = spatial(*force, moment);
            // Skip rows without derivative, such as those of a foot in the air.
            if w == [0.0; 6] {
                continue;
            }
            for (row, factor) in stiffness.iter_mut().zip(w) {
                add_scaled(row, factor, &w);
            }
            add_scaled(push, *r, &w);
        }
    }

    /// Sweeps the rows from the tips to the root and consumes them.
    ///
    /// Calls `add(row, column, value)` for each entry of JᵀJ on and below the diagonal. Adds Jᵀr to `gradient`.
    #[doc(hidden)]
    pub fn sweep_composites(
        &self,
        composites: &mut Composites,
        gradient: &mut [f64],
        mut add: impl FnMut(usize, usize, f64),
    ) {
        for (index, node) in self.nodes.iter().enumerate().rev() {
            let motion = composites.motion(node.variable);
            let mut force = [0.0; 6];
            for (row, factor) in composites.stiffness[index].iter().zip(motion) {
                add_scaled(&mut force, factor, row);
            }
            gradient[node.variable] += dot(&motion, &composites.push[index]);
            let mut next_ancestor = Some(index);
            while let Some(ancestor) = next_ancestor {
                let Self { nodes, .. } = self;
                let variable = nodes[ancestor].variable;
                add(
                    node.variable,
                    variable,
                    dot(&composites.motion(variable), &force),
                );
                next_ancestor = nodes[ancestor].parent;
            }
            if let Some(parent) = node.parent {
                let (head, tail) = composites.stiffness.split_at_mut(index);
                for (to, from) in head[parent].iter_mut().zip(&tail[0]) {
                    add_scaled(to, 1.0, from);
                }
                let push = composites.push[index];
                add_scaled(&mut composites.push[parent], 1.0, &push);
            }
        }
    }
}

fn spatial(linear: Vector3<f64>, angular: Vector3<f64>) -> Spatial {
    let ([a, b, c], [d, e, f]) = (linear.to_array(), angular.to_array());
    [a, b, c, d, e, f]
}

#[inline(always)]
fn dot(a: &Spatial, b: &Spatial) -> f64 {
    let [x, y, z, u, v, w] = std::array::from_fn(|k| a[k] * b[k]);
    (x + u) + (y + v) + (z + w)
}

#[inline(always)]
fn add_scaled(to: &mut Spatial, factor: f64, added: &Spatial) {
    for (to, added) in to.iter_mut().zip(added) {
        *to += factor * added;
    }
}
