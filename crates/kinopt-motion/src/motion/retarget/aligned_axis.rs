//! Task that aligns an axis of a frame with a direction of the world.

use kinopt_kinematics::model::FrameId;
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::{Placement, Vector3};
use kinopt_solver::task::{Description, Inputs, LocalJacobian, Quantity, Residual, RowBlock};

/// Residual r = w (R a − d) of an axis a in frame coordinates and a direction d of the world, both of unit length.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct AlignedAxis {
    frame: FrameId,
    axis: Vector3<f64>,
    direction: Vector3<f64>,
    /// Metres of position error per radian.
    weight: f64,
}

impl AlignedAxis {
    /// Creates the task without effect: its weight is 0.
    pub(super) fn new(frame: FrameId, axis: Vector3<f64>) -> Self {
        Self {
            frame,
            axis,
            direction: axis,
            weight: 0.0,
        }
    }

    /// Sets the direction and the weight.
    pub(super) fn set(&mut self, direction: Vector3<f64>, weight: f64) {
        (self.direction, self.weight) = (direction, weight);
    }
}

impl Residual for AlignedAxis {
    fn inputs(&self) -> Inputs {
        Inputs::frames([self.frame])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, 3)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], residual: &mut [S]) {
        let axis = frames[0].rotation * Vector3::constant(self.axis);
        let error = (axis - Vector3::constant(self.direction)) * S::constant(self.weight);
        residual.copy_from_slice(&error.to_array());
    }

    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        _joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        let axis = frames[0].rotation * self.axis;
        // Uses (ω × a)·e = ω · (a × e).
        let rows = jacobian.angular_mut(0).iter_mut().zip(Vector3::UNITS);
        for (row, unit) in rows {
            *row = axis.cross(unit) * self.weight;
        }
        true
    }

    fn description(&self) -> Description {
        Description::new("aligned axis")
    }
}
