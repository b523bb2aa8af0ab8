//! Search with the general solver, for chains that the SIMD solver does not support.

use super::arm::Arm;
use super::fallback::{finish, is_nearby};
use super::query::{Query, attempts_at};
use super::recording::{judge, outcome_of};
use super::revolutions::unwrap_towards;
use super::seed_table::SeedTable;
use super::workspace::{ArmWorkspace, stopping};
use kinopt_kinematics::random::RandomStream;
use kinopt_solver::ik::Restarts;
use kinopt_solver::problem::TaskSubset;
use kinopt_solver::search::{Schedule, SearchResult, run};
use kinopt_solver::solver::{LevenbergMarquardt, Silent, Stopping};

/// Number of attempts from the start and from perturbations of it before the table is used.
const START_ATTEMPTS: usize = 2;
/// Largest number of sampled configurations that a query tries: of 240 000 reachable poses 64 fail on two, 128 on none.
const MAX_TABLE_ATTEMPTS: usize = 128;
/// Number of steps without halving the cost after which an attempt from the table ends.
const STALL_STEPS: usize = 10;
/// Number of attempts at the same minimum after which a target counts as out of reach, if no number of attempts is set.
const AGREEING_ATTEMPTS: usize = 10;
/// Largest number of steps of all random attempts, if no number of iterations is set.
const MAX_RANDOM_STEPS: usize = 2500;

/// Searches from the workspace's start, then from sampled configurations near the target, then from random ones.
///
/// A solution is left in the workspace's x. If there is none, x is the start and `best` the best of all attempts.
pub(super) fn search_by_general_solver(
    arm: &Arm,
    workspace: &mut ArmWorkspace,
    query: &Query<'_>,
) -> SearchResult {
    let attempts = attempts_at(arm, query.target) as usize;
    let mut first_iterations = 0;
    if attempts > 1 && is_nearby(arm, workspace) {
        // All that a search of one attempt does comes before other attempts.
        let mut first = make_attempts(arm, workspace, query, 1);
        finish(arm, workspace, query, &mut first);
        if first.reached || query.is_late() {
            return first;
        }
        first_iterations = first.iterations;
    }
    let mut result = make_attempts(arm, workspace, query, attempts);
    result.iterations += first_iterations;
    result
}

/// Makes at most `attempts` attempts.
fn make_attempts(
    arm: &Arm,
    workspace: &mut ArmWorkspace,
    query: &Query<'_>,
    attempts: usize,
) -> SearchResult {
    let mut result = run_restarts(arm, workspace, query, attempts.min(START_ATTEMPTS));
    // If motions are bounded, sampled configurations are far outside the bounds.
    let uses_table = arm.options.max_move.is_none();
    for from_table in [true, false] {
        let remaining = attempts.saturating_sub(result.attempts);
        if result.reached || query.is_late() || remaining == 0 || from_table && !uses_table {
            continue;
        }
        workspace.best.copy_from_slice(&workspace.x);
        let later = match from_table {
            true => run_table_attempts(arm, workspace, query, remaining.min(MAX_TABLE_ATTEMPTS)),
            false => run_restarts(arm, workspace, query, remaining),
        };
        if !result.merge_later(&later) {
            workspace.x.copy_from_slice(&workspace.best);
        }
    }
    if !result.reached {
        workspace.best.copy_from_slice(&workspace.x);
        workspace.x.copy_from_slice(&workspace.start);
    }
    result
}

/// Makes an attempt from each of the nearest sampled configurations, until one reaches; the best is in x.
fn run_table_attempts(
    arm: &Arm,
    workspace: &mut ArmWorkspace,
    query: &Query<'_>,
    max_count: usize,
) -> SearchResult {
    look_up_table_rows(arm, workspace, max_count);
    let mut result = SearchResult::default();
    for rank in 0..workspace.table_rows.len() {
        if let Some(table) = arm.seeds.get() {
            let (_, row) = workspace.table_rows[rank];
            workspace.x.copy_from_slice(table.seed(row));
        }
        let stall_stopping = stopping().with_patience(Some(STALL_STEPS));
        if result.merge_later(&run_general_attempt(arm, workspace, query, &stall_stopping)) {
            workspace.trial.copy_from_slice(&workspace.x);
        }
        if result.reached || query.is_late() {
            break;
        }
    }
    workspace.x.copy_from_slice(&workspace.trial);
    result
}

