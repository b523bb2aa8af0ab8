//! Dispatch of a query to the SIMD solver and the general solver.

use super::QueryError;
use super::arm::Arm;
use super::options::Search;
use super::workspace::{ArmWorkspace, Errors};
use crate::simd_ik::{self, PoseOutcome, PoseSolver};
use kinopt_kinematics::clock::{Instant, is_past};
use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::{Placement, Vector3};
use kinopt_solver::ik::{RowBlockReport, Solution};
use kinopt_solver::problem::Anchor;
use kinopt_solver::search::SearchResult;
use kinopt_solver::solver::{Counts, Termination};
use kinopt_solver::task::Quantity;

/// Iterations of the SIMD solver after which the general solver first continues its attempts.
///
/// The damping by gain ratio of the general solver passes narrow valleys in which the SIMD solver stalls.
pub(super) const QUICK_ATTEMPT_ITERATIONS: u32 = 600;

/// A query with validated target and start.
#[derive(Clone, Copy)]
pub(super) struct Query<'a> {
    pub(super) target: &'a Placement<f64>,
    pub(super) start: &'a [f64],
    pub(super) deadline: Option<Instant>,
}

impl Query<'_> {
    /// Returns true if less than `needed` is left until the deadline.
    #[cfg(feature = "collision")]
    pub(super) fn is_late_by(&self, needed: std::time::Duration) -> bool {
        let earlier = |at: Instant| at.checked_sub(needed).unwrap_or(at);
        is_past(self.deadline.map(earlier))
    }

    pub(super) fn is_late(&self) -> bool {
        is_past(self.deadline)
    }
}

impl Arm {
    /// Builds a query. Its time limit begins now.
    pub(super) fn query<'a>(&self, target: &'a Placement<f64>, start: &'a [f64]) -> Query<'a> {
        Query {
            target,
            start,
            deadline: self.deadline(),
        }
    }

    /// Returns true if a reached solution of the SIMD solver is final, without refinement or comparison.
    pub(super) fn is_plain(&self) -> bool {
        let options = &self.options;
        options.max_move.is_none() && options.posture.is_none() && !options.search.compares()
    }

    /// Returns true if only the attempt from the start matters: the target is proven unreachable.
    ///
    /// It is false for goal bounds of the position, if a number of attempts was given, and if a search returns the best of
    /// all attempts.
    pub(super) fn needs_only_first_attempt(&self, target: &Placement<f64>) -> bool {
        let options = &self.options;
        if options.attempts_given
            || options.searches_globally()
            || !options.goal.is_exact_in_position()
        {
            return false;
        }
        let anchor = self.names.anchors.first().and_then(Option::as_ref);
        let tolerance = options.position_tolerance;
        let shortfall =
            |anchor: &Anchor| anchor.falls_short_of(target.translation, Vector3::zero(), tolerance);
        anchor.and_then(shortfall).is_some()
    }

    /// Largest number of attempts at a target.
    pub(super) fn attempts_at(&self, target: &Placement<f64>) -> u32 {
        match self.needs_only_first_attempt(target) {
            true => 1,
            false => self.options.attempts,
        }
    }

