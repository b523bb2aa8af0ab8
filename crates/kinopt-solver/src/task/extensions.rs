//! Optional abilities of residuals: inequalities and differentiable targets.

use super::by_dual_numbers::CHUNK;
use super::{Inequality, LocalJacobian};
use kinopt_kinematics::scalar::Dual;
use kinopt_kinematics::spatial::Placement;

/// The optional traits that a problem uses of a residual: [`InequalityResidual`] and [`DifferentiableTarget`].
///
/// A residual lists the traits that it implements in [`Residual::EXTENSIONS`]. The functions are constants of the
/// type, so that the compiler makes direct calls of them.
///
/// [`DifferentiableTarget`]: super::DifferentiableTarget
/// [`InequalityResidual`]: super::InequalityResidual
/// [`Residual::EXTENSIONS`]: super::Residual::EXTENSIONS
#[derive(Debug)]
pub struct Extensions<R> {
    pub(super) inequality: Option<InequalityFunctions<R>>,
    pub(super) target: Option<TargetFunctions<R>>,
}

/// Evaluation of rows or slacks by one scalar.
type Evaluate<R, S> = fn(&R, &[Placement<S>], &[S], &mut [S]);

/// Exact derivatives of slacks; false to use dual numbers.
type Differentiate<R> = fn(&R, &[Placement<f64>], &[f64], &mut LocalJacobian) -> bool;

/// The methods of an [`InequalityResidual`](super::InequalityResidual), for the scalars in use.
#[derive(Debug)]
pub(super) struct InequalityFunctions<R> {
    pub(super) inequalities: fn(&R) -> Vec<Inequality>,
    pub(super) slacks: Evaluate<R, f64>,
    pub(super) dual_slacks: Evaluate<R, Dual<CHUNK>>,
    pub(super) differentiate_slacks: Differentiate<R>,
}

/// The methods of a [`DifferentiableTarget`](super::DifferentiableTarget), for the scalars in use.
#[derive(Debug)]
pub(super) struct TargetFunctions<R> {
    pub(super) target_len: fn(&R) -> usize,
    pub(super) evaluate_moved: EvaluateMoved<R>,
    pub(super) add_target_slopes: AddTargetSlopes<R>,
    pub(super) has_edges: fn(&R) -> bool,
}

/// Evaluation of rows with a moved target.
type EvaluateMoved<R> =
    fn(&R, &[Placement<Dual<CHUNK>>], &[Dual<CHUNK>], &[Dual<CHUNK>], &mut [Dual<CHUNK>]);

/// Exact derivatives by the target; false to use dual numbers.
type AddTargetSlopes<R> = fn(&R, &[Placement<f64>], &[f64], &[f64], &mut [f64]) -> bool;

impl<R> Extensions<R> {
    /// No optional trait.
    pub const NONE: Self = Self {
        inequality: None,
        target: None,
    };
}
