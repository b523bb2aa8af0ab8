//! Solution of one query, with collision avoidance if the arm has a checker.

use super::QueryError;
use super::arm::Arm;
#[cfg(feature = "collision")]
use super::collision_avoidance::search::solve_collision_free;
use super::dispatch::solve_without_avoidance;
use super::query::Query;
use super::workspace::Errors;
use kinopt_solver::ik::Solution;
use kinopt_solver::search::SearchResult;

/// Solves a query. Returns the search result and the errors of the solution.
pub(super) fn solve_query(
    arm: &Arm,
    query: &Query<'_>,
    solution: &mut Solution,
) -> Result<(SearchResult, Errors), QueryError> {
    #[cfg(feature = "collision")]
    if let Some(collisions) = &arm.collisions {
        return solve_collision_free(arm, collisions, query, solution);
    }
    solve_without_avoidance(arm, query, solution)
}
