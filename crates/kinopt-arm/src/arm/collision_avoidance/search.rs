//! Search for a collision-free solution.

use super::avoidance::CollisionAvoidance;
use super::checks::MAX_EXACT_CHECKS;
use super::checks::with_collision_workspace;
use super::min_penetration::{check_solution, move_to_min_penetration};
use super::null_space_avoidance::avoid_in_null_space;
use super::workspace::CollisionWorkspace;
use crate::arm::QueryError;
use crate::arm::arm::Arm;
use crate::arm::dispatch::solve_without_avoidance;
use crate::arm::move_bounds::bound_moves;
use crate::arm::multi_solution::{collect_solutions, run_attempts, total_iterations};
use crate::arm::query::{Query, attempts_at, simd_solver_within};
use crate::arm::recording::{judge, record_configuration};
use crate::arm::workspace::{ArmWorkspace, Errors};
use crate::simd_ik::{self, PoseOutcome};
use crate::simd_spheres::CHECKED;
use kinopt_solver::ik::Solution;
use kinopt_solver::search::SearchResult;
use kinopt_solver::solver::Termination;

/// Number of collision-free starts that suffices for a group of attempts; 2 and 8 measured slower on MotionBenchMaker.
const MIN_FREE_STARTS: usize = 4;
/// Number of cells of the atlas after which a single collision-free start suffices.
const MAX_CELLS: usize = 4;

/// Solves a query by a collision-free solution, if one is found.
pub(in crate::arm) fn solve_collision_free(
    arm: &Arm,
    avoidance: &CollisionAvoidance,
    query: &Query<'_>,
    solution: &mut Solution,
) -> Result<(SearchResult, Errors), QueryError> {
    let checked_query = avoidance.with_time_for_check(query);
    let (mut result, mut errors) = solve_without_avoidance(arm, &checked_query, solution)?;
    with_collision_workspace(arm, avoidance, |workspace, checks| {
        (checks.deadline, checks.contacts) = (checked_query.deadline, None);
        let free = result.reached && avoidance.is_clear(arm, checks, &solution.q)?;
        if result.reached && !free {
            workspace.x.copy_from_slice(&solution.q);
            search_collision_free(
                arm,
                avoidance,
                workspace,
                checks,
                &checked_query,
                &mut result,
            )?;
            let free = result.reached;
            judge(arm, workspace, &mut result);
            result.reached &= free;
            record_configuration(arm, &result, workspace, solution);
            errors = workspace.errors;
        }
        if !result.reached {
            let contacts = match checks.contacts.take() {
                Some(contacts) => contacts,
                None => avoidance.collisions(arm, checks, &solution.q)?,
            };
            solution.set_collisions(contacts);
        }
        Ok((result, errors))
    })
}

