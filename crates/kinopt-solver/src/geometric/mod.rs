//! Geometric inverse kinematics: methods on bone ends that need no derivatives.
//!
//! All methods take a [`Problem`](crate::Problem) as the optimisers do, with the same tolerances and parameter map.
//! Tasks are points and, for some methods, poses. The result is the same [`Solution`]. Joint limits hold exactly at
//! every configuration they visit.
//!
//! # Choosing a method
//!
//! - [`TwoBone`]: a limb of two bones with one target for its end. Exact, in one step. It is the only method with a
//!   choice of the elbow's side. All other joints must be locked.
//! - [`Ccd`]: the most general method, with poses, several tips and prismatic joints. Its sweeps are cheap and never
//!   increase its cost. It converges slowly near stretched chains, and it bends the outer joints most.
//! - [`Fabrik`]: long chains and trees of bones, with three joint axes that meet at each bone's start (rigs). It needs
//!   few passes and bends evenly. With hinges or tight limits, points and joints conflict, and it may stop early.
//!
//! These methods minimise only the error of their targets. Near limits, for unreachable targets and for other tasks the
//! optimisers of [`ik`](crate::ik) are better.
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
mod fabrik;
mod goal;
mod grouped;
mod joint_groups;
mod joint_motion;
mod joint_points;
mod joints_to_points;
mod linkage;
mod sweeps;
mod triangle;
mod two_bone;

pub use ccd::Ccd;
pub use fabrik::{Fabrik, Reaching, fabrik};
pub use linkage::Span;
pub use triangle::{Triangle, triangle};
pub use two_bone::{Elbow, TwoBone};

use crate::ik::Solution;
use crate::problem::ProblemInstance;
use crate::search::SolveError;
use crate::solver::{Observer, Silent};

/// A geometric method with its settings, immutable and shareable.
pub trait Geometric: Send + Sync {
    /// A short name for tables.
    fn name(&self) -> &'static str;

    /// Searches from the configuration `start`, with an observer that sees every sweep and may cancel.
    ///
    /// `start` has one number for each coordinate and is projected into the limits. Locked and mimic joints take their
    /// values from the parameter map. Sweeps count from 0 in each attempt. The observer gets no gradient and no step
    /// length.
    ///
    /// # Errors
    /// Returns an error for a start of wrong length or not finite, or for tasks or joints that the method does not
    /// support, by name. An unreached target is not an error.
    fn solve_question(
        &self,
        instance: ProblemInstance<'_>,
        start: &[f64],
        observer: &mut dyn Observer,
    ) -> Result<Solution, SolveError>;

    /// Solves a problem, or an [instance](ProblemInstance) of it, without an observer.
    ///
    /// # Errors
    /// Returns the errors of [`solve_question`](Self::solve_question).
    fn solve<'a>(
        &self,
        instance: impl Into<ProblemInstance<'a>>,
        start: &[f64],
    ) -> Result<Solution, SolveError>
    where
        Self: Sized,
    {
        self.solve_question(instance.into(), start, &mut Silent)
    }

    /// Solves as [`solve`](Self::solve) does, with an observer.
    ///
    /// # Errors
    /// Returns the errors of [`solve_question`](Self::solve_question).
    fn solve_observed<'a>(
        &self,
        instance: impl Into<ProblemInstance<'a>>,
        start: &[f64],
        observer: &mut dyn Observer,
    ) -> Result<Solution, SolveError>
    where
        Self: Sized,
    {
        self.solve_question(instance.into(), start, observer)
    }
}
