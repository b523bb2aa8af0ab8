//! Fallbacks of a query whose first attempts fail.

use super::arm::Arm;
use super::distances::{MAX_JOINT_STEP, largest_joint_move};
use super::local_descent::LocalDescent;
use super::options::Search;
use super::query::{
    QUICK_ATTEMPT_ITERATIONS, Query, needs_only_first_attempt, simd_query, simd_solver_within,
};
use super::recording::{cost_of, judge, result_of};
use super::revolutions::unwrap_towards;
use super::workspace::{ArmWorkspace, Errors};
use crate::simd_ik;
use kinopt_solver::problem::MAX_NEARBY_ERROR;
use kinopt_solver::search::SearchResult;
use kinopt_solver::solver::Termination;

/// Largest number of short steps from the start towards a near solution.
const MAX_NEAR_STEPS: usize = 100;

/// Continues failed attempts with the general solver: the first, whose end is in the workspace's x, then the best,
/// then the remaining ones.
///
/// For a target near the start, all that a search of one attempt does comes before the remaining attempts. If none
/// reaches, the result is the end of the first attempt, unless the arm searches globally on failure.
pub(super) fn finish(
    arm: &Arm,
    workspace: &mut ArmWorkspace,
    query: &Query<'_>,
    result: &mut SearchResult,
) {
    if result.reached {
        return;
    }
    let best = result.number;
    // Under `First`, x is the best of all attempts already.
    if arm.options.search != Search::First {
        result.number = 0;
    }
    converge(arm, workspace, query, result);
    let stays_on_branch = !arm.options.searches_globally();
    let nearby = stays_on_branch && is_nearby(arm, workspace);
    let mut searched_near = false;
    if !result.reached && !needs_only_first_attempt(arm, query.target) && !query.is_late() {
        let mut first = save_first(workspace, result);
        result.number = best;
        workspace.x.copy_from_slice(&workspace.best);
        converge(arm, workspace, query, result);
        if nearby && !result.reached && !query.is_late() {
            restore_first(workspace, &first, result);
            search_near_start(arm, workspace, query, result);
            searched_near = true;
            first = save_first(workspace, result);
        }
        if !result.reached {
            run_remaining_attempts(arm, workspace, query, result);
        }
        let has_lower_cost = !stays_on_branch && result.cost < first.0.cost;
        if !result.reached && !has_lower_cost {
            restore_first(workspace, &first, result);
        }
    }
    if !result.reached && stays_on_branch && !searched_near && !query.is_late() {
        search_near_start(arm, workspace, query, result);
    }
    result.termination = final_termination(arm, result, query.is_late());
}

/// Continues the first attempt alone, whose end is in the workspace's x, as a search of one attempt does.
pub(super) fn finish_first(
    arm: &Arm,
    workspace: &mut ArmWorkspace,
    query: &Query<'_>,
    result: &mut SearchResult,
) {
    converge(arm, workspace, query, result);
    if !result.reached && !arm.options.searches_globally() && !query.is_late() {
        search_near_start(arm, workspace, query, result);
    }
}

/// Returns true if the target is near the tool at the start, so that the first attempt is finished before others
/// begin.
pub(super) fn is_nearby(arm: &Arm, workspace: &mut ArmWorkspace) -> bool {
    // Taken out and put back, so that nothing is allocated.
    let start = std::mem::take(&mut workspace.start);
    let errors = workspace.judge(&start);
    workspace.start = start;
    let radians = MAX_NEARBY_ERROR * arm.options.metres_per_radian;
    2.0 * cost_of(arm, errors) < radians * radians
}

/// Saves the end of the first attempt, which is in the workspace's x.
fn save_first(workspace: &mut ArmWorkspace, result: &SearchResult) -> (SearchResult, Errors) {
    let ArmWorkspace { saved, x, .. } = workspace;
    saved.copy_from_slice(x);
    (*result, workspace.errors)
}

/// Restores the saved end of the first attempt.
fn restore_first(
    workspace: &mut ArmWorkspace,
    (first, errors): &(SearchResult, Errors),
    result: &mut SearchResult,
) {
    result.restore_best(first);
    let ArmWorkspace { saved, x, .. } = workspace;
    x.copy_from_slice(saved);
    workspace.errors = *errors;
}

