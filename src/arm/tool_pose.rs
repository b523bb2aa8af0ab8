//! The residual of a tool at a target, with room on some axes, for the core's derivatives.

use crate::lanes::AxisGoal;
use crate::model::FrameId;
use crate::scalar::Scalar;
use crate::scalar::elementary;
use crate::spatial::{Matrix3, Placement, Quaternion, Vector3};
use crate::task::{Quantity, Residual, Rows};

/// Three rows in metres and three in radians, in the target's axes: the offset, and the rotation
/// logarithm (for the full pose) or twice the vector part of the relative quaternion, each beyond
/// its interval.
#[derive(Clone, Copy, Debug)]
pub(super) struct ToolPose {
    frame: FrameId,
    axes: AxisGoal,
    full: bool,
    pub(super) target: Placement<f64>,
}

impl ToolPose {
    pub(super) fn new(frame: FrameId, axes: AxisGoal) -> Self {
        Self {
            frame,
            axes,
            full: axes.is_full_pose(),
            target: Placement::identity(),
        }
    }

    /// The angle that the norm of the last three rows stands for.
    pub(super) fn angle(&self, rows: f64) -> f64 {
        if self.full {
            rows
        } else {
            2.0 * elementary::asin((0.5 * rows).min(1.0))
        }
    }
}

impl Residual for ToolPose {
    fn kind(&self) -> &'static str {
        "pose"
    }

    fn frames(&self) -> Vec<FrameId> {
        vec![self.frame]
    }

    fn rows(&self) -> Vec<Rows> {
        vec![
            Rows::new(Quantity::Metres, 3),
            Rows::new(Quantity::Radians, 3),
        ]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], residual: &mut [S]) {
        let rotation = Matrix3::constant(self.target.rotation).transpose();
        let offset = frames[0].translation - Vector3::constant(self.target.translation);
        let offset = rotation * offset;
        let quaternion = Quaternion::from_matrix(&(rotation * frames[0].rotation));
        let turn = if self.full {
            quaternion.log()
        } else {
            // Of q and −q either will do: rows of the other sign have the same slope.
            quaternion.v * S::constant(2.0)
        };
        let axes = &self.axes;
        let (position, orientation) = residual.split_at_mut(3);
        let position = position
            .iter_mut()
            .zip(offset.to_array())
            .zip(axes.position_weights.iter().zip(axes.position_half_widths));
        let orientation = orientation.iter_mut().zip(turn.to_array()).zip(
            axes.orientation_weights
                .iter()
                .zip(axes.orientation_half_widths),
        );
        for ((row, value), (&weight, half_width)) in position.chain(orientation) {
            *row = if weight <= 0.0 {
                S::zero()
            } else if half_width > 0.0 {
                let half_width = S::constant(half_width);
                value - value.max(-half_width).min(half_width)
            } else {
                value
            };
        }
    }
}
