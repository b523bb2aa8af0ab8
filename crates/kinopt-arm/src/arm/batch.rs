//! Batches of queries.

use super::arm::Arm;
#[cfg(feature = "collision")]
use super::collision_avoidance::sphere_checks::reject_collisions;
use super::query::{QUICK_ATTEMPT_ITERATIONS, Query, is_plain};
use super::recording::{outcome_of, record, result_of};
use super::solve_query::solve_query;
use super::workspace::Errors;
use super::{PoseOutcome, QueryError};
use crate::simd_ik::{Attempts, PoseSolver, Work};
use kinopt_kinematics::spatial::Placement;
use kinopt_solver::ik::Solution;

/// Number of queries per batch of the SIMD solver: enough to keep the lanes filled.
const CHUNK: usize = 128;
/// Largest number of attempts of a query in a batch; a query that they do not solve is solved alone.
///
/// A single query makes at least as many attempts, so that both give the same result.
const BATCH_ATTEMPTS: u32 = 8;

/// Some of the queries and their output.
pub(super) struct Chunk<'a> {
    targets: &'a [Placement<f64>],
    starts: &'a [f64],
    solutions: &'a mut [Solution],
}

/// Function that solves one chunk.
pub(super) type SolveChunk<'a> = dyn Fn(Chunk<'_>) -> Result<(), QueryError> + Sync + 'a;

/// Solves all queries; `run` executes the chunks, in sequence or on threads.
pub(super) fn solve_chunks(
    arm: &Arm,
    targets: &[Placement<f64>],
    starts: &[f64],
    run: impl FnOnce(Vec<Chunk<'_>>, &SolveChunk<'_>) -> Result<(), QueryError>,
) -> Result<Vec<Solution>, QueryError> {
    check_batch(arm, targets, starts)?;
    let mut solutions = vec![Solution::default(); targets.len()];
    let chunks = targets
        .chunks(CHUNK)
        .zip(starts.chunks(CHUNK * arm.joint_count()))
        .zip(solutions.chunks_mut(CHUNK));
    let chunks = chunks.map(|((targets, starts), solutions)| Chunk {
        targets,
        starts,
        solutions,
    });
    run(chunks.collect(), &|chunk| solve_chunk(arm, chunk))?;
    Ok(solutions)
}

fn solve_chunk(arm: &Arm, chunk: Chunk<'_>) -> Result<(), QueryError> {
    let Chunk {
        targets,
        starts,
        solutions,
    } = chunk;
    let n = arm.joint_count();
    let mut q = vec![0.0; n * targets.len()];
    let mut outcomes = vec![PoseOutcome::default(); targets.len()];
    let is_batched = run_batch(arm, targets, starts, &mut q, &mut outcomes)?;
    let outputs = q.chunks(n).zip(&outcomes).zip(solutions);
    let queries = targets.iter().zip(starts.chunks(n));
    for ((target, start), ((q, outcome), solution)) in queries.zip(outputs) {
        if is_batched && outcome.reached {
            solution.q.extend_from_slice(q);
            record(arm, &result_of(arm, outcome), Errors::of(outcome), solution);
        } else {
            solve_query(arm, &Query::new(arm, target, start), solution)?;
        }
    }
    Ok(())
}

/// Solves queries by a batch of the SIMD solver. Returns false if the options rule that out.
///
/// A batch ignores time limits and small budgets, under which a single query may make fewer attempts. Solutions in
/// collision are marked as not reached.
fn run_batch(
    arm: &Arm,
    targets: &[Placement<f64>],
    starts: &[f64],
    q: &mut [f64],
    outcomes: &mut [PoseOutcome],
) -> Result<bool, QueryError> {
    let options = &arm.options;
    let is_batchable = is_plain(arm)
        && options.time_limit.is_none()
        && options.budget() >= QUICK_ATTEMPT_ITERATIONS;
    let Some(simd_solver) = arm.simd_solver.as_ref().filter(|_| is_batchable) else {
        return Ok(false);
    };
    let attempts = options.attempts.min(BATCH_ATTEMPTS);
    run_attempts(arm, simd_solver, targets, starts, attempts, q, outcomes)?;
    Ok(true)
}

