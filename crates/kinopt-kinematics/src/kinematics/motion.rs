//! Motions of joints.

use crate::model::JointKind;
use crate::scalar::Scalar;
use crate::spatial::{Matrix3, Placement, Vector3};

/// The motion of a node; a rotation about a coordinate axis changes two columns only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum NodeMotion {
    RotateX,
    RotateY,
    RotateZ,
    Rotate(Vector3<f64>),
    Translate(Vector3<f64>),
    /// One of the three consecutive variables of a ball joint.
    Ball(BallPart),
}

/// Index of a ball joint in a tree, and of one of its three variables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BallPart {
    pub(super) ball: u32,
    pub(super) part: u32,
}

impl NodeMotion {
    pub(super) fn new(kind: JointKind, axis: Vector3<f64>) -> Option<Self> {
        let (zero, one) = (0.0, 1.0);
        match kind {
            JointKind::Fixed | JointKind::Ball => None,
            JointKind::Prismatic => Some(Self::Translate(axis)),
            JointKind::Revolute | JointKind::Continuous => Some(match axis.to_array() {
                [x, y, z] if [x, y, z] == [one, zero, zero] => Self::RotateX,
                [x, y, z] if [x, y, z] == [zero, one, zero] => Self::RotateY,
                [x, y, z] if [x, y, z] == [zero, zero, one] => Self::RotateZ,
                _ => Self::Rotate(axis),
            }),
        }
    }

    pub(super) fn turns(&self) -> bool {
        !matches!(self, Self::Translate(_))
    }

    /// The placement after a motion by `value`, given with its sine and cosine.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn apply<S: Scalar>(
        &self,
        placement: Placement<S>,
        value: S,
        trigonometry: (S, S),
    ) -> Placement<S> {
        let Placement {
            rotation,
            translation,
        } = placement;
        match self {
            // Unreachable for `BallNodes`: a tree rotates ball joints by all three values. An arm for it slows revolute
            // joints by 4 %.
            Self::RotateX | Self::Ball(_) => {
                Placement::new(rotation.rotated_about_x(trigonometry), translation)
            }
            Self::RotateY => Placement::new(rotation.rotated_about_y(trigonometry), translation),
            Self::RotateZ => Placement::new(rotation.rotated_about_z(trigonometry), translation),
            Self::Rotate(axis) => {
                let relative_rotation = Matrix3::rotation(Vector3::constant(*axis), trigonometry);
                Placement::new(rotation * relative_rotation, translation)
            }
            Self::Translate(axis) => {
                let along = rotation * Vector3::constant(*axis);
                Placement::new(rotation, along.mul_add(value, translation))
            }
        }
    }

    /// The axis of the motion in world axes; `balls` holds the axes of the tree's ball joints.
    #[inline(always)]
    pub(super) fn world_axis(
        &self,
        origin_from_node: &Placement<f64>,
        balls: &[[Vector3<f64>; 3]],
    ) -> Vector3<f64> {
        let rotation = &origin_from_node.rotation;
        match self {
            Self::RotateX => rotation.x,
            Self::RotateY => rotation.y,
            Self::RotateZ => rotation.z,
            Self::Rotate(axis) | Self::Translate(axis) => *rotation * *axis,
            Self::Ball(BallPart { ball, part }) => balls[*ball as usize][*part as usize],
        }
    }
}
