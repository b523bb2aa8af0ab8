//! Bounded nonlinear least squares: minimise ½‖r(x)‖² subject to lower ≤ x ≤ upper.
//!
//! Solvers are independent of robots: they take a [`LeastSquares`] problem. A [`Method`] is one step; the loop around
//! it ([`minimise`]) counts, observes and stops for all methods.

mod active_set;
mod ball_joints;
mod configuration_space;
mod curvature;
mod error;
mod gauss_newton;
mod iterate;
mod least_squares;
mod levenberg_marquardt;
mod line_search;
mod linear;
mod method;
mod minimise;
mod observer;
mod progress;
mod projected_gradient;
#[cfg(feature = "argmin")]
mod snapshot;
mod state;
mod stopping;

pub(crate) use ball_joints::{Edge, RotationSets, Swing, TurnLimit};
pub use configuration_space::{ConfigurationSpace, Side};
pub use error::SolveError;
pub use gauss_newton::{GaussNewton, GaussNewtonState};
pub use iterate::Iterate;
pub use least_squares::LeastSquares;
pub use levenberg_marquardt::{Damping, LevenbergMarquardt, LevenbergMarquardtState};
#[doc(hidden)]
pub use linear::{
    BranchedMatrix, HeldStep, Inequalities, InnerProducts, RowSpace, RowSpan, StepBounds,
    TangentNewton, dot, largest,
};
pub use method::{AnyMethod, Method, Step};
pub use minimise::{Outcome, minimise};
pub use observer::{Iteration, Observer, Silent};
#[doc(hidden)]
pub use progress::Progress;
#[doc(hidden)]
pub use progress::negligible_slope;
pub use projected_gradient::{FirstStep, ProjectedGradient, ProjectedGradientState};
#[cfg(feature = "argmin")]
#[doc(hidden)]
pub use snapshot::Snapshot;
#[doc(hidden)]
pub use state::half_squared;
pub use state::{Counts, SolverState};
pub use stopping::{Stopping, Termination};
