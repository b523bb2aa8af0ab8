//! Joints should move slowly from where they last were.

use super::residual::not_finite;
use super::{LocalJacobian, Quantity, Residual, Role, Rows};
use crate::model::{FrameId, JointId, Model};
use crate::scalar::Scalar;
use crate::spatial::Placement;

/// (q_j − previous_j) / Δt, one row per joint, in radians or metres per second. A preference by
/// default.
#[derive(Clone, Debug, PartialEq)]
pub struct Smoothness {
    joints: Vec<JointId>,
    previous: Vec<f64>,
    time_step_s: f64,
}

impl Smoothness {
    /// Every moving joint of `model`, which stood at `previous` (shape: degrees of freedom; a
    /// missing value counts as 0) `time_step_s` seconds ago.
    #[must_use]
    pub fn new(model: &Model, previous: &[f64], time_step_s: f64) -> Self {
        let joints = model.moving_joints().to_vec();
        let mut previous = previous.to_vec();
        previous.resize(joints.len(), 0.0);
        Self {
            joints,
            previous,
            time_step_s,
        }
    }

    /// Takes the next step's starting point; missing values keep what they were.
    pub fn set_previous(&mut self, previous: &[f64]) {
        for (own, &new) in self.previous.iter_mut().zip(previous) {
            *own = new;
        }
    }
}

impl Residual for Smoothness {
    const ROLE: Role = Role::Preference;

    fn kind(&self) -> &'static str {
        "smoothness"
    }

    fn frames(&self) -> Vec<FrameId> {
        Vec::new()
    }

    fn joints(&self) -> Vec<JointId> {
        self.joints.clone()
    }

    fn rows(&self) -> Vec<Rows> {
        vec![Rows::new(Quantity::JointUnitsPerSecond, self.joints.len())]
    }

    fn evaluate<S: Scalar>(&self, _frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        let per_second = S::constant(1.0 / self.time_step_s);
        for ((row, &value), &previous) in residual.iter_mut().zip(joints).zip(&self.previous) {
            *row = (value - S::constant(previous)) * per_second;
        }
    }

    fn differentiate(
        &self,
        _frames: &[Placement<f64>],
        joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        jacobian.set_diagonal(std::iter::repeat_n(1.0 / self.time_step_s, joints.len()));
        true
    }

    fn defect(&self) -> Option<String> {
        not_finite("its previous configuration", self.previous.iter().copied()).or_else(|| {
            let usable = self.time_step_s > 0.0 && self.time_step_s.is_finite();
            (!usable).then(|| format!("its time step {} s is not positive", self.time_step_s))
        })
    }
}
