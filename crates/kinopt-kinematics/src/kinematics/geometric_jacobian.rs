//! The geometric Jacobian of a frame, from the twists of the joints that carry it.
//!
//! The column of a revolute joint with world axis z at p, for a frame at x, is (z × (x − p), z). The column of a
//! prismatic joint is (z, 0). The linear part comes first, then the angular part, in world axes at the frame's origin
//! (Siciliano et al. 2009, "Robotics", eq. 3.30).

use nalgebra::DMatrix;

use super::{FrameSlot, Tree, TreeState};
use crate::spatial::Vector3;

/// The derivatives of some residual rows by the twist of one frame.
///
/// `linear[k]` is the derivative of row `first_row + k` by the frame's velocity (per metre), `angular[k]` by its
/// angular velocity (per radian). Both are in world axes at the frame's origin.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct Partials<'a> {
    /// The frame.
    #[doc(hidden)]
    pub frame: FrameSlot,
    /// The residual row of the first entry.
    #[doc(hidden)]
    pub first_row: usize,
    /// ∂row/∂velocity, one per row.
    #[doc(hidden)]
    pub linear: &'a [Vector3<f64>],
    /// ∂row/∂angular velocity, one per row; empty if the rows do not depend on rotation.
    #[doc(hidden)]
    pub angular: &'a [Vector3<f64>],
}

impl Tree {
    /// Adds the derivatives of the rows in `partials` by all variables to `jacobian`.
    ///
    /// `jacobian` has a column for each of the [`variables`](Self::variables). Call it after a forward pass at the same
    /// x.
    #[doc(hidden)]
    pub fn add_geometric_jacobian(
        &self,
        state: &TreeState<f64>,
        partials: &Partials<'_>,
        jacobian: &mut DMatrix<f64>,
    ) {
        let rows = jacobian.nrows();
        let entries = jacobian.as_mut_slice();
        let column_range = |variable: usize| {
            let start = variable * rows + partials.first_row;
            start..start + partials.linear.len()
        };
        // One branch per shape outside the loop over ancestors.
        match (partials.linear, partials.angular) {
            // The most common shape, unrolled.
            (&[by_x, by_y, by_z], []) => {
                self.visit_twists(state, partials.frame, |variable, linear, _| {
                    if let [x, y, z] = &mut entries[column_range(variable)] {
                        *x += by_x.dot(linear);
                        *y += by_y.dot(linear);
                        *z += by_z.dot(linear);
                    }
                });
            }
            (by_linear, []) => {
                self.visit_twists(state, partials.frame, |variable, linear, _| {
                    for (entry, by_linear) in
                        entries[column_range(variable)].iter_mut().zip(by_linear)
                    {
                        *entry += by_linear.dot(linear);
                    }
                });
            }
            (by_linear, by_angular) => {
                self.visit_twists(state, partials.frame, |variable, linear, angular| {
                    let pairs = by_linear.iter().zip(by_angular);
                    for (entry, (by_linear, by_angular)) in
                        entries[column_range(variable)].iter_mut().zip(pairs)
                    {
                        *entry += by_linear.dot(linear) + by_angular.dot(angular);
                    }
                });
            }
        }
    }

    /// Visits each joint that carries a frame.
    ///
    /// The closure gets the joint's variable and the frame's velocity and angular velocity for a unit rate of the
    /// variable.
    #[inline(always)]
    fn visit_twists(
        &self,
        state: &TreeState<f64>,
        frame: FrameSlot,
        mut visit: impl FnMut(usize, Vector3<f64>, Vector3<f64>),
    ) {
        let Some((last, position)) = self.carrier_and_position(state, frame) else {
            return;
        };
        let mut next = Some(last);
        while let Some(index) = next {
            let node = &self.nodes[index];
            let origin_from_node = &state.origin_from_node[index];
            let axis = node.motion.world_axis(origin_from_node, &state.ball_axes) * node.ratio;
            match node.motion.turns() {
                true => {
                    let lever = position - origin_from_node.translation;
                    visit(node.variable, axis.cross(lever), axis);
                }
                false => visit(node.variable, axis, Vector3::zero()),
            }
            next = node.parent;
        }
    }
}
