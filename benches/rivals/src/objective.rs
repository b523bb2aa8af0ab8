//! The pose error as one smooth function, for optimisers that bring no kinematics.

use kinopt::lanes::{Chain, JointKind};
use kinopt::spatial::{Matrix3, Placement, Vector3};

use crate::TOLERANCE;

/// w², in square metres per square radian: kinopt's own weight. With 1 the medians of L-BFGS and PANOC
/// were 20 to 65 % higher on both arms, those of SLSQP 8 % lower on one and 15 % higher on the other.
const SQUARED_WEIGHT: f64 = 0.3 * 0.3;

/// Chains up to this length: all memory is on the stack.
const MOST_JOINTS: usize = 32;

/// `½(|p|² + w² θ²)` of the error at the tip, metres and radians, with its gradient in reverse mode.
///
/// θ² stands for 2(1 − cos θ), the squared chord, which is the sum of the squared differences of the
/// rotation's columns, halved: no cancellation near the target.
#[derive(Clone)]
pub struct Objective<'a> {
    chain: &'a Chain,
    target: Placement<f64>,
}

impl<'a> Objective<'a> {
    /// The value at which both errors are surely within the tolerances.
    pub const GOAL: f64 = 0.5 * TOLERANCE * TOLERANCE * SQUARED_WEIGHT.min(1.0);

    /// For a chain of at most 32 joints.
    #[must_use]
    pub fn new(chain: &'a Chain, target: Placement<f64>) -> Self {
        assert!(chain.joints().len() <= MOST_JOINTS);
        Self { chain, target }
    }

    /// The value at `q`, and the gradient where asked.
    pub fn at(&self, q: &[f64], gradient: Option<&mut [f64]>) -> f64 {
        let mut axes = [Vector3::zero(); MOST_JOINTS];
        let mut origins = [Vector3::zero(); MOST_JOINTS];
        let mut at = Placement::identity();
        for (i, (joint, &q)) in self.chain.joints().iter().zip(q).enumerate() {
            at = at * joint.parent_from_joint;
            axes[i] = at.rotation * joint.axis;
            origins[i] = at.translation;
            match joint.kind {
                JointKind::Prismatic => at.translation += axes[i] * q,
                _ if joint.axis == Vector3::new(0.0, 0.0, 1.0) => {
                    at.rotation = at.rotation.rotated_about_z(q.sin_cos());
                }
                _ => {
                    at.rotation = at.rotation * Matrix3::rotation(joint.axis, q.sin_cos());
                }
            }
        }
        let tip = at * *self.chain.joint_from_tip();
        let missed = tip.translation - self.target.translation;
        let (r, t) = (tip.rotation, self.target.rotation);
        let chord =
            (r.x - t.x).norm_squared() + (r.y - t.y).norm_squared() + (r.z - t.z).norm_squared();
        if let Some(gradient) = gradient {
            let moment =
                (r.x.cross(t.x) + r.y.cross(t.y) + r.z.cross(t.z)) * (-0.5 * SQUARED_WEIGHT);
            for (i, joint) in self.chain.joints().iter().enumerate() {
                gradient[i] = match joint.kind {
                    JointKind::Prismatic => axes[i].dot(missed),
                    _ => axes[i].dot((tip.translation - origins[i]).cross(missed) + moment),
                };
            }
        }
        0.5 * (missed.norm_squared() + 0.5 * SQUARED_WEIGHT * chord)
    }
}