/// Searches attempts for a collision-free one, in the order of the search preference.
///
/// The workspace's x becomes that one, or else the one of least penetration. The deadline of `query` leaves the time for
/// the check of the report.
fn search_collision_free(
    arm: &Arm,
    avoidance: &CollisionAvoidance,
    workspace: &mut ArmWorkspace,
    checks: &mut CollisionWorkspace,
    query: &Query<'_>,
    result: &mut SearchResult,
) -> Result<(), QueryError> {
    workspace.set_target(query.target);
    bound_moves(arm, workspace, query.start);
    if avoidance.never_free {
        (result.reached, result.termination) = (false, Termination::Stationary);
        return Ok(());
    }
    if query.is_late() {
        (result.reached, result.termination) = (false, Termination::TimeLimit);
        return Ok(());
    }
    if query.deadline.is_some() {
        // Now instead of after the deadline.
        check_solution(arm, avoidance, workspace, checks)?;
    }
    let previous = (result.iterations, result.attempts);
    checks.exact_checks_left = MAX_EXACT_CHECKS;
    let free = match arm.options.search.compares() {
        true => {
            collect_solutions(arm, workspace, query);
            first_collision_free(arm, avoidance, workspace, checks, query, 0)?
        }
        false => lowest_collision_free(arm, avoidance, workspace, checks, query)?,
    };
    result.iterations = previous.0 + total_iterations(&workspace.outcomes);
    result.attempts = previous.1 + workspace.outcomes.len();
    result.reached = free.is_some();
    if let Some(index) = free {
        workspace.move_to_attempt_end(index);
        checks.contacts = None;
        result.termination = Termination::Reached;
        // Numbered after the attempts of the plain solution.
        result.number = previous.1 + index;
        return Ok(());
    }
    let min_distance = move_to_min_penetration(arm, avoidance, workspace, checks, query)?;
    // This search may make as many attempts as the plain solution.
    let remaining = (2 * attempts_at(arm, query.target) as usize).saturating_sub(result.attempts);
    let (free, steps) = avoid_in_null_space(
        arm,
        avoidance,
        workspace,
        checks,
        query,
        (min_distance, remaining),
    )?;
    result.attempts += steps.attempts;
    result.iterations += steps.iterations;
    if free {
        (result.reached, result.number) = (true, result.attempts - 1);
    }
    result.termination = match (free, query.is_late()) {
        (true, _) => Termination::Reached,
        (_, true) => Termination::TimeLimit,
        _ => Termination::Stationary,
    };
    Ok(())
}

/// Runs attempts in groups until one is collision-free.
///
/// The first half at most begins at the atlas's configurations near the target; the numbered attempts follow.
fn lowest_collision_free(
    arm: &Arm,
    avoidance: &CollisionAvoidance,
    workspace: &mut ArmWorkspace,
    checks: &mut CollisionWorkspace,
    query: &Query<'_>,
) -> Result<Option<usize>, QueryError> {
    workspace.attempt_ends.clear();
    workspace.outcomes.clear();
    workspace.ranking.clear();
    let wanted = attempts_at(arm, query.target);
    let budget = arm
        .options
        .iterations
        .map_or(usize::MAX, |limit| limit as usize);
    let neighbour_limit = wanted / 2;
    let (mut first, mut cells) = (0, Some(0));
    loop {
        let first_index = workspace.outcomes.len();
        let made_attempts = first_index as u32;
        if made_attempts >= wanted
            || total_iterations(&workspace.outcomes) >= budget
            || query.is_late()
        {
            break;
        }
        match cells.filter(|_| made_attempts < neighbour_limit) {
            Some(from) => {
                let limit = (neighbour_limit - made_attempts) as usize;
                cells = run_neighbour_attempts(
                    arm,
                    avoidance,
                    workspace,
                    checks,
                    query,
                    (from, limit),
                )?;
            }
            None => {
                // Groups grow, as finished lanes take further attempts, unless a deadline must be checked.
                let group_growth = query.deadline.map_or(first / 2, |_| 0);
                let count = group_growth.max(CHECKED as u32).min(wanted - made_attempts);
                run_attempts(arm, workspace, query, first, count);
                first += count;
            }
        }
        let first_unchecked = workspace.ranking.len();
        for index in first_index..workspace.outcomes.len() {
            if workspace.outcomes[index].reached {
                workspace.ranking.push((0.0, index));
            }
        }
        let free = first_collision_free(arm, avoidance, workspace, checks, query, first_unchecked)?;
        if free.is_some() {
            return Ok(free);
        }
    }
    Ok(None)
}

