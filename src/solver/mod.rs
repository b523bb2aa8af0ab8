//! Bounded nonlinear least squares: minimise ½‖r(x)‖² subject to lower ≤ x ≤ upper.
//!
//! Solvers know no robots: they see a [`LeastSquares`]. A [`Method`] is one step; the loop around
//! it ([`minimise`]) counts, observes and stops for all of them.

mod active_set;
mod curvature;
mod gauss_newton;
mod least_squares;
mod levenberg_marquardt;
mod line_search;
mod linear;
mod memory;
mod method;
mod minimise;
mod observer;
mod projected_gradient;
mod search;
#[cfg(feature = "argmin")]
mod snapshot;
mod stopping;

pub use active_set::project;
pub(crate) use active_set::projected_gradient_norm;
pub use gauss_newton::GaussNewton;
pub use least_squares::LeastSquares;
pub use levenberg_marquardt::{Damping, LevenbergMarquardt};
pub(crate) use linear::{HeldStep, Room};
pub(crate) use memory::half_squared;
pub use memory::{Counts, Memory};
pub use method::{Method, Step};
pub(crate) use minimise::minimise_until;
pub use minimise::{Outcome, minimise};
pub use observer::{Iteration, Observer, Silent};
pub use projected_gradient::{FirstStep, ProjectedGradient};
#[cfg(feature = "argmin")]
pub(crate) use search::Search;
pub(crate) use search::negligible_slope;
#[cfg(feature = "argmin")]
pub(crate) use snapshot::Snapshot;
pub use stopping::{Stopping, Termination};
