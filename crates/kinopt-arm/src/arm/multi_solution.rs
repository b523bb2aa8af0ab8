//! Searches that compare solutions: the nearest, and several distinct ones.

use super::all_solutions::collect_complete_set;
use super::arm::Arm;
use super::distances::weighted_distance;
use super::fallback::finish_first;
use super::general_solver::append_general_attempts;
use super::query::{Query, attempts_at, needs_only_first_attempt, simd_solver_within};
use super::recording::{cost_of, judge, outcome_of, record, result_of};
use super::toward_posture::move_towards_posture;
use super::workspace::{ArmWorkspace, Errors};
use crate::simd_ik::{self, PoseOutcome};
use kinopt_solver::ik::Solution;
use kinopt_solver::search::SearchResult;
use kinopt_solver::solver::Termination;

/// Distance of a start from a limit, radians or metres, below which the nearest solution may end at the limit.
const NEAR_LIMIT: f64 = 0.01;
/// Number of attempts between two checks of the budget.
const GROUP_ATTEMPTS: u32 = 16;
/// Number of attempts between two checks of the clock, with a time limit: one lock step.
const TIMED_GROUP_ATTEMPTS: u32 = 8;
/// Number of the nearest solutions that are moved towards the start.
const MAX_REFINED_SOLUTIONS: usize = 6;

/// Collects solutions and sorts them by their distance from the start: a complete set, or else those of attempts.
///
/// The termination shows if all attempts were run, or if the time limit ended them.
pub(super) fn collect_solutions(
    arm: &Arm,
    workspace: &mut ArmWorkspace,
    query: &Query<'_>,
) -> Termination {
    if !starts_near_limit(arm, query.start) && collect_complete_set(arm, workspace, query) {
        // The result is never farther away than that of the attempt from the start.
        run_attempts(arm, workspace, query, 0, 1);
        rank_by_distance(arm, workspace);
        return Termination::Reached;
    }
    collect_attempts(arm, workspace, query)
}

/// Returns whether a joint starts next to a limit. Within the tolerances the nearest solution may then end at a limit
/// that all exact solutions exceed.
fn starts_near_limit(arm: &Arm, start: &[f64]) -> bool {
    let mut joints = start.iter().zip(arm.limits());
    joints.any(|(q, limits)| (q - limits.lower).min(limits.upper - q) < NEAR_LIMIT)
}

/// Runs the attempts of a query and sorts those that reach by their distance from the start.
pub(super) fn collect_attempts(
    arm: &Arm,
    workspace: &mut ArmWorkspace,
    query: &Query<'_>,
) -> Termination {
    collect_solutions_from(arm, workspace, query, 0)
}

/// Collects the solutions of the attempts `first_attempt`, `first_attempt + 1`, …, as many as a query makes.
pub(super) fn collect_solutions_from(
    arm: &Arm,
    workspace: &mut ArmWorkspace,
    query: &Query<'_>,
    first_attempt: u32,
) -> Termination {
    let end = first_attempt.saturating_add(attempts_at(arm, query.target));
    let iterations = arm.options.iterations;
    let budget = iterations.map_or(usize::MAX, |limit| limit as usize);
    workspace.attempt_ends.clear();
    workspace.outcomes.clear();
    let mut next = first_attempt;
    while next < end && total_iterations(&workspace.outcomes) < budget {
        let group = match query.deadline {
            Some(_) => TIMED_GROUP_ATTEMPTS,
            None => GROUP_ATTEMPTS,
        };
        let count = group.min(end - next);
        run_attempts(arm, workspace, query, next, count);
        if next == 0 && !query.is_late() {
            continue_first(arm, workspace, query);
        }
        next += count;
        if query.is_late() {
            break;
        }
    }
    rank_by_distance(arm, workspace);
    if query.is_late() && next < end {
        Termination::TimeLimit
    } else {
        Termination::Reached
    }
}

/// Sorts the solutions by their distance from the start.
fn rank_by_distance(arm: &Arm, workspace: &mut ArmWorkspace) {
    let n = arm.joint_count();
    workspace.ranking.clear();
    for (index, outcome) in workspace.outcomes.iter().enumerate() {
        if outcome.reached {
            let q = &workspace.attempt_ends[index * n..(index + 1) * n];
            let distance = weighted_distance(arm, q, &workspace.start);
            workspace.ranking.push((distance, index));
        }
    }
    // By distance, then by number: no two are equal.
    let ranking = &mut workspace.ranking;
    ranking.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
}

/// Continues the first attempt, if it failed, as a search of one attempt does.
fn continue_first(arm: &Arm, workspace: &mut ArmWorkspace, query: &Query<'_>) {
    let Some(outcome) = workspace.outcomes.first() else {
        return;
    };
    let mut result = result_of(arm, outcome);
    if result.reached || needs_only_first_attempt(arm, query.target) {
        return;
    }
    workspace.move_to_attempt_end(0);
    finish_first(arm, workspace, query, &mut result);
    if result.reached {
        let n = arm.joint_count();
        workspace.attempt_ends[..n].copy_from_slice(&workspace.x);
        workspace.outcomes[0] = outcome_of(&result, workspace.errors);
    }
}

