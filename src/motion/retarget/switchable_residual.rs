//! Residual that can be disabled at some samples.

use crate::model::{FrameId, JointId};
use crate::scalar::Scalar;
use crate::spatial::Placement;
use crate::task::{Inequality, RowBlock};
use crate::task::{LocalJacobian, Residual};

/// Wrapper that evaluates to the wrapped residual, or to 0.
#[derive(Clone, Debug)]
pub(super) struct Switchable<R> {
    inner: R,
    enabled: bool,
}

impl<R> Switchable<R> {
    pub(super) fn new(inner: R) -> Self {
        Self {
            inner,
            enabled: true,
        }
    }

    /// Enables or disables the residual.
    pub(super) fn set(&mut self, enabled: bool) {
        self.enabled = enabled;
    }
}

impl<R: Residual> Residual for Switchable<R> {
    fn kind(&self) -> &'static str {
        self.inner.kind()
    }

    fn is_of_body(&self) -> bool {
        self.inner.is_of_body()
    }

    fn frames(&self) -> Vec<FrameId> {
        self.inner.frames()
    }

    fn joints(&self) -> Vec<JointId> {
        self.inner.joints()
    }

    fn joint_values(&self) -> Option<usize> {
        self.inner.joint_values()
    }

    fn rows(&self) -> Vec<RowBlock> {
        self.inner.rows()
    }

    fn inequalities(&self) -> Vec<Inequality> {
        self.inner.inequalities()
    }

    fn validate(&self) -> Result<(), String> {
        self.inner.validate()
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        match self.enabled {
            true => self.inner.evaluate(frames, joints, residual),
            false => residual.fill(S::constant(0.0)),
        }
    }

    fn slacks<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], slacks: &mut [S]) {
        match self.enabled {
            true => self.inner.slacks(frames, joints, slacks),
            false => slacks.fill(S::constant(f64::INFINITY)),
        }
    }

    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        !self.enabled || self.inner.differentiate(frames, joints, jacobian)
    }

    fn differentiate_depths(
        &self,
        frames: &[Placement<f64>],
        joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        !self.enabled || self.inner.differentiate_depths(frames, joints, jacobian)
    }
}
