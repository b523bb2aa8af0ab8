//! Chain whose joints move about or along the z axis of their frames.

use kinopt_kinematics::spatial::{Matrix3, Placement, Vector3};

use super::joint_box::{JointBox, MAX_ARM_JOINTS};
use crate::simd_ik::{Chain, ChainJoint};

/// Motion of a joint about or along the z axis of its frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum AxisMotion {
    Rotation,
    Translation,
}

/// Joint at value zero in the frame of the joint before it.
#[derive(Clone, Copy, Debug)]
pub(super) struct AxisJoint {
    pub(super) motion: AxisMotion,
    pub(super) parent_from_joint: Placement<f64>,
    pub(super) joint_from_parent: Placement<f64>,
}

/// Chain of joints about or along z.
#[derive(Clone, Debug)]
pub(super) struct AxisChain {
    pub(super) joints: Vec<AxisJoint>,
    /// Number of translations at the base along the negative axes of the base frame: 3 in a chain of a cell, else 0.
    pub(super) cell_translations: usize,
    pub(super) last_joint_from_tool: Placement<f64>,
    /// All configurations within the limits, up to whole revolutions.
    pub(super) limits: JointBox,
}

impl AxisChain {
    /// Turns the frames of a chain so that the joints' axes are z. Returns `None` for more than [`MAX_ARM_JOINTS`]
    /// joints and for an unlimited prismatic joint.
    pub(super) fn new(chain: &Chain) -> Option<Self> {
        match chain.joints().len() > MAX_ARM_JOINTS {
            true => None,
            false => Self::of_joints(chain.joints(), chain.joint_from_tip()),
        }
    }

    /// A chain of at most [`MAX_JOINTS`](super::joint_box::MAX_JOINTS) joints with unit axes; `None` for an unlimited
    /// prismatic joint.
    pub(super) fn of_joints(chain: &[ChainJoint], joint_from_tip: &Placement<f64>) -> Option<Self> {
        let mut limits = JointBox::default();
        let mut joints = Vec::with_capacity(chain.len());
        let mut turned_from_last = Placement::identity();
        for (index, joint) in chain.iter().enumerate() {
            let motion = match joint.kind.slides() {
                true => AxisMotion::Translation,
                false => AxisMotion::Rotation,
            };
            let (lower, upper) = within_a_revolution(motion, joint.lower, joint.upper)?;
            limits.centre[index] = 0.5 * (lower + upper);
            limits.half_width[index] = 0.5 * (upper - lower);
            let joint_from_turned = Placement::new(rotation_of_z_to(joint.axis), Vector3::zero());
            let parent_from_joint = turned_from_last * joint.parent_from_joint * joint_from_turned;
            joints.push(AxisJoint {
                motion,
                parent_from_joint,
                joint_from_parent: parent_from_joint.inverse(),
            });
            turned_from_last = joint_from_turned.inverse();
        }
        Some(Self {
            joints,
            cell_translations: 0,
            last_joint_from_tool: turned_from_last * *joint_from_tip,
            limits,
        })
    }
}

/// Limits of a joint without repeated revolutions; `None` for an unlimited translation.
fn within_a_revolution(motion: AxisMotion, lower: f64, upper: f64) -> Option<(f64, f64)> {
    use std::f64::consts::{PI, TAU};
    match motion {
        AxisMotion::Rotation if upper - lower >= TAU => Some((-PI, PI)),
        AxisMotion::Translation if (upper - lower).is_infinite() => None,
        _ => Some((lower, upper)),
    }
}

/// A rotation that takes z to the unit vector `axis`.
fn rotation_of_z_to(axis: Vector3<f64>) -> Matrix3<f64> {
    // The coordinate axis least along `axis`, so that the product below is far from zero.
    let across = match axis.x.abs() < 0.6 {
        true => Vector3::new(1.0, 0.0, 0.0),
        false => Vector3::new(0.0, 1.0, 0.0),
    };
    let y = axis.cross(across);
    let y = y * y.norm().recip();
    Matrix3::from_columns(y.cross(axis), y, axis)
}