fn run_attempts(
    arm: &Arm,
    simd_solver: &PoseSolver,
    targets: &[Placement<f64>],
    starts: &[f64],
    attempts: u32,
    q: &mut [f64],
    outcomes: &mut [PoseOutcome],
) -> Result<(), QueryError> {
    simd_solver.run(Work {
        targets,
        starts,
        search: arm.options.search.preference(),
        attempts: Attempts::UpTo(attempts),
        deadline: None,
        q,
        outcomes,
    });
    #[cfg(feature = "collision")]
    reject_collisions(arm, q, outcomes)?;
    Ok(())
}

/// Solves a validated batch by at most `attempts` attempts of each query and no further search.
///
/// Queries of an arm without a SIMD solver are not reached.
pub(super) fn outcomes_of_attempts(
    arm: &Arm,
    targets: &[Placement<f64>],
    starts: &[f64],
    attempts: u32,
    q: &mut [f64],
    outcomes: &mut [PoseOutcome],
) -> Result<(), QueryError> {
    match &arm.simd_solver {
        Some(simd_solver) => run_attempts(arm, simd_solver, targets, starts, attempts, q, outcomes),
        None => Ok(()),
    }
}

/// Solves the queries of one chunk into slices.
pub(super) fn outcomes_of_chunk(
    arm: &Arm,
    targets: &[Placement<f64>],
    starts: &[f64],
    q: &mut [f64],
    outcomes: &mut [PoseOutcome],
) -> Result<(), QueryError> {
    let n = arm.joint_count();
    let is_batched = run_batch(arm, targets, starts, q, outcomes)?;
    let mut solution =
        arm.with_workspace(|workspace| std::mem::take(&mut workspace.batch_solution))?;
    let queries = targets.iter().zip(starts.chunks(n));
    for ((target, start), (q, outcome)) in queries.zip(q.chunks_mut(n).zip(outcomes)) {
        if is_batched && outcome.reached {
            continue;
        }
        let (result, errors) = solve_query(arm, &Query::new(arm, target, start), &mut solution)?;
        q.copy_from_slice(&solution.q);
        *outcome = outcome_of(&result, errors);
    }
    arm.with_workspace(|workspace| workspace.batch_solution = solution)
}

/// Solves a validated batch as [`outcomes_of_chunk`] does, over the threads of the current rayon pool.
#[cfg(feature = "rayon")]
pub(super) fn outcomes_of_chunks(
    arm: &Arm,
    targets: &[Placement<f64>],
    starts: &[f64],
    q: &mut [f64],
    outcomes: &mut [PoseOutcome],
) -> Result<(), QueryError> {
    use rayon::prelude::*;
    let n = arm.joint_count();
    targets
        .par_chunks(CHUNK)
        .zip(starts.par_chunks(CHUNK * n))
        .zip(q.par_chunks_mut(CHUNK * n))
        .zip(outcomes.par_chunks_mut(CHUNK))
        .try_for_each(|(((targets, starts), q), outcomes)| {
            outcomes_of_chunk(arm, targets, starts, q, outcomes)
        })
}

/// Checks the input and output slices of a batch.
pub(super) fn check_batch_into(
    arm: &Arm,
    targets: &[Placement<f64>],
    starts: &[f64],
    q: &[f64],
    outcomes: &[PoseOutcome],
) -> Result<(), QueryError> {
    check_batch(arm, targets, starts)?;
    arm.check_length("q", q.len(), arm.joint_count() * targets.len())?;
    arm.check_length("outcomes", outcomes.len(), targets.len())
}

fn check_batch(arm: &Arm, targets: &[Placement<f64>], starts: &[f64]) -> Result<(), QueryError> {
    let n = arm.joint_count();
    arm.check_length("starts", starts.len(), n * targets.len())?;
    for (query, (target, start)) in targets.iter().zip(starts.chunks(n)).enumerate() {
        arm.check_query(Some(query), target, start)?;
    }
    Ok(())
}