    /// The SIMD solver; with the option `max_move`, the one with the bounds of the query.
    pub(super) fn simd_solver_within<'a>(
        &'a self,
        bounded_solver: &'a Option<PoseSolver>,
    ) -> Option<&'a PoseSolver> {
        match bounded_solver {
            Some(_) if self.options.max_move.is_some() => bounded_solver.as_ref(),
            _ => self.simd_solver.as_ref(),
        }
    }

    /// Query of the SIMD solver for the attempts of the half-open range `attempts`, within `budget` iterations.
    pub(super) fn simd_query<'a>(
        &self,
        query: &Query<'a>,
        attempts: (u32, u32),
        budget: u32,
    ) -> simd_ik::Query<'a> {
        simd_ik::Query {
            target: query.target,
            start: query.start,
            search: self.options.search.preference(),
            attempts,
            budget,
            deadline: query.deadline,
        }
    }

    fn first_attempts<'a>(&self, query: &Query<'a>) -> simd_ik::Query<'a> {
        let attempts = self.attempts_at(query.target);
        self.simd_query(
            query,
            (0, attempts),
            self.options.budget().min(QUICK_ATTEMPT_ITERATIONS),
        )
    }

    /// Solves a query. Returns the search result and the errors of the solution.
    pub(super) fn solve_query(
        &self,
        query: &Query<'_>,
        solution: &mut Solution,
    ) -> Result<(SearchResult, Errors), QueryError> {
        #[cfg(feature = "collision")]
        if let Some(collisions) = &self.collisions {
            return self.solve_collision_free(collisions, query, solution);
        }
        self.solve_without_avoidance(query, solution)
    }

    /// Solves a query without collision avoidance.
    pub(super) fn solve_without_avoidance(
        &self,
        query: &Query<'_>,
        solution: &mut Solution,
    ) -> Result<(SearchResult, Errors), QueryError> {
        let (Some(simd_solver), true) = (&self.simd_solver, self.is_plain()) else {
            return self
                .with_workspace(|workspace| self.solve_with_workspace(workspace, query, solution));
        };
        let n = self.joint_count();
        // The second half holds the best attempt, if the attempt from the start fails.
        solution.q.resize(2 * n, 0.0);
        let (q, best) = solution.q.split_at_mut(n);
        let mut output = simd_ik::QueryOutput {
            q,
            best,
            best_attempt: 0,
        };
        let outcome = simd_solver.race(&self.first_attempts(query), false, &mut output);
        let best_attempt = output.best_attempt;
        let mut result = self.result_of(&outcome);
        if outcome.reached {
            solution.q.truncate(n);
            let errors = Errors::of(&outcome);
            self.record(&result, errors, solution);
            return Ok((result, errors));
        }
        self.with_workspace(|workspace| {
            let (first_end, best) = solution.q.split_at(n);
            workspace.x.copy_from_slice(first_end);
            workspace.best.copy_from_slice(match self.options.search {
                Search::First => first_end,
                _ => best,
            });
            result.number = best_attempt as usize;
            workspace.set_target(query.target);
            self.bound_moves(workspace, query.start);
            self.finish(workspace, query, &mut result);
            self.record_configuration(&result, workspace, solution);
            (result, workspace.errors)
        })
    }

    /// Solves a query with a workspace: for `max_move`, comparing searches, postures and mimic joints.
    fn solve_with_workspace(
        &self,
        workspace: &mut ArmWorkspace,
        query: &Query<'_>,
        solution: &mut Solution,
    ) -> (SearchResult, Errors) {
        workspace.set_target(query.target);
        self.bound_moves(workspace, query.start);
        let mut result = if self.options.search.compares() {
            let termination = self.collect_solutions(workspace, query);
            self.nearest(workspace, query, termination)
        } else if self.simd_solver.is_some() {
            self.search_by_simd_solver(workspace, query)
        } else {
            self.search_by_general_solver(workspace, query)
        };
        self.finish(workspace, query, &mut result);
        if let (true, Some(posture)) = (result.reached, &self.options.posture) {
            self.move_towards_posture(workspace, posture, query.deadline);
            self.judge(workspace, &mut result);
        }
        self.record_configuration(&result, workspace, solution);
        (result, workspace.errors)
    }

    /// Searches with the SIMD solver, into the workspace's x.
    ///
    /// On failure x is the end of the attempt from the start, and `best` the best of all attempts, whose number is
    /// returned.
    fn search_by_simd_solver(
        &self,
        workspace: &mut ArmWorkspace,
        query: &Query<'_>,
    ) -> SearchResult {
        let ArmWorkspace {
            bounded_simd_solver,
            x,
            best,
            ..
        } = workspace;
        let mut first = self.first_attempts(query);
        // With `max_move` the attempt from the start ends before others begin.
        let first_alone = self.options.max_move.is_some();
        if first_alone {
            first.attempts.1 = 1;
        }
        let Some(simd_solver) = self.simd_solver_within(bounded_simd_solver) else {
            return SearchResult::default();
        };
        let mut output = simd_ik::QueryOutput {
            q: x,
            best,
            best_attempt: 0,
        };
        let outcome = simd_solver.race(&first, first_alone, &mut output);
        let best_attempt = output.best_attempt;
        if self.options.search == Search::First {
            best.copy_from_slice(x);
        }
        workspace.errors = Errors::of(&outcome);
        SearchResult {
            number: outcome.winner.unwrap_or(best_attempt) as usize,
            ..self.result_of(&outcome)
        }
    }

    /// Search result of the SIMD solver's attempts. An unreached one has the termination `Stalled`.
    pub(super) fn result_of(&self, outcome: &PoseOutcome) -> SearchResult {
        SearchResult {
            termination: match outcome.reached {
                true => Termination::Reached,
                false => Termination::Stalled,
            },
            number: outcome.winner.unwrap_or(0) as usize,
            cost: self.cost(Errors::of(outcome)),
            reached: outcome.reached,
            iterations: outcome.iterations as usize,
            attempts: outcome.attempts as usize,
            ..SearchResult::default()
        }
    }

    /// Updates the result with the cost and errors at the workspace's x.
    pub(super) fn judge(&self, workspace: &mut ArmWorkspace, result: &mut SearchResult) {
        let errors = workspace.judge_x();
        (result.cost, result.reached) = (self.cost(errors), errors.reached);
    }

    /// Half the sum of the squared errors, m²; radians convert by `metres_per_radian`.
    #[doc(hidden)]
    pub fn cost(&self, errors: Errors) -> f64 {
        // For goals with bounds, the cost has the chord of the angle.
        let chord = match self.options.goal.is_full_pose() {
            true => errors.orientation,
            false => 2.0 * elementary::sin(0.5 * errors.orientation),
        };
        let chord = chord * self.options.metres_per_radian;
        0.5 * (errors.position * errors.position + chord * chord)
    }

    /// Records the search result and the errors, without `q` and active limits.
    #[doc(hidden)]
    pub fn record(&self, result: &SearchResult, errors: Errors, solution: &mut Solution) {
        let options = &self.options;
        let metres = RowBlockReport::of_goal(
            Quantity::Metres,
            errors.position,
            options.position_tolerance,
        );
        let orientation_tolerance = options.orientation_tolerance;
        let radians =
            RowBlockReport::of_goal(Quantity::Radians, errors.orientation, orientation_tolerance);
        let metres = options.goal.has_position().then_some(metres);
        let radians = options.goal.has_orientation().then_some(radians);
        solution.record_errors(&self.names, metres.into_iter().chain(radians));
        solution.cost = result.cost;
        solution.record(&SearchResult {
            // An iteration evaluates one residual and one Jacobian, in both solvers.
            counts: Counts {
                residuals: result.iterations,
                jacobians: result.iterations,
                gradients: 0,
            },
            projected_gradient: None,
            agreeing: 0,
            ..*result
        });
    }

    /// Records all results at the workspace's configuration; of an unreached one also the active limits.
    pub(super) fn record_configuration(
        &self,
        result: &SearchResult,
        workspace: &mut ArmWorkspace,
        solution: &mut Solution,
    ) {
        workspace.x.clone_into(&mut solution.q);
        self.record(result, workspace.errors, solution);
        if !solution.reached {
            let negligible = workspace.compute_gradient();
            let (x, question) = (&workspace.x, workspace.question.instance());
            solution.record_active_limits(question, x, &workspace.gradient, negligible);
            solution.projected_gradient = Some(workspace.projected_gradient(x));
            solution.find_out_of_reach(question);
        }
    }
}

impl Errors {
    /// Errors of the SIMD solver's outcome.
    pub(super) fn of(outcome: &PoseOutcome) -> Self {
        Self {
            position: outcome.position_error,
            orientation: outcome.orientation_error,
            reached: outcome.reached,
        }
    }
}
