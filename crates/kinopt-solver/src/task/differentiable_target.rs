//! Residuals with a target, by which solutions can be differentiated.

use super::by_dual_numbers::CHUNK;
use super::extensions::TargetFunctions;
use super::{Extensions, Residual};
use kinopt_kinematics::scalar::{Dual, Scalar};
use kinopt_kinematics::spatial::Placement;

/// A residual with derivatives by its target, for [`SolutionDerivative`](crate::ik::SolutionDerivative).
///
/// A problem uses them only if [`Residual::EXTENSIONS`] contains them.
///
/// ```
/// use kinopt::model::FrameId;
/// use kinopt::spatial::Placement;
/// use kinopt::task::{DifferentiableTarget, Extensions, Inputs, Quantity, Residual, RowBlock};
/// use kinopt::Scalar;
///
/// /// Moves a frame to a height.
/// #[derive(Clone)]
/// struct AtHeight { frame: FrameId, height: f64 }
///
/// impl Residual for AtHeight {
///     const EXTENSIONS: Extensions<Self> = Extensions::NONE.with_target();
///     fn inputs(&self) -> Inputs { Inputs::frames([self.frame]) }
///     fn rows(&self) -> Vec<RowBlock> { vec![RowBlock::new(Quantity::Metres, 1)] }
///     fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], r: &mut [S]) {
///         self.evaluate_moved(frames, joints, &[S::zero()], r);
///     }
/// }
///
/// impl DifferentiableTarget for AtHeight {
///     fn target_len(&self) -> usize { 1 }
///     fn evaluate_moved<S: Scalar>(&self, frames: &[Placement<S>], _: &[S], step: &[S], r: &mut [S]) {
///         r[0] = frames[0].translation.z - S::constant(self.height) - step[0];
///     }
/// }
/// # use kinopt::model::{Limits, Model};
/// # use kinopt::problem::ParameterVector;
/// # use kinopt::spatial::Vector3;
/// # use kinopt::Problem;
/// # let mut builder = Model::builder("lift");
/// # let z = Vector3::UNITS[2];
/// # let lift = builder.prismatic("lift", None, Placement::identity(), z, Limits::new(0.0, 1.0));
/// # let frame = builder.frame("cabin", Some(lift), Placement::identity());
/// # let model = builder.build()?;
/// # let mut tasks = Problem::builder(&model);
/// # tasks.add(AtHeight { frame, height: 0.4 });
/// # assert_eq!(ParameterVector::new(&tasks.build()?).targets().len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait DifferentiableTarget: Residual {
    /// Number of parameters of the target, for [`evaluate_moved`](Self::evaluate_moved).
    fn target_len(&self) -> usize;

    /// Evaluates the residual with its target moved by `step`, which has [`target_len`](Self::target_len) numbers.
    ///
    /// Only the derivative at a step of zero is used, to differentiate solutions by the target. Positions and values
    /// move by the step itself. Orientations rotate about their own axes, as
    /// [`Model::integrate`](kinopt_kinematics::model::Model::integrate) moves a free joint.
    fn evaluate_moved<S: Scalar>(
        &self,
        frames: &[Placement<S>],
        joints: &[S],
        step: &[S],
        residual: &mut [S],
    );

    /// Adds the derivatives of Σ cᵢ rᵢ by the step of [`evaluate_moved`](Self::evaluate_moved), at a step of zero.
    ///
    /// Returns true, or returns false to use dual numbers. `coefficients` are the cᵢ, one for each row.
    fn add_target_slopes(
        &self,
        frames: &[Placement<f64>],
        joints: &[f64],
        coefficients: &[f64],
        slopes: &mut [f64],
    ) -> bool {
        let _ = (frames, joints, coefficients, slopes);
        false
    }

    /// True if rows may be zero on a region with a boundary, as with bounds.
    ///
    /// A solution on such a boundary may have no derivative. Returning false saves the check.
    fn has_edges(&self) -> bool {
        true
    }
}

impl<R: DifferentiableTarget> Extensions<R> {
    /// Adds the target of a [`DifferentiableTarget`].
    #[must_use]
    pub const fn with_target(mut self) -> Self {
        self.target = Some(TargetFunctions {
            target_len: R::target_len,
            evaluate_moved: R::evaluate_moved::<Dual<CHUNK>>,
            add_target_slopes: R::add_target_slopes,
            has_edges: R::has_edges,
        });
        self
    }
}

impl<R: Residual> Extensions<R> {
    /// Number of parameters of the residual's target; 0 without a target.
    pub(super) fn target_len(residual: &R) -> usize {
        match &R::EXTENSIONS.target {
            Some(target) => (target.target_len)(residual),
            None => 0,
        }
    }

    /// Evaluates the residual with its target moved by a step; without a target, the residual itself.
    pub(super) fn evaluate_moved(
        residual: &R,
        frames: &[Placement<Dual<CHUNK>>],
        joints: &[Dual<CHUNK>],
        step: &[Dual<CHUNK>],
        rows: &mut [Dual<CHUNK>],
    ) {
        match &R::EXTENSIONS.target {
            Some(target) => (target.evaluate_moved)(residual, frames, joints, step, rows),
            None => residual.evaluate(frames, joints, rows),
        }
    }
}
