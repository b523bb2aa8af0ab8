//! Joints should be near given values.

use super::residual::not_finite;
use super::{LocalJacobian, Quantity, Residual, Role, Rows};
use crate::model::{FrameId, JointId, Model};
use crate::scalar::Scalar;
use crate::spatial::Placement;

/// r_j = q_j − reference_j, one row per joint, in the joint's own unit. A preference by default.
#[derive(Clone, Debug, PartialEq)]
pub struct Posture {
    joints: Vec<JointId>,
    reference: Vec<f64>,
}

impl Posture {
    /// Every moving joint of `model` near its value in `reference` (shape: degrees of freedom).
    /// A missing value counts as 0.
    #[must_use]
    pub fn new(model: &Model, reference: &[f64]) -> Self {
        let joints = model.moving_joints().to_vec();
        let mut reference = reference.to_vec();
        reference.resize(joints.len(), 0.0);
        Self { joints, reference }
    }

    /// Only some joints, each with its value in radians or metres.
    #[must_use]
    pub fn of_joints(values: impl IntoIterator<Item = (JointId, f64)>) -> Self {
        let (joints, reference) = values.into_iter().unzip();
        Self { joints, reference }
    }

    /// Changes the values; missing ones keep what they were.
    pub fn set_reference(&mut self, reference: &[f64]) {
        for (own, &new) in self.reference.iter_mut().zip(reference) {
            *own = new;
        }
    }
}

impl Residual for Posture {
    const ROLE: Role = Role::Preference;

    fn kind(&self) -> &'static str {
        "posture"
    }

    fn frames(&self) -> Vec<FrameId> {
        Vec::new()
    }

    fn joints(&self) -> Vec<JointId> {
        self.joints.clone()
    }

    fn rows(&self) -> Vec<Rows> {
        vec![Rows::new(Quantity::JointUnits, self.joints.len())]
    }

    fn evaluate<S: Scalar>(&self, _frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        for ((row, &value), &reference) in residual.iter_mut().zip(joints).zip(&self.reference) {
            *row = value - S::constant(reference);
        }
    }

    fn differentiate(
        &self,
        _frames: &[Placement<f64>],
        joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        jacobian.set_diagonal(std::iter::repeat_n(1.0, joints.len()));
        true
    }

    fn validate(&self) -> Result<(), String> {
        not_finite("its reference", self.reference.iter().copied())
    }
}