/// Replaces an end far from the start by the minimum that short steps from the start lead to, if that is near.
///
/// The long steps of an attempt may have passed it. An end near the start is only moved off a ridge.
fn search_near_start(
    arm: &Arm,
    workspace: &mut ArmWorkspace,
    query: &Query<'_>,
    result: &mut SearchResult,
) {
    let displacement =
        |workspace: &ArmWorkspace| largest_joint_move(arm, &workspace.start, &workspace.x).1;
    if displacement(workspace) <= MAX_JOINT_STEP {
        leave_ridge(arm, workspace, query, result);
        return;
    }
    // Taken out and put back, so that nothing is allocated.
    let mut saved = std::mem::take(&mut workspace.saved);
    saved.copy_from_slice(&workspace.x);
    workspace.x.copy_from_slice(&workspace.start);
    let descent = LocalDescent::without_anchor(MAX_NEAR_STEPS, query.deadline);
    let (_, steps) = workspace.descend(&descent);
    result.iterations += steps;
    let is_near = displacement(workspace) <= MAX_JOINT_STEP;
    if is_near {
        saved.copy_from_slice(&workspace.x);
        let (termination, iterations) = workspace.converge(query.deadline);
        result.iterations += iterations;
        result.termination = termination;
    }
    if displacement(workspace) > MAX_JOINT_STEP {
        workspace.x.copy_from_slice(&saved);
    }
    workspace.saved = saved;
    if is_near {
        judge(arm, workspace, result);
    }
}

/// Continues from a perturbed configuration if an end near the start is a ridge.
///
/// A stretched arm whose target is within reach is stationary there. The end stays unless the continuation reaches
/// the target near the start.
fn leave_ridge(
    arm: &Arm,
    workspace: &mut ArmWorkspace,
    query: &Query<'_>,
    result: &mut SearchResult,
) {
    let first = save_first(workspace, result);
    if workspace.step_off_ridge() {
        converge(arm, workspace, query, result);
        let is_near = largest_joint_move(arm, &workspace.start, &workspace.x).1 <= MAX_JOINT_STEP;
        if !(result.reached && is_near) {
            restore_first(workspace, &first, result);
        }
    }
}

/// Termination of a finished query.
pub(super) fn final_termination(arm: &Arm, result: &SearchResult, is_late: bool) -> Termination {
    if result.reached {
        Termination::Reached
    } else if is_late {
        Termination::TimeLimit
    } else if arm.options.max_move.is_some() {
        Termination::CannotContinue
    } else {
        // The descent stopped as reached, but the error is slightly above the tolerance.
        match result.termination {
            Termination::Reached => Termination::SmallStep,
            termination => termination,
        }
    }
}

/// Runs the remaining attempts and continues the best of them.
///
/// The better of its end and the workspace's x is then in x and `result`.
fn run_remaining_attempts(
    arm: &Arm,
    workspace: &mut ArmWorkspace,
    query: &Query<'_>,
    result: &mut SearchResult,
) {
    let Some(simd_solver) = simd_solver_within(arm, &workspace.bounded_simd_solver) else {
        return;
    };
    let first = u32::try_from(result.attempts).unwrap_or(u32::MAX);
    let used_iterations = u32::try_from(result.iterations).unwrap_or(u32::MAX);
    let attempts = (first, arm.options.attempts);
    let budget = arm
        .options
        .budget()
        .saturating_sub(used_iterations.min(QUICK_ATTEMPT_ITERATIONS));
    if result.reached || query.is_late() || first >= attempts.1 || budget == 0 {
        return;
    }
    let remaining = simd_query(arm, query, attempts, budget);
    let mut output = simd_ik::QueryOutput::of(&mut workspace.trial);
    let outcome = simd_solver.race(&remaining, false, &mut output);
    let best_attempt = output.best_attempt as usize;
    let remaining_result = result_of(arm, &outcome);
    result.iterations += remaining_result.iterations;
    result.attempts += remaining_result.attempts;
    if remaining_result.reached {
        workspace.x.copy_from_slice(&workspace.trial);
        workspace.errors = Errors::of(&outcome);
        (result.number, result.cost, result.reached) =
            (remaining_result.number, remaining_result.cost, true);
    } else if remaining_result.cost < result.cost {
        workspace.x.copy_from_slice(&workspace.trial);
        result.number = best_attempt;
        converge(arm, workspace, query, result);
    }
}

fn converge(arm: &Arm, workspace: &mut ArmWorkspace, query: &Query<'_>, result: &mut SearchResult) {
    let (termination, iterations) = workspace.converge(query.deadline);
    result.iterations += iterations;
    result.termination = termination;
    unwrap_towards(arm, query.start, workspace);
    judge(arm, workspace, result);
}
