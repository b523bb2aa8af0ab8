//! Residuals with inequalities, for lower priority levels.

use super::by_dual_numbers::CHUNK;
use super::extensions::InequalityFunctions;
use super::{Extensions, Inequality, LocalJacobian, Residual};
use kinopt_kinematics::scalar::{Dual, Scalar};
use kinopt_kinematics::spatial::Placement;

/// A residual with rows that are zero if all their slacks are at least zero.
///
/// Lower priority levels treat these rows as the inequalities slack ≥ 0. Rows in no inequality are equations, even if
/// they are zero at a solution. A problem uses the inequalities only if [`Residual::EXTENSIONS`] contains them.
///
/// ```
/// use kinopt::model::FrameId;
/// use kinopt::spatial::Placement;
/// use kinopt::task::{Extensions, Inequality, InequalityResidual, Inputs, Quantity, Residual, RowBlock};
/// use kinopt::Scalar;
///
/// /// Keeps a frame outside a ball about the world's origin.
/// #[derive(Clone)]
/// struct OutsideBall { frame: FrameId, radius: f64 }
///
/// impl OutsideBall {
///     fn slack<S: Scalar>(&self, frames: &[Placement<S>]) -> S {
///         frames[0].translation.norm() - S::constant(self.radius)
///     }
/// }
///
/// impl Residual for OutsideBall {
///     const EXTENSIONS: Extensions<Self> = Extensions::NONE.with_inequalities();
///     fn inputs(&self) -> Inputs { Inputs::frames([self.frame]) }
///     fn rows(&self) -> Vec<RowBlock> { vec![RowBlock::new(Quantity::Metres, 1)] }
///     fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _: &[S], r: &mut [S]) {
///         r[0] = self.slack(frames).min(S::zero());
///     }
/// }
///
/// impl InequalityResidual for OutsideBall {
///     fn inequalities(&self) -> Vec<Inequality> { vec![Inequality::new(0..1, 1)] }
///     fn slacks<S: Scalar>(&self, frames: &[Placement<S>], _: &[S], slacks: &mut [S]) {
///         slacks[0] = self.slack(frames);
///     }
/// }
/// ```
pub trait InequalityResidual: Residual {
    /// The inequalities of the residual; empty if it has none with its present parameters.
    fn inequalities(&self) -> Vec<Inequality>;

    /// Writes the slacks of its [inequalities](Self::inequalities), one inequality after the other.
    ///
    /// A slack is zero at the boundary, positive inside, and smooth on both sides, in the unit of the rows. An absent
    /// bound has an infinite slack.
    fn slacks<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], slacks: &mut [S]);

    /// Writes the exact derivatives of the [slacks](Self::slacks) and returns true, or returns false to use dual numbers.
    ///
    /// `jacobian` has one row for each slack and is zero on entry.
    fn differentiate_slacks(
        &self,
        frames: &[Placement<f64>],
        joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        let _ = (frames, joints, jacobian);
        false
    }
}

impl<R: InequalityResidual> Extensions<R> {
    /// Adds the inequalities of an [`InequalityResidual`].
    #[must_use]
    pub const fn with_inequalities(mut self) -> Self {
        self.inequality = Some(InequalityFunctions {
            inequalities: R::inequalities,
            slacks: R::slacks::<f64>,
            dual_slacks: R::slacks::<Dual<CHUNK>>,
            differentiate_slacks: R::differentiate_slacks,
        });
        self
    }
}
