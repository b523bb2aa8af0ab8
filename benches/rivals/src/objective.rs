//! Pose error as one smooth function, for optimisers without kinematics.

use kinopt::simd_ik::{Chain, JointKind};
use kinopt::spatial::{Matrix3, Placement, Vector3};

use crate::TOLERANCE;

/// w², in square metres per square radian: the weight of kinopt; other values measured slower for most solvers.
const SQUARED_WEIGHT: f64 = 0.3 * 0.3;

/// Largest number of joints of a chain: all memory is on the stack.
const MAX_JOINTS: usize = 32;

/// `½(|p|² + w² θ²)` of the error at the tip, metres and radians, with its gradient in reverse mode.
///
/// θ² is 2(1 − cos θ), the squared chord: half the sum of the squared differences of the rotations' columns, without
/// cancellation near the target.
#[derive(Clone)]
pub struct Objective<'a> {
    chain: &'a Chain,
    target: Placement<f64>,
}

impl<'a> Objective<'a> {
    /// Value below which both errors are within the tolerances.
    pub const GOAL: f64 = 0.5 * TOLERANCE * TOLERANCE * SQUARED_WEIGHT.min(1.0);

    /// Creates the objective of a chain of at most 32 joints.
    #[must_use]
    pub fn new(chain: &'a Chain, target: Placement<f64>) -> Self {
        assert!(chain.joints().len() <= MAX_JOINTS);
        Self { chain, target }
    }

    /// Value at `q`, and the gradient if requested.
    pub fn at(&self, q: &[f64], gradient: Option<&mut [f64]>) -> f64 {
        let mut axes = [Vector3::zero(); MAX_JOINTS];
        let mut origins = [Vector3::zero(); MAX_JOINTS];
        let mut placement = Placement::identity();
        for (i, (joint, &q)) in self.chain.joints().iter().zip(q).enumerate() {
            placement = placement * joint.parent_from_joint;
            axes[i] = placement.rotation * joint.axis;
            origins[i] = placement.translation;
            match joint.kind {
                JointKind::Prismatic => placement.translation += axes[i] * q,
                _ if joint.axis == Vector3::new(0.0, 0.0, 1.0) => {
                    placement.rotation = placement.rotation.rotated_about_z(q.sin_cos());
                }
                _ => {
                    placement.rotation =
                        placement.rotation * Matrix3::rotation(joint.axis, q.sin_cos());
                }
            }
        }
        let tip = placement * *self.chain.joint_from_tip();
        let position_error = tip.translation - self.target.translation;
        let (r, t) = (tip.rotation, self.target.rotation);
        let chord =
            (r.x - t.x).norm_squared() + (r.y - t.y).norm_squared() + (r.z - t.z).norm_squared();
        if let Some(gradient) = gradient {
            let moment =
                (r.x.cross(t.x) + r.y.cross(t.y) + r.z.cross(t.z)) * (-0.5 * SQUARED_WEIGHT);
            for (i, joint) in self.chain.joints().iter().enumerate() {
                gradient[i] = match joint.kind {
                    JointKind::Prismatic => axes[i].dot(position_error),
                    _ => axes[i].dot((tip.translation - origins[i]).cross(position_error) + moment),
                };
            }
        }
        0.5 * (position_error.norm_squared() + 0.5 * SQUARED_WEIGHT * chord)
    }
}
