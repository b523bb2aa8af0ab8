//! Search for a solution that the caller accepts.

use super::QueryError;
use super::arm::Arm;
#[cfg(feature = "collision")]
use super::collision_avoidance::sphere_checks::drop_colliding;
use super::distances::weighted_distance;
use super::move_bounds::bound_moves;
use super::multi_solution::{collect_solutions_from, distinct};
use super::query::{Query, attempts_at};
use super::solve_query::solve_query;
use kinopt_kinematics::spatial::Placement;
use kinopt_solver::ik::Solution;
#[cfg(feature = "collision")]
use kinopt_solver::solver::Termination;

/// Distance of two offered solutions at first, in weighted joint distance.
const INITIAL_DISTANCE: f64 = 0.1;
/// Smallest distance of two offered solutions, in weighted joint distance.
const MIN_DISTANCE: f64 = 1e-3;

impl Arm {
    /// Offers reached configurations to `accept` until it returns true. Returns whether one was accepted.
    ///
    /// The first is that of [`solve_into`](Self::solve_into). Further ones come from rounds of attempts, nearest to the
    /// start first within a round, any two at least 0.1 apart in weighted joint distance. A round without a new solution
    /// ends the search; for a redundant arm it halves the distance, down to 0.001. A time limit ends the search too, and
    /// includes the time of `accept`. An arm without a time limit makes one round.
    ///
    /// `solution` is the accepted one. If there is none, it is the result of [`solve_into`](Self::solve_into).
    ///
    /// # Errors
    /// Returns the errors of [`solve`](Self::solve).
    #[doc(hidden)]
    pub fn solve_accepted(
        &self,
        base_from_tool: impl Into<Placement<f64>>,
        start: &[f64],
        mut accept: impl FnMut(&[f64]) -> bool,
        solution: &mut Solution,
    ) -> Result<bool, QueryError> {
        let target = base_from_tool.into();
        self.check_length("the start", start.len(), self.joint_count())?;
        self.check_query(None, &target, start)?;
        let query = Query::new(self, &target, start);
        solve_query(self, &query, solution)?;
        if !solution.reached {
            return Ok(false);
        }
        if accept(&solution.q) {
            return Ok(true);
        }
        let mut distance = INITIAL_DISTANCE;
        let mut offered = vec![solution.q.clone()];
        let mut first_attempt = 0_u32;
        loop {
            let round = solutions_from(self, &query, first_attempt, distance)?;
            let offered_before = offered.len();
            for other in round {
                let is_new = |q: &Vec<f64>| weighted_distance(self, q, &other.q) > distance;
                if !offered.iter().all(is_new) {
                    continue;
                }
                if accept(&other.q) {
                    *solution = other;
                    return Ok(true);
                }
                offered.push(other.q);
                if query.is_late() {
                    return Ok(false);
                }
            }
            if offered.len() == offered_before {
                distance *= 0.5;
                if distance < MIN_DISTANCE || !self.has_null_space() {
                    return Ok(false);
                }
            }
            first_attempt = first_attempt.saturating_add(attempts_at(self, &target));
            if query.deadline.is_none() || query.is_late() || first_attempt == u32::MAX {
                return Ok(false);
            }
        }
    }
}

/// Solutions of one round of attempts, from number `first_attempt`.
fn solutions_from(
    arm: &Arm,
    query: &Query<'_>,
    first_attempt: u32,
    distance: f64,
) -> Result<Vec<Solution>, QueryError> {
    arm.with_workspace(|workspace| {
        workspace.set_target(query.target);
        bound_moves(arm, workspace, query.start);
        let termination = collect_solutions_from(arm, workspace, query, first_attempt);
        #[cfg(feature = "collision")]
        let termination = match drop_colliding(arm, workspace, query)? {
            true => termination,
            false => Termination::TimeLimit,
        };
        Ok(distinct(arm, workspace, usize::MAX, distance, termination))
    })?
}
