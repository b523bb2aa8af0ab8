//! Position task of a frame's point with a variable weight.

use kinopt_kinematics::model::FrameId;
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::{Placement, Vector3};
use kinopt_solver::task::{Description, Inputs, LocalJacobian, Point, Residual, RowBlock};

/// Residual r = w (x + R o − target): a [`Point`] with a weight that changes with its target.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DrivenPoint {
    point: Point,
    weight: f64,
}

impl DrivenPoint {
    pub(super) fn new(frame: FrameId, offset: Vector3<f64>) -> Self {
        Self {
            point: Point::new(frame, Vector3::zero()).at(offset),
            weight: 1.0,
        }
    }

    /// Sets the target and the weight.
    pub(super) fn set(&mut self, target: Vector3<f64>, weight: f64) {
        self.point.set_target(target);
        self.weight = weight;
    }

    /// Returns the position of the point for its residual.
    pub(super) fn position(&self, residual: &[f64]) -> Vector3<f64> {
        let error = Vector3::new(residual[0], residual[1], residual[2]);
        self.point.target() + error * (1.0 / self.weight)
    }
}

impl Residual for DrivenPoint {
    fn inputs(&self) -> Inputs {
        self.point.inputs()
    }

    fn rows(&self) -> Vec<RowBlock> {
        self.point.rows()
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        self.point.evaluate(frames, joints, residual);
        let weight = S::constant(self.weight);
        residual.iter_mut().for_each(|row| *row *= weight);
    }

    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        let known = self.point.differentiate(frames, joints, jacobian);
        jacobian.scale_rows(&[self.weight; 3]);
        known
    }

    fn description(&self) -> Description {
        Description::new("driven point")
    }
}
