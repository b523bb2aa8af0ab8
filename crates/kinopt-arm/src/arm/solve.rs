//! Queries of an arm: one target, several solutions of a target, batches, and the derivative of a solution.

use super::arm::Arm;
#[cfg(feature = "rayon")]
use super::batch::outcomes_of_chunks;
use super::batch::{check_batch_into, outcomes_of_chunk, solve_chunks};
use super::derivative::{ArmDerivative, derivative};
use super::query::Query;
use super::solve_query::solve_query;
use super::{PoseOutcome, QueryError};
use kinopt_kinematics::spatial::Placement;
use kinopt_solver::ik::Solution;

impl Arm {
    /// Solves for one target from one start. A start outside the limits is clamped to them.
    ///
    /// If the target is not reached, the result is the closest pose reached from the start. An arm that searches
    /// [globally](super::ArmBuilder::with_global_search_on_miss) or for the [first](super::Search::First) solution
    /// returns the best of all attempts instead.
    ///
    /// # Errors
    /// Returns an error for a start of the wrong length or not finite, or a target that is not a rigid motion. An
    /// unreachable target is not an error: see [`Solution::reached`] and [`Solution::explain`].
    pub fn solve(
        &self,
        base_from_tool: impl Into<Placement<f64>>,
        start: &[f64],
    ) -> Result<Solution, QueryError> {
        let mut solution = Solution::default();
        self.solve_into(base_from_tool, start, &mut solution)?;
        Ok(solution)
    }

    /// Solves as [`solve`](Self::solve) does, into an existing solution.
    ///
    /// After the first few queries nothing is allocated for a target that is reached.
    ///
    /// # Errors
    /// Returns the errors of [`solve`](Self::solve).
    pub fn solve_into(
        &self,
        base_from_tool: impl Into<Placement<f64>>,
        start: &[f64],
        solution: &mut Solution,
    ) -> Result<(), QueryError> {
        let target = base_from_tool.into();
        self.check_length("the start", start.len(), self.joint_count())?;
        self.check_query(None, &target, start)?;
        solve_query(self, &Query::new(self, &target, start), solution)?;
        Ok(())
    }

    /// Solves for many targets; `starts` holds one configuration per target, in sequence.
    ///
    /// The SIMD lanes hold different queries, which is faster than single queries in sequence. A result depends on its
    /// query alone: configurations and errors are bitwise those of [`solve`](Self::solve). The exception is
    /// [`Search::First`](super::Search::First): there the lowest attempt that reaches wins, not the quickest. The
    /// counts of iterations and attempts are those of the batch.
    ///
    /// # Errors
    /// Returns the errors of [`solve`](Self::solve), for the first invalid query.
    pub fn solve_batch(
        &self,
        base_from_tools: &[Placement<f64>],
        starts: &[f64],
    ) -> Result<Vec<Solution>, QueryError> {
        solve_chunks(self, base_from_tools, starts, |chunks, solve| {
            chunks.into_iter().try_for_each(solve)
        })
    }

    /// [`solve_batch`](Self::solve_batch) over the threads of the current rayon pool, with bitwise equal results.
    ///
    /// # Errors
    /// Returns the errors of [`solve_batch`](Self::solve_batch).
    #[cfg(feature = "rayon")]
    pub fn solve_batch_parallel(
        &self,
        base_from_tools: &[Placement<f64>],
        starts: &[f64],
    ) -> Result<Vec<Solution>, QueryError> {
        use rayon::prelude::*;
        solve_chunks(self, base_from_tools, starts, |chunks, solve| {
            chunks.into_par_iter().try_for_each(solve)
        })
    }

    /// Solves as [`solve_batch`](Self::solve_batch) does, into slices: one configuration and one outcome per target.
    ///
    /// After the first few queries nothing is allocated.
    ///
    /// # Errors
    /// Returns the errors of [`solve_batch`](Self::solve_batch), and an error for slices of the wrong length.
    pub fn solve_batch_into(
        &self,
        base_from_tools: &[Placement<f64>],
        starts: &[f64],
        q: &mut [f64],
        outcomes: &mut [PoseOutcome],
    ) -> Result<(), QueryError> {
        check_batch_into(self, base_from_tools, starts, q, outcomes)?;
        outcomes_of_chunk(self, base_from_tools, starts, q, outcomes)
    }

    /// [`solve_batch_into`](Self::solve_batch_into) over the threads of the current rayon pool, with bitwise equal
    /// results.
    ///
    /// # Errors
    /// Returns the errors of [`solve_batch_into`](Self::solve_batch_into).
    #[cfg(feature = "rayon")]
    pub fn solve_batch_into_parallel(
        &self,
        base_from_tools: &[Placement<f64>],
        starts: &[f64],
        q: &mut [f64],
        outcomes: &mut [PoseOutcome],
    ) -> Result<(), QueryError> {
        check_batch_into(self, base_from_tools, starts, q, outcomes)?;
        outcomes_of_chunks(self, base_from_tools, starts, q, outcomes)
    }

    /// Derivative of the solution `q` with respect to its target, which may be unreached.
    ///
    /// For a redundant arm it is the [shortest](kinopt_solver::ik::Differentiability::ShortestOfMany) of many. A joint held by a limit stays
    /// there.
    ///
    /// ```
    /// # std::env::set_current_dir("../..")?;
    /// # use kinopt::arm::Arm;
    /// # use kinopt::robot::Robot;
    /// let robot = Robot::read("models/universal_ur5e.urdf")?;
    /// let arm = Arm::builder(&robot, "base", "flange").build()?;
    /// let target = arm.base_from_tool(&[0.4, -1.2, 1.1, -0.8, 1.2, 0.5])?;
    /// let solution = arm.solve(target, &[0.3, -1.1, 1.0, -0.9, 1.1, 0.4])?;
    /// let derivative = arm.derivative(target, &solution.q)?;
    /// assert!(derivative.differentiability.is_unique());
    /// assert_eq!(derivative.by_target.shape(), (6, 6));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error for a configuration of the wrong length or not finite, or a target that is not a rigid motion.
    pub fn derivative(
        &self,
        base_from_tool: impl Into<Placement<f64>>,
        q: &[f64],
    ) -> Result<ArmDerivative, QueryError> {
        let target = base_from_tool.into();
        self.check_length("q", q.len(), self.joint_count())?;
        self.check_query(None, &target, q)?;
        derivative(self, &target, q)
    }
}
