//! The analytic Jacobian: each ancestor joint adds its twist, nothing else is touched.
//!
//! Column of a revolute joint with world axis z at p, for a frame at x: (z × (x − p), z); of a
//! prismatic joint: (z, 0). Linear part first, then angular, in world axes at the frame's origin
//! (Siciliano et al. 2009, "Robotics", eq. 3.30).

use nalgebra::DMatrix;

use super::{FrameSlot, Tree, TreeState};
use crate::spatial::Vector3;

/// The derivative of some residual rows by the twist of one frame.
///
/// `linear[k]` and `angular[k]` are the derivatives of row `first_row + k` by the frame's velocity
/// (per metre) and angular velocity (per radian), in world axes at the frame's origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Partials<'a> {
    /// Which frame moves.
    pub(crate) frame: FrameSlot,
    /// The residual row of the first entry.
    pub(crate) first_row: usize,
    /// ∂row/∂velocity, one per row.
    pub(crate) linear: &'a [Vector3<f64>],
    /// ∂row/∂angular velocity, one per row; empty where the rows do not feel rotation.
    pub(crate) angular: &'a [Vector3<f64>],
}

impl Tree {
    /// Adds the derivatives of the rows in `partials` by all variables to `jacobian` (shape: rows
    /// × [`variables`](Self::variables)), after a forward pass at the same x.
    pub(crate) fn add_geometric_jacobian(
        &self,
        state: &TreeState<f64>,
        partials: &Partials<'_>,
        jacobian: &mut DMatrix<f64>,
    ) {
        let rows = jacobian.nrows();
        let entries = jacobian.as_mut_slice();
        let Some((last, at)) = self.hung(state, partials.frame) else {
            return;
        };
        let mut next = Some(last);
        while let Some(index) = next {
            let node = &self.nodes[index];
            let origin_from_node = &state.origin_from_node[index];
            let axis = node.motion.world_axis(origin_from_node, &state.ball_axes) * node.ratio;
            let (linear, angular) = if node.motion.turns() {
                (axis.cross(at - origin_from_node.translation), axis)
            } else {
                (axis, Vector3::zero())
            };
            let start = node.variable * rows + partials.first_row;
            let column = &mut entries[start..start + partials.linear.len()];
            match (partials.linear, partials.angular, column) {
                // The most common shape, without a loop.
                ([by_x, by_y, by_z], [], [x, y, z]) => {
                    *x += by_x.dot(linear);
                    *y += by_y.dot(linear);
                    *z += by_z.dot(linear);
                }
                (by_linear, [], column) => {
                    for (entry, by_linear) in column.iter_mut().zip(by_linear) {
                        *entry += by_linear.dot(linear);
                    }
                }
                (by_linear, by_angular, column) => {
                    let pairs = by_linear.iter().zip(by_angular);
                    for (entry, (by_linear, by_angular)) in column.iter_mut().zip(pairs) {
                        *entry += by_linear.dot(linear) + by_angular.dot(angular);
                    }
                }
            }
            next = node.parent;
        }
    }
}
