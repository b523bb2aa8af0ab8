//! Type-erased residuals: the generic method, instantiated for the scalars in use.

use std::any::Any;

use super::by_dual_numbers::{CHUNK, DualScratch, by_dual_numbers};
use super::{Extensions, Inequality, LocalJacobian, Residual};
use kinopt_kinematics::scalar::Dual;
use kinopt_kinematics::spatial::Placement;

/// The methods of a residual that a problem uses.
pub(crate) trait ErasedResidual: Send + Sync + Any {
    fn kind(&self) -> &'static str;

    fn evaluate(&self, frames: &[Placement<f64>], joints: &[f64], residual: &mut [f64]);

    fn evaluate_dual(
        &self,
        frames: &[Placement<Dual<CHUNK>>],
        joints: &[Dual<CHUNK>],
        residual: &mut [Dual<CHUNK>],
    );

    fn target_len(&self) -> usize;

    fn evaluate_moved(
        &self,
        frames: &[Placement<Dual<CHUNK>>],
        joints: &[Dual<CHUNK>],
        step: &[Dual<CHUNK>],
        residual: &mut [Dual<CHUNK>],
    );

    fn add_target_slopes(
        &self,
        frames: &[Placement<f64>],
        joints: &[f64],
        coefficients: &[f64],
        slopes: &mut [f64],
    ) -> bool;

    /// Writes the exact local derivatives; `jacobian` has the residual's shape and is zero.
    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        joints: &[f64],
        jacobian: &mut LocalJacobian,
        scratch: &mut DualScratch,
    );

    fn inequalities(&self) -> Vec<Inequality>;

    fn slacks(&self, frames: &[Placement<f64>], joints: &[f64], slacks: &mut [f64]);

    /// The same as [`differentiate`](Self::differentiate), for the slacks.
    fn differentiate_slacks(
        &self,
        frames: &[Placement<f64>],
        joints: &[f64],
        jacobian: &mut LocalJacobian,
        scratch: &mut DualScratch,
    );

    fn has_edges(&self) -> bool;

    fn as_any(&self) -> &dyn Any;

    fn as_any_mut(&mut self) -> &mut dyn Any;

    fn boxed(&self) -> Box<dyn ErasedResidual>;
}

impl std::fmt::Debug for dyn ErasedResidual {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.kind())
    }
}

impl Clone for Box<dyn ErasedResidual> {
    fn clone(&self) -> Self {
        // Call the method of the content, not of the box.
        (**self).boxed()
    }
}

impl<R: Residual> ErasedResidual for R {
    fn kind(&self) -> &'static str {
        self.description().kind
    }

    fn target_len(&self) -> usize {
        Extensions::target_len(self)
    }

    fn inequalities(&self) -> Vec<Inequality> {
        match &R::EXTENSIONS.inequality {
            Some(inequality) => (inequality.inequalities)(self),
            None => Vec::new(),
        }
    }

    fn has_edges(&self) -> bool {
        match &R::EXTENSIONS.target {
            Some(target) => (target.has_edges)(self),
            None => true,
        }
    }

    fn as_any(&self) -> &dyn Any {
        self
    }

    fn as_any_mut(&mut self) -> &mut dyn Any {
        self
    }

    fn boxed(&self) -> Box<dyn ErasedResidual> {
        Box::new(self.clone())
    }

    fn evaluate(&self, frames: &[Placement<f64>], joints: &[f64], residual: &mut [f64]) {
        Residual::evaluate(self, frames, joints, residual);
    }

    fn evaluate_dual(
        &self,
        frames: &[Placement<Dual<CHUNK>>],
        joints: &[Dual<CHUNK>],
        residual: &mut [Dual<CHUNK>],
    ) {
        Residual::evaluate(self, frames, joints, residual);
    }

    fn evaluate_moved(
        &self,
        frames: &[Placement<Dual<CHUNK>>],
        joints: &[Dual<CHUNK>],
        step: &[Dual<CHUNK>],
        residual: &mut [Dual<CHUNK>],
    ) {
        Extensions::evaluate_moved(self, frames, joints, step, residual);
    }

    fn add_target_slopes(
        &self,
        frames: &[Placement<f64>],
        joints: &[f64],
        coefficients: &[f64],
        slopes: &mut [f64],
    ) -> bool {
        match &R::EXTENSIONS.target {
            Some(target) => (target.add_target_slopes)(self, frames, joints, coefficients, slopes),
            None => false,
        }
    }

    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        joints: &[f64],
        jacobian: &mut LocalJacobian,
        scratch: &mut DualScratch,
    ) {
        if !Residual::differentiate(self, frames, joints, jacobian) {
            by_dual_numbers(
                |frames, joints, rows| Residual::evaluate(self, frames, joints, rows),
                frames,
                joints,
                jacobian,
                scratch,
            );
        }
    }

    fn slacks(&self, frames: &[Placement<f64>], joints: &[f64], slacks: &mut [f64]) {
        if let Some(inequality) = &R::EXTENSIONS.inequality {
            (inequality.slacks)(self, frames, joints, slacks);
        }
    }

    fn differentiate_slacks(
        &self,
        frames: &[Placement<f64>],
        joints: &[f64],
        jacobian: &mut LocalJacobian,
        scratch: &mut DualScratch,
    ) {
        let Some(inequality) = &R::EXTENSIONS.inequality else {
            return;
        };
        if !(inequality.differentiate_slacks)(self, frames, joints, jacobian) {
            by_dual_numbers(
                |frames, joints, slacks| (inequality.dual_slacks)(self, frames, joints, slacks),
                frames,
                joints,
                jacobian,
                scratch,
            );
        }
    }
}
