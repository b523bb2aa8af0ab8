//! A frame should have an orientation.

use super::residual::not_finite;
use super::{LocalJacobian, Quantity, Residual, Rows};
use crate::model::FrameId;
use crate::scalar::Scalar;
use crate::spatial::{Matrix3, Placement, rotation_log, rotation_log_jacobian};

/// The rotation vector of R R_targetᵀ: three rows in radians, world axes, length within [0, π].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orientation {
    frame: FrameId,
    target: Matrix3<f64>,
}

impl Orientation {
    /// The frame's axes should be the columns of `target` (world_from_frame).
    #[must_use]
    pub fn new(frame: FrameId, target: impl Into<Matrix3<f64>>) -> Self {
        Self {
            frame,
            target: target.into(),
        }
    }

    /// The axes that the frame should have, in columns (world_from_frame).
    #[must_use]
    pub fn target(&self) -> Matrix3<f64> {
        self.target
    }

    /// Changes the target.
    pub fn set_target(&mut self, target: impl Into<Matrix3<f64>>) {
        self.target = target.into();
    }

    /// The rotation vector from the target to `rotation`.
    pub(super) fn miss<S: Scalar>(target: Matrix3<f64>, rotation: Matrix3<S>) -> [S; 3] {
        let world_turn = rotation * Matrix3::constant(target.transpose());
        rotation_log(&world_turn).to_array()
    }

    /// Writes ∂miss/∂ω into three rows of `jacobian`.
    pub(super) fn differentiate_miss(
        target: Matrix3<f64>,
        rotation: Matrix3<f64>,
        first_row: usize,
        jacobian: &mut LocalJacobian,
    ) {
        let miss = Self::miss(target, rotation);
        let by_turning = rotation_log_jacobian(miss.into()).transpose();
        let rows = &mut jacobian.angular_mut(0)[first_row..];
        for (row, value) in rows
            .iter_mut()
            .zip([by_turning.x, by_turning.y, by_turning.z])
        {
            *row = value;
        }
    }
}

impl Residual for Orientation {
    fn kind(&self) -> &'static str {
        "orientation"
    }

    fn frames(&self) -> Vec<FrameId> {
        vec![self.frame]
    }

    fn rows(&self) -> Vec<Rows> {
        vec![Rows::new(Quantity::Radians, 3)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], residual: &mut [S]) {
        residual.copy_from_slice(&Self::miss(self.target, frames[0].rotation));
    }

    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        _joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        Self::differentiate_miss(self.target, frames[0].rotation, 0, jacobian);
        true
    }

    fn defect(&self) -> Option<String> {
        rotation_defect(&self.target)
    }
}

/// Why a target rotation is none, if so.
pub(super) fn rotation_defect(target: &Matrix3<f64>) -> Option<String> {
    let columns = [target.x, target.y, target.z];
    not_finite("its orientation", columns.iter().flat_map(|c| c.to_array())).or_else(|| {
        Placement::new(*target, crate::spatial::Vector3::zero())
            .check_rigid(1e-6)
            .err()
            .map(|problem| format!("its target is no orientation: {problem}"))
    })
}