/// Runs at most `max_count` attempts from the atlas's configurations in cells around the target, from cell `from`
/// on.
///
/// Only starts whose spheres are collision-free run, as a start is close to its solution. Returns the next cell, if
/// there are more.
fn run_neighbour_attempts(
    arm: &Arm,
    avoidance: &CollisionAvoidance,
    workspace: &mut ArmWorkspace,
    checks: &mut CollisionWorkspace,
    query: &Query<'_>,
    (from, max_count): (usize, usize),
) -> Result<Option<usize>, QueryError> {
    let n = arm.joint_count();
    let Some(simd_solver) = simd_solver_within(arm, &workspace.bounded_simd_solver) else {
        return Ok(None);
    };
    let (mut seeds, mut free) = (std::mem::take(&mut checks.seeds), 0);
    seeds.clear();
    let mut next = Some(from);
    while free == 0 || free < MIN_FREE_STARTS && next.is_some_and(|cell| cell < from + MAX_CELLS) {
        // As many cells as fill the lanes.
        while let Some(cell) = next
            && seeds.len() < (free + CHECKED) * n
        {
            let has_more = simd_solver.neighbour_seeds(query.target, cell..cell + 1, &mut seeds);
            next = has_more.then_some(cell + 1);
        }
        let gathered = free..seeds.len() / n;
        if gathered.is_empty() {
            break;
        }
        for first in gathered.clone().step_by(CHECKED) {
            if avoidance.is_late(query) {
                next = None;
                break;
            }
            let group = first..(first + CHECKED).min(gathered.end);
            let bits =
                avoidance.free_by_spheres(arm, checks, &seeds[group.start * n..group.end * n])?;
            for index in group {
                if bits >> (index - first) & 1 != 0 {
                    seeds.copy_within(index * n..(index + 1) * n, free * n);
                    free += 1;
                }
            }
        }
        seeds.truncate(free * n);
        if avoidance.is_late(query) {
            break;
        }
    }
    let free = free.min(max_count);
    seeds.truncate(free * n);
    let first_index = workspace.outcomes.len();
    let end = first_index + free;
    workspace.attempt_ends.resize(end * n, 0.0);
    workspace.outcomes.resize(end, PoseOutcome::default());
    checks.targets.clear();
    checks.targets.resize(free, *query.target);
    simd_solver.run(simd_ik::Work {
        targets: &checks.targets,
        starts: &seeds,
        search: simd_ik::Prefer::Start,
        attempts: simd_ik::Attempts::UpTo(1),
        deadline: query.deadline,
        q: &mut workspace.attempt_ends[first_index * n..],
        outcomes: &mut workspace.outcomes[first_index..],
    });
    for q in workspace.attempt_ends[first_index * n..].chunks_exact_mut(n) {
        simd_solver.unwrap_towards(query.start, q);
    }
    checks.seeds = seeds;
    Ok(next)
}

/// Index of the first collision-free solution in the workspace's order, from `from` on.
///
/// Solutions are checked by spheres, and by shapes as long as more such checks are allowed.
fn first_collision_free(
    arm: &Arm,
    avoidance: &CollisionAvoidance,
    workspace: &ArmWorkspace,
    checks: &mut CollisionWorkspace,
    query: &Query<'_>,
    from: usize,
) -> Result<Option<usize>, QueryError> {
    let mut configurations = std::mem::take(&mut checks.group_configurations);
    let mut first = None;
    for group in workspace.ranking[from..].chunks(CHECKED) {
        if avoidance.is_late(query) {
            break;
        }
        configurations.clear();
        for (_, index) in group {
            configurations.extend_from_slice(workspace.attempt_end(*index));
        }
        let by_spheres = avoidance.free_by_spheres(arm, checks, &configurations)?;
        for (lane, (_, index)) in group.iter().enumerate() {
            let q = workspace.attempt_end(*index);
            let free = if by_spheres >> lane & 1 != 0 {
                avoidance.are_close_pairs_free(arm, checks, q)?
            } else if checks.exact_checks_left > 0 && !avoidance.is_late(query) {
                checks.exact_checks_left -= 1;
                avoidance.is_free_by_shapes(arm, checks, q)?
            } else {
                false
            };
            if free {
                first = Some(*index);
                break;
            }
        }
        if first.is_some() {
            break;
        }
    }
    checks.group_configurations = configurations;
    Ok(first)
}
