//! A frame should stand at a placement: position and orientation.

use super::orientation::rotation_defect;
use super::residual::not_finite;
use super::{LocalJacobian, Orientation, Quantity, Residual, Rows};
use crate::model::FrameId;
use crate::scalar::Scalar;
use crate::spatial::{Placement, Vector3};

/// Three rows in metres, x − x_target, then three in radians, the rotation vector of R R_targetᵀ;
/// all in world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    frame: FrameId,
    target: Placement<f64>,
}

impl Pose {
    /// The frame should stand at `target` (world_from_frame).
    #[must_use]
    pub fn new(frame: FrameId, target: impl Into<Placement<f64>>) -> Self {
        Self {
            frame,
            target: target.into(),
        }
    }

    /// Where the frame should stand (world_from_frame).
    #[must_use]
    pub fn target(&self) -> Placement<f64> {
        self.target
    }

    /// Moves the target.
    pub fn set_target(&mut self, target: impl Into<Placement<f64>>) {
        self.target = target.into();
    }
}

impl Residual for Pose {
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
        let miss = frames[0].translation - Vector3::constant(self.target.translation);
        let turn = Orientation::miss(self.target.rotation, frames[0].rotation);
        let (position, orientation) = residual.split_at_mut(3);
        position.copy_from_slice(&miss.to_array());
        orientation.copy_from_slice(&turn);
    }

    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        _joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        for (row, unit) in jacobian.linear_mut(0).iter_mut().zip(Vector3::UNITS) {
            *row = unit;
        }
        Orientation::differentiate_miss(self.target.rotation, frames[0].rotation, 3, jacobian);
        true
    }

    fn defect(&self) -> Option<String> {
        not_finite("its target", self.target.translation.to_array())
            .or_else(|| rotation_defect(&self.target.rotation))
    }
}
