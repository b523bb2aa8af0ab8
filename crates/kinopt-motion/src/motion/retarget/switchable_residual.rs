//! Residual that can be disabled at some samples.

use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::Placement;
use kinopt_solver::task::{
    Description, Extensions, Inequality, InequalityResidual, Inputs, LocalJacobian, Residual,
    RowBlock,
};

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

impl<R: InequalityResidual> Residual for Switchable<R> {
    const EXTENSIONS: Extensions<Self> = Extensions::NONE.with_inequalities();

    fn inputs(&self) -> Inputs {
        self.inner.inputs()
    }

    fn rows(&self) -> Vec<RowBlock> {
        self.inner.rows()
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        match self.enabled {
            true => self.inner.evaluate(frames, joints, residual),
            false => residual.fill(S::constant(0.0)),
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

    fn description(&self) -> Description {
        self.inner.description()
    }
}

impl<R: InequalityResidual> InequalityResidual for Switchable<R> {
    fn inequalities(&self) -> Vec<Inequality> {
        self.inner.inequalities()
    }

    fn slacks<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], slacks: &mut [S]) {
        match self.enabled {
            true => self.inner.slacks(frames, joints, slacks),
            false => slacks.fill(S::constant(f64::INFINITY)),
        }
    }

    fn differentiate_slacks(
        &self,
        frames: &[Placement<f64>],
        joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        !self.enabled || self.inner.differentiate_slacks(frames, joints, jacobian)
    }
}