/// Runs attempts `first`, `first + 1`, … and appends their configurations and outcomes.
pub(super) fn run_attempts(
    arm: &Arm,
    workspace: &mut ArmWorkspace,
    query: &Query<'_>,
    first: u32,
    count: u32,
) {
    let n = arm.joint_count();
    let Some(simd_solver) = simd_solver_within(arm, &workspace.bounded_simd_solver) else {
        return append_general_attempts(arm, workspace, query, first, count);
    };
    let first_index = workspace.outcomes.len();
    let end = first_index + count as usize;
    workspace.attempt_ends.resize(end * n, 0.0);
    workspace.outcomes.resize(end, PoseOutcome::default());
    simd_solver.run(simd_ik::Work {
        targets: std::slice::from_ref(query.target),
        starts: query.start,
        search: simd_ik::Prefer::Start,
        attempts: simd_ik::Attempts::From(first),
        deadline: query.deadline,
        q: &mut workspace.attempt_ends[first_index * n..],
        outcomes: &mut workspace.outcomes[first_index..],
    });
}

/// Writes the nearest solution to the workspace's x; for a redundant arm it is first moved towards the start.
///
/// `termination` is the termination of the attempts.
pub(super) fn nearest(
    arm: &Arm,
    workspace: &mut ArmWorkspace,
    query: &Query<'_>,
    termination: Termination,
) -> SearchResult {
    let n = arm.joint_count();
    let mut result = SearchResult {
        termination,
        iterations: total_iterations(&workspace.outcomes),
        attempts: workspace.outcomes.len(),
        ..SearchResult::default()
    };
    let Some(&(_, index)) = workspace.ranking.first() else {
        // No attempt reached: use the end of the first and the best of all.
        let cost = |outcome: &PoseOutcome| cost_of(arm, Errors::of(outcome));
        let costs = workspace.outcomes.iter().map(cost).enumerate();
        let best = costs.min_by(|a, b| a.1.total_cmp(&b.1));
        let best = best.map_or(0, |best| best.0);
        workspace.x.copy_from_slice(&workspace.attempt_ends[..n]);
        let q = &workspace.attempt_ends[best * n..(best + 1) * n];
        workspace.best.copy_from_slice(q);
        result.number = best;
        judge(arm, workspace, &mut result);
        return result;
    };
    workspace.move_to_attempt_end(index);
    result.number = index;
    if arm.has_null_space() {
        let mut best = f64::INFINITY;
        // Taken out and put back, so that nothing is allocated.
        let reference = std::mem::take(&mut workspace.start);
        let refined = workspace.ranking.len().min(MAX_REFINED_SOLUTIONS);
        for rank in 0..refined {
            if rank > 0 && query.is_late() {
                result.termination = Termination::TimeLimit;
                break;
            }
            let index = workspace.ranking[rank].1;
            workspace.move_to_attempt_end(index);
            move_towards_posture(arm, workspace, &reference, query.deadline);
            let distance = weighted_distance(arm, &workspace.x, &reference);
            if distance < best {
                best = distance;
                result.number = index;
                workspace.best.copy_from_slice(&workspace.x);
            }
        }
        workspace.start = reference;
        workspace.x.copy_from_slice(&workspace.best);
    }
    judge(arm, workspace, &mut result);
    result
}

/// Indices of the first `k` solutions that are farther than `distance` from those before.
pub(super) fn distinct_ends(
    arm: &Arm,
    workspace: &ArmWorkspace,
    k: usize,
    distance: f64,
) -> Vec<usize> {
    let mut chosen: Vec<usize> = Vec::new();
    for &(_, index) in &workspace.ranking {
        if chosen.len() >= k {
            break;
        }
        let q = workspace.attempt_end(index);
        let is_distinct =
            |&other: &usize| weighted_distance(arm, q, workspace.attempt_end(other)) > distance;
        if chosen.iter().all(is_distinct) {
            chosen.push(index);
        }
    }
    chosen
}

/// The solutions of [`distinct_ends`]. `termination` is the termination of the attempts.
pub(super) fn distinct(
    arm: &Arm,
    workspace: &ArmWorkspace,
    k: usize,
    distance: f64,
    termination: Termination,
) -> Vec<Solution> {
    let ends = distinct_ends(arm, workspace, k, distance).into_iter();
    let solutions = ends.map(|index| {
        let outcome = &workspace.outcomes[index];
        let mut solution = Solution::default();
        solution.q.extend_from_slice(workspace.attempt_end(index));
        let result = SearchResult {
            termination,
            ..result_of(arm, outcome)
        };
        record(arm, &result, Errors::of(outcome), &mut solution);
        solution
    });
    solutions.collect()
}

/// Iterations of all attempts together.
pub(super) fn total_iterations(outcomes: &[PoseOutcome]) -> usize {
    outcomes.iter().map(|o| o.iterations as usize).sum()
}
