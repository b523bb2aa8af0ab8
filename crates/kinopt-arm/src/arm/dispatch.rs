//! Dispatch of a query to the SIMD solver and the general solver.

use super::QueryError;
use super::arm::Arm;
use super::fallback::finish;
use super::general_solver::search_by_general_solver;
use super::move_bounds::bound_moves;
use super::multi_solution::{collect_solutions, nearest};
use super::options::Search;
use super::query::{
    QUICK_ATTEMPT_ITERATIONS, Query, attempts_at, is_plain, simd_query, simd_solver_within,
};
use super::recording::{judge, record, record_configuration, result_of};
use super::toward_posture::move_towards_posture;
use super::workspace::{ArmWorkspace, Errors};
use crate::simd_ik;
use kinopt_solver::ik::Solution;
use kinopt_solver::search::SearchResult;

/// Solves a query without collision avoidance.
pub(super) fn solve_without_avoidance(
    arm: &Arm,
    query: &Query<'_>,
    solution: &mut Solution,
) -> Result<(SearchResult, Errors), QueryError> {
    let (Some(simd_solver), true) = (&arm.simd_solver, is_plain(arm)) else {
        return arm
            .with_workspace(|workspace| solve_with_workspace(arm, workspace, query, solution));
    };
    let n = arm.joint_count();
    // The second half holds the best attempt, if the attempt from the start fails.
    solution.q.resize(2 * n, 0.0);
    let (q, best) = solution.q.split_at_mut(n);
    let mut output = simd_ik::QueryOutput {
        q,
        best,
        best_attempt: 0,
    };
    let outcome = simd_solver.race(&first_attempts(arm, query), false, &mut output);
    let best_attempt = output.best_attempt;
    let mut result = result_of(arm, &outcome);
    if outcome.reached {
        solution.q.truncate(n);
        let errors = Errors::of(&outcome);
        record(arm, &result, errors, solution);
        return Ok((result, errors));
    }
    arm.with_workspace(|workspace| {
        let (first_end, best) = solution.q.split_at(n);
        workspace.x.copy_from_slice(first_end);
        workspace.best.copy_from_slice(match arm.options.search {
            Search::First => first_end,
            _ => best,
        });
        result.number = best_attempt as usize;
        workspace.set_target(query.target);
        bound_moves(arm, workspace, query.start);
        finish(arm, workspace, query, &mut result);
        record_configuration(arm, &result, workspace, solution);
        (result, workspace.errors)
    })
}

/// Solves a query with a workspace: for `max_move`, comparing searches, postures and mimic joints.
fn solve_with_workspace(
    arm: &Arm,
    workspace: &mut ArmWorkspace,
    query: &Query<'_>,
    solution: &mut Solution,
) -> (SearchResult, Errors) {
    workspace.set_target(query.target);
    bound_moves(arm, workspace, query.start);
    let mut result = if arm.options.search.compares() {
        let termination = collect_solutions(arm, workspace, query);
        nearest(arm, workspace, query, termination)
    } else if arm.simd_solver.is_some() {
        search_by_simd_solver(arm, workspace, query)
    } else {
        search_by_general_solver(arm, workspace, query)
    };
    finish(arm, workspace, query, &mut result);
    if let (true, Some(posture)) = (result.reached, &arm.options.posture) {
        move_towards_posture(arm, workspace, posture, query.deadline);
        judge(arm, workspace, &mut result);
    }
    record_configuration(arm, &result, workspace, solution);
    (result, workspace.errors)
}

/// Searches with the SIMD solver, into the workspace's x.
///
/// On failure x is the end of the attempt from the start, and `best` the best of all attempts, whose number is
/// returned.
fn search_by_simd_solver(
    arm: &Arm,
    workspace: &mut ArmWorkspace,
    query: &Query<'_>,
) -> SearchResult {
    let ArmWorkspace {
        bounded_simd_solver,
        x,
        best,
        ..
    } = workspace;
    let mut first = first_attempts(arm, query);
    // With `max_move` the attempt from the start ends before others begin.
    let first_alone = arm.options.max_move.is_some();
    if first_alone {
        first.attempts.1 = 1;
    }
    let Some(simd_solver) = simd_solver_within(arm, bounded_simd_solver) else {
        return SearchResult::default();
    };
    let mut output = simd_ik::QueryOutput {
        q: x,
        best,
        best_attempt: 0,
    };
    let outcome = simd_solver.race(&first, first_alone, &mut output);
    let best_attempt = output.best_attempt;
    if arm.options.search == Search::First {
        best.copy_from_slice(x);
    }
    workspace.errors = Errors::of(&outcome);
    SearchResult {
        number: outcome.winner.unwrap_or(best_attempt) as usize,
        ..result_of(arm, &outcome)
    }
}

fn first_attempts<'a>(arm: &Arm, query: &Query<'a>) -> simd_ik::Query<'a> {
    let attempts = attempts_at(arm, query.target);
    simd_query(
        arm,
        query,
        (0, attempts),
        arm.options.budget().min(QUICK_ATTEMPT_ITERATIONS),
    )
}
