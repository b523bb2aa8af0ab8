//! Batches of queries.

use super::arm::Arm;
use super::dispatch::QUICK_ATTEMPT_ITERATIONS;
use super::workspace::Errors;
use super::{PoseOutcome, QueryError};
use crate::simd_ik::{Attempts, Work};
use kinopt_kinematics::spatial::Placement;
use kinopt_solver::ik::Solution;
use kinopt_solver::search::SearchResult;

/// Number of queries per batch of the SIMD solver: enough to keep the lanes filled.
const CHUNK: usize = 128;
/// Largest number of attempts of a query in a batch; a query that they do not solve is solved alone.
///
/// A single query makes at least as many attempts, so that both give the same result.
const BATCH_ATTEMPTS: u32 = 8;

/// Some of the queries and their output.
struct Chunk<'a> {
    targets: &'a [Placement<f64>],
    starts: &'a [f64],
    solutions: &'a mut [Solution],
}

/// Function that solves one chunk.
type SolveChunk<'a> = dyn Fn(Chunk<'_>) -> Result<(), QueryError> + Sync + 'a;

impl Arm {
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
        self.solve_chunks(base_from_tools, starts, |chunks, solve| {
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
        self.solve_chunks(base_from_tools, starts, |chunks, solve| {
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
        self.check_batch_into(base_from_tools, starts, q, outcomes)?;
        self.outcomes_of_chunk(base_from_tools, starts, q, outcomes)
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
        use rayon::prelude::*;
        self.check_batch_into(base_from_tools, starts, q, outcomes)?;
        let n = self.joint_count();
        base_from_tools
            .par_chunks(CHUNK)
            .zip(starts.par_chunks(CHUNK * n))
            .zip(q.par_chunks_mut(CHUNK * n))
            .zip(outcomes.par_chunks_mut(CHUNK))
            .try_for_each(|(((targets, starts), q), outcomes)| {
                self.outcomes_of_chunk(targets, starts, q, outcomes)
            })
    }

    /// Solves all queries; `run` executes the chunks, in sequence or on threads.
    fn solve_chunks(
        &self,
        targets: &[Placement<f64>],
        starts: &[f64],
        run: impl FnOnce(Vec<Chunk<'_>>, &SolveChunk<'_>) -> Result<(), QueryError>,
    ) -> Result<Vec<Solution>, QueryError> {
        self.check_batch(targets, starts)?;
        let mut solutions = vec![Solution::default(); targets.len()];
        let chunks = targets
            .chunks(CHUNK)
            .zip(starts.chunks(CHUNK * self.joint_count()))
            .zip(solutions.chunks_mut(CHUNK));
        let chunks = chunks.map(|((targets, starts), solutions)| Chunk {
            targets,
            starts,
            solutions,
        });
        run(chunks.collect(), &|chunk| self.solve_chunk(chunk))?;
        Ok(solutions)
    }

    fn solve_chunk(&self, chunk: Chunk<'_>) -> Result<(), QueryError> {
        let Chunk {
            targets,
            starts,
            solutions,
        } = chunk;
        let n = self.joint_count();
        let mut q = vec![0.0; n * targets.len()];
        let mut outcomes = vec![PoseOutcome::default(); targets.len()];
        let is_batched = self.run_batch(targets, starts, &mut q, &mut outcomes)?;
        let outputs = q.chunks(n).zip(&outcomes).zip(solutions);
        let queries = targets.iter().zip(starts.chunks(n));
        for ((target, start), ((q, outcome), solution)) in queries.zip(outputs) {
            if is_batched && outcome.reached {
                solution.q.extend_from_slice(q);
                self.record(&self.result_of(outcome), Errors::of(outcome), solution);
            } else {
                self.solve_query(&self.query(target, start), solution)?;
            }
        }
        Ok(())
    }

    /// Solves queries by a batch of the SIMD solver. Returns false if the options rule that out.
    ///
    /// A batch ignores time limits and small budgets, under which a single query may make fewer attempts. Solutions in
    /// collision are marked as not reached.
    fn run_batch(
        &self,
        targets: &[Placement<f64>],
        starts: &[f64],
        q: &mut [f64],
        outcomes: &mut [PoseOutcome],
    ) -> Result<bool, QueryError> {
        let options = &self.options;
        let is_batchable = self.is_plain()
            && options.time_limit.is_none()
            && options.budget() >= QUICK_ATTEMPT_ITERATIONS;
        let Some(simd_solver) = self.simd_solver.as_ref().filter(|_| is_batchable) else {
            return Ok(false);
        };
        simd_solver.run(Work {
            targets,
            starts,
            search: options.search.preference(),
            attempts: Attempts::UpTo(options.attempts.min(BATCH_ATTEMPTS)),
            deadline: None,
            q,
            outcomes,
        });
        #[cfg(feature = "collision")]
        self.reject_collisions(q, outcomes)?;
        Ok(true)
    }

    fn outcomes_of_chunk(
        &self,
        targets: &[Placement<f64>],
        starts: &[f64],
        q: &mut [f64],
        outcomes: &mut [PoseOutcome],
    ) -> Result<(), QueryError> {
        let n = self.joint_count();
        let is_batched = self.run_batch(targets, starts, q, outcomes)?;
        let mut solution =
            self.with_workspace(|workspace| std::mem::take(&mut workspace.batch_solution))?;
        let queries = targets.iter().zip(starts.chunks(n));
        for ((target, start), (q, outcome)) in queries.zip(q.chunks_mut(n).zip(outcomes)) {
            if is_batched && outcome.reached {
                continue;
            }
            let (result, errors) = self.solve_query(&self.query(target, start), &mut solution)?;
            q.copy_from_slice(&solution.q);
            *outcome = outcome_of(&result, errors);
        }
        self.with_workspace(|workspace| workspace.batch_solution = solution)
    }

    fn check_batch_into(
        &self,
        targets: &[Placement<f64>],
        starts: &[f64],
        q: &[f64],
        outcomes: &[PoseOutcome],
    ) -> Result<(), QueryError> {
        self.check_batch(targets, starts)?;
        self.check_length("q", q.len(), self.joint_count() * targets.len())?;
        self.check_length("outcomes", outcomes.len(), targets.len())
    }

    fn check_batch(&self, targets: &[Placement<f64>], starts: &[f64]) -> Result<(), QueryError> {
        let n = self.joint_count();
        self.check_length("starts", starts.len(), n * targets.len())?;
        for (query, (target, start)) in targets.iter().zip(starts.chunks(n)).enumerate() {
            self.check_query(query, target, start)?;
        }
        Ok(())
    }
}

pub(super) fn outcome_of(result: &SearchResult, errors: Errors) -> PoseOutcome {
    let count = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
    PoseOutcome {
        reached: result.reached,
        position_error: errors.position,
        orientation_error: errors.orientation,
        iterations: count(result.iterations),
        attempts: count(result.attempts),
        winner: result.reached.then(|| count(result.number)),
    }
}