/// Makes one attempt from the workspace's x and leaves its end there.
fn run_general_attempt(
    arm: &Arm,
    workspace: &mut ArmWorkspace,
    query: &Query<'_>,
    stopping: &Stopping,
) -> SearchResult {
    let (termination, iterations) = workspace.converge_within(stopping, query.deadline);
    unwrap_towards(arm, query.start, workspace);
    let mut result = SearchResult::single_attempt(termination, iterations);
    judge(arm, workspace, &mut result);
    result
}

/// Writes the table's rows nearest to the target to the workspace.
fn look_up_table_rows(arm: &Arm, workspace: &mut ArmWorkspace, max_count: usize) {
    let table = arm
        .seeds
        .get_or_init(|| SeedTable::new(&arm.serial, workspace));
    let goal = &arm.options.goal;
    let weights = (
        f64::from(u8::from(goal.has_position())),
        match goal.has_orientation() {
            true => arm.options.metres_per_radian,
            false => 0.0,
        },
    );
    let target = workspace.target();
    table.nearest(&target, weights, max_count, &mut workspace.table_rows);
}

/// Makes attempts from the workspace's start, from perturbations of it and from random configurations.
///
/// The best is in the workspace's x.
fn run_restarts(
    arm: &Arm,
    workspace: &mut ArmWorkspace,
    query: &Query<'_>,
    attempts: usize,
) -> SearchResult {
    let options = &arm.options;
    let (steps, agreeing) = match (options.iterations, options.attempts_given) {
        (Some(steps), true) => (steps as usize, usize::MAX),
        (Some(steps), false) => (steps as usize, AGREEING_ATTEMPTS),
        (None, true) => (usize::MAX, usize::MAX),
        (None, false) => (MAX_RANDOM_STEPS, AGREEING_ATTEMPTS),
    };
    let restarts = Restarts::default()
        .with_attempts(attempts)
        .with_steps(steps)
        .with_agreeing(agreeing)
        .with_seed(options.seed);
    // Taken out and put back, so that nothing is allocated.
    let mut attempt_loop = std::mem::take(&mut workspace.attempts);
    let instance = workspace.question.instance();
    attempt_loop.fit(instance, TaskSubset::All);
    attempt_loop.start.copy_from_slice(&workspace.start);
    let (method, mut silent) = (LevenbergMarquardt::default(), Silent);
    let mut minimiser = workspace.minimiser(&method, query.deadline, &mut silent);
    let instance = minimiser.instance;
    let searched = (instance, TaskSubset::All);
    let schedule = Schedule::of_searches(searched, restarts, Stopping::default(), false);
    let deadline = query.deadline;
    let mut result = run(
        instance,
        TaskSubset::All,
        &schedule,
        deadline,
        &mut minimiser,
        &mut attempt_loop,
    );
    workspace.x.copy_from_slice(&attempt_loop.keeper.x);
    workspace.attempts = attempt_loop;
    unwrap_towards(arm, query.start, workspace);
    judge(arm, workspace, &mut result);
    result
}

/// Makes attempts `first`, `first + 1`, … with the general solver, and appends their configurations and outcomes.
pub(super) fn append_general_attempts(
    arm: &Arm,
    workspace: &mut ArmWorkspace,
    query: &Query<'_>,
    first: u32,
    count: u32,
) {
    look_up_table_rows(
        arm,
        workspace,
        MAX_TABLE_ATTEMPTS.min((first + count) as usize),
    );
    for attempt in first..first + count {
        workspace.x.copy_from_slice(&workspace.start);
        // Every other attempt begins at a row of the table, as long as there are rows.
        let row = match attempt > 0 && attempt % 2 == 0 {
            true => workspace.table_rows.get(attempt as usize / 2 - 1),
            false => None,
        };
        if let (Some((_, row)), Some(table)) = (row, arm.seeds.get()) {
            workspace.x.copy_from_slice(table.seed(*row));
        } else if attempt > 0 {
            let mut random = RandomStream::new(arm.options.seed, u64::from(attempt));
            let instance = workspace.question.instance();
            for (i, value) in workspace.x.iter_mut().enumerate() {
                let (low, high) = instance.sampling_range(i, workspace.start[i]);
                *value = low + (high - low) * random.unit();
            }
        }
        let mut result = run_general_attempt(arm, workspace, query, &stopping());
        result.number = attempt as usize;
        workspace.attempt_ends.extend_from_slice(&workspace.x);
        let outcome = outcome_of(&result, workspace.errors);
        workspace.outcomes.push(outcome);
    }
}
