//! The residual of a tool at a target, with room on some axes, for the core's derivatives.

use crate::lanes::AxisGoal;
use crate::model::FrameId;
use crate::scalar::Scalar;
use crate::scalar::elementary;
use crate::spatial::{Matrix3, Placement, Quaternion, Vector3, rotation_log_jacobian};
use crate::task::{LocalJacobian, Quantity, Residual, Rows};

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

    /// The rotation from the target's axes to the tool's.
    fn turn<S: Scalar>(&self, rotation: Matrix3<S>) -> Quaternion<S> {
        let target = Matrix3::constant(self.target.rotation).transpose();
        Quaternion::from_matrix(&(target * rotation))
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
        let quaternion = self.turn(frames[0].rotation);
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

    /// The rows stand in the target's axes, which world's turn to: of the logarithm φ they are
    /// J_l⁻¹(φ), of twice a quaternion's vector part w − [v] (from q' = ½ ω q).
    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        _joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        let target = &self.target.rotation;
        let quaternion = self.turn(frames[0].rotation);
        // By columns, one for each of the target's axes.
        let by_turning = if self.full {
            rotation_log_jacobian(quaternion.log())
        } else {
            let column = |unit: Vector3<f64>| unit * quaternion.w + unit.cross(quaternion.v);
            let [x, y, z] = Vector3::UNITS.map(column);
            Matrix3::from_columns(x, y, z)
        };
        let by_turning = *target * by_turning.transpose();
        let offset = frames[0].translation - self.target.translation;
        let offset = [target.x, target.y, target.z].map(|axis| axis.dot(offset));
        let axes = &self.axes;
        let counts = |weight: f64, half_width: f64, value: f64| {
            weight > 0.0 && (half_width <= 0.0 || value.abs() > half_width)
        };
        for (k, axis) in [target.x, target.y, target.z].into_iter().enumerate() {
            let (weight, half_width) = (axes.position_weights[k], axes.position_half_widths[k]);
            if counts(weight, half_width, offset[k]) {
                jacobian.linear_mut(0)[k] = axis;
            }
        }
        let turn = (quaternion.v * 2.0).to_array();
        let rows = [by_turning.x, by_turning.y, by_turning.z];
        for (k, row) in rows.into_iter().enumerate() {
            let (weight, half_width) =
                (axes.orientation_weights[k], axes.orientation_half_widths[k]);
            if counts(weight, half_width, turn[k]) {
                jacobian.angular_mut(0)[3 + k] = row;
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::FrameId;
    use crate::spatial::rotation_exp;

    /// What a small twist of the frame does to the rows, by central differences.
    fn difference(
        pose: &ToolPose,
        frame: Placement<f64>,
        linear: bool,
        unit: Vector3<f64>,
    ) -> [f64; 6] {
        let step = 1e-6;
        let rows = [step, -step].map(|by| {
            let moved = match linear {
                true => Placement::new(frame.rotation, frame.translation + unit * by),
                false => {
                    Placement::new(rotation_exp(unit * by) * frame.rotation, frame.translation)
                }
            };
            let mut rows = [0.0; 6];
            pose.evaluate(&[moved], &[], &mut rows);
            rows
        });
        std::array::from_fn(|k| (rows[0][k] - rows[1][k]) / (2.0 * step))
    }

    #[test]
    fn derivatives_are_those_of_the_rows() {
        let some = AxisGoal {
            position_weights: [1.0, 0.0, 1.0],
            orientation_weights: [1.0, 1.0, 0.0],
            position_half_widths: [0.05, 0.0, 5.0],
            orientation_half_widths: [0.01, 0.0, 0.0],
        };
        let turn = |x, y, z| rotation_exp(Vector3::new(x, y, z));
        for axes in [AxisGoal::full_pose(), some] {
            for away in [0.0, 0.3, 2.5] {
                let mut pose = ToolPose::new(FrameId::new(0), axes);
                pose.target = Placement::new(turn(0.4, -1.1, 0.7), Vector3::new(0.3, 0.1, -0.6));
                let rotation = turn(0.5 * away, 0.7 * away, -0.5 * away) * pose.target.rotation;
                let frame = Placement::new(rotation, Vector3::new(-0.2, 0.5, 0.4));
                let mut jacobian = LocalJacobian::default();
                jacobian.reset(6, 1, 0);
                assert!(pose.differentiate(&[frame], &[], &mut jacobian));
                for unit in Vector3::UNITS {
                    for linear in [true, false] {
                        let rows = match linear {
                            true => jacobian.linear(0),
                            false => jacobian.angular(0),
                        };
                        let expected = difference(&pose, frame, linear, unit);
                        for (row, expected) in rows.iter().zip(expected) {
                            assert!(
                                (row.dot(unit) - expected).abs() < 1e-7,
                                "{row:?} {expected}"
                            );
                        }
                    }
                }
            }
        }
    }
}
