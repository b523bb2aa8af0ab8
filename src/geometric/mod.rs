//! Geometric inverse kinematics: the classical methods that know where bones end and need no
//! derivatives.
//!
//! All take a [`Problem`](crate::Problem) as the optimisers do, with `Point` tasks (and poses, where said), the same
//! tolerances and parameter map, and return the same [`Solution`]. Joint limits hold at every
//! configuration that they visit, to the bit.
//!
//! # Which one when
//!
//! - [`TwoBone`]: a limb of two bones and one point for its end. Exact, in one step, and the only
//!   one that lets you choose the elbow's side. Everything but the limb is locked.
//! - [`Ccd`]: anything that a joint can serve, also poses, several tips, sliding joints. Cheap
//!   sweeps that never raise its cost, but slow to converge near stretched chains, and it bends the
//!   outer joints most.
//! - [`Fabrik`]: long chains and trees of ball joints (rigs). Few passes, even bends. With hinges
//!   or tight limits its points and the joints pull against each other, and it may stop short.
//!
//! None of them minimises anything but the miss of its goals; near limits, on targets out of reach
//! and with other tasks the optimisers of [`ik`](crate::ik) do better.
//!
//! ```
//! use kinopt::geometric::{Ccd, Geometric};
//! use kinopt::model::{Limits, Model};
//! use kinopt::spatial::{Placement, Vector3};
//! use kinopt::task::Point;
//! use kinopt::Problem;
//!
//! let mut builder = Model::builder("two links");
//! let (z, link) = (Vector3::new(0.0, 0.0, 1.0), Placement::translation([1.0, 0.0, 0.0].into()));
//! let limits = Limits::new(-2.5, 2.5);
//! let shoulder = builder.revolute("shoulder", None, Placement::identity(), z, limits);
//! let elbow = builder.revolute("elbow", Some(shoulder), link, z, limits);
//! let tip = builder.frame("tip", Some(elbow), link);
//! let model = builder.build()?;
//!
//! let mut tasks = Problem::builder(&model);
//! tasks.add(Point::new(tip, [1.0, 1.0, 0.0]));
//! let solution = Ccd::default().solve(&tasks.build()?, &[0.1, 0.1])?;
//! assert!(solution.reached);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod ccd;
mod descent;
mod error;
mod fabrik;
mod goal;
mod grouped;
mod joint_groups;
mod joint_points;
mod joints_to_points;
mod linkage;
mod sweeps;
mod triangle;
mod turn;
mod two_bone;

pub use ccd::Ccd;
pub use error::GeometricError;
pub use fabrik::{Fabrik, Reaching, fabrik};
pub use linkage::Span;
pub use triangle::{Triangle, triangle};
pub use two_bone::{Elbow, TwoBone};

use crate::ik::Solution;
use crate::problem::Question;
use crate::solver::{Observer, Silent};

/// A geometric method with its settings: what a harness calls. Immutable and shareable.
pub trait Geometric: Send + Sync {
    /// A short name for tables.
    fn name(&self) -> &'static str;

    /// Searches from the configuration `start` (degrees of freedom; projected into the limits; locked and
    /// following joints take their values from the parameter map), with an observer that sees every
    /// sweep and may cancel. Sweeps count from 0 in each attempt; there is no gradient and no step length to
    /// see.
    ///
    /// # Errors
    /// A start of the wrong length or not finite; tasks or joints that the method has no answer
    /// for, by name. A target that is not reached is no error.
    fn solve_question(
        &self,
        question: Question<'_>,
        start: &[f64],
        observer: &mut dyn Observer,
    ) -> Result<Solution, GeometricError>;

    /// Solves a problem, or a [question](Question) to it, as [`solve_question`](Self::solve_question) does.
    ///
    /// # Errors
    /// As there.
    fn solve<'a>(
        &self,
        question: impl Into<Question<'a>>,
        start: &[f64],
    ) -> Result<Solution, GeometricError>
    where
        Self: Sized,
    {
        self.solve_question(question.into(), start, &mut Silent)
    }

    /// As [`solve`](Self::solve), with an observer.
    ///
    /// # Errors
    /// As [`solve_question`](Self::solve_question).
    fn solve_observed<'a>(
        &self,
        question: impl Into<Question<'a>>,
        start: &[f64],
        observer: &mut dyn Observer,
    ) -> Result<Solution, GeometricError>
    where
        Self: Sized,
    {
        self.solve_question(question.into(), start, observer)
    }
}
