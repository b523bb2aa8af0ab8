//! The errors of a returned q, by forward kinematics on the chain as it was given.

use super::chain::{Chain, JointKind};
use super::lane::Lanes;
use super::links::frame_along;
use super::trigonometry;
use crate::spatial::{Matrix3, Placement, Vector3};

/// A chain whose axes are all z; nothing else is rearranged.
#[derive(Clone, Debug)]
pub(crate) struct Judge {
    joints: Vec<(Placement<f64>, JointKind)>,
    last_from_tip: Placement<f64>,
}

impl Judge {
    pub(crate) fn new(chain: &Chain) -> Self {
        let mut before = Matrix3::identity();
        let joints = chain
            .joints()
            .iter()
            .map(|joint| {
                let alignment = frame_along(joint.axis);
                let step = Placement::new(before.transpose(), Vector3::zero())
                    * joint.parent_from_joint
                    * Placement::new(alignment, Vector3::zero());
                before = alignment;
                (step, joint.kind)
            })
            .collect();
        let last_from_tip =
            Placement::new(before.transpose(), Vector3::zero()) * *chain.joint_from_tip();
        Self {
            joints,
            last_from_tip,
        }
    }

    /// Distance (m) and angle (rad) of the tip at `q` from the target.
    #[inline(always)]
    pub(crate) fn errors(&self, base_from_target: &Placement<f64>, q: &[f64]) -> (f64, f64) {
        let tip = self.base_from_tip(q);
        let p = tip.translation - base_from_target.translation;
        let (a, b) = (&base_from_target.rotation, &tip.rotation);
        // Twice sin θ n in the base frame, and 1 + 2 cos θ.
        let skew = a.x.cross(b.x) + a.y.cross(b.y) + a.z.cross(b.z);
        let trace = a.x.dot(b.x) + a.y.dot(b.y) + a.z.dot(b.z);
        (p.norm(), skew.norm().atan2(trace - 1.0))
    }

    #[inline(always)]
    pub(crate) fn base_from_tip(&self, q: &[f64]) -> Placement<f64> {
        let mut placement = Placement::identity();
        for (i, ((step, kind), &value)) in self.joints.iter().zip(q).enumerate() {
            placement = if i == 0 { *step } else { placement * *step };
            match kind {
                JointKind::Revolute => {
                    let (s, c) = trigonometry::sin_cos(Lanes::<1, false>([value]));
                    placement.rotation = placement.rotation.rotated_about_z((s.0[0], c.0[0]));
                }
                JointKind::Prismatic => {
                    placement.translation =
                        placement.rotation.z.mul_add(value, placement.translation);
                }
            }
        }
        placement * self.last_from_tip
    }
}
