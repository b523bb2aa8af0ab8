//! Solver for the poses of one chain, single or in batches.

use super::batch::{Attempts, Work};
use super::chain::{Chain, MAX_JOINTS};
use super::check;
use super::instruction_set;
use super::options::{LaneError, LaneOptions, PoseOutcome, Prefer};
use super::prepared::Prepared;
use super::query::{Query, QueryOutput};
use crate::clock::Instant;
use crate::spatial::Placement;

/// Inverse kinematics solver for poses of one chain.
///
/// It is immutable once built, `Send` and `Sync`; solving allocates nothing. Joint values are radians and metres, in
/// the chain's order. Values of several queries follow one another in one slice. Lengths may be in any unit that is the
/// same everywhere.
///
/// Every returned q is exactly within the bounds, and the errors are those of that q. A joint that can make a whole
/// revolution ends within half a revolution of the start. Whole revolutions are first taken off a start beyond a
/// million radians, for the accuracy of sines.
///
/// If the target is not reached, [`Prefer::Start`] returns the end of the attempt from the start, also after a
/// deadline. [`Prefer::First`] returns the point of least cost `½(|p|² + (metres_per_radian)² · 2(1 − cos θ))` over all
/// attempts.
#[derive(Clone, Debug)]
pub struct PoseSolver {
    prepared: Prepared,
}

impl PoseSolver {
    /// Builds a solver: normalises the chain and builds the seed atlas.
    ///
    /// # Errors
    /// Returns [`LaneError::Option`] for a tolerance, damping or weight out of range.
    pub fn new(chain: &Chain, options: LaneOptions) -> Result<Self, LaneError> {
        Ok(Self {
            prepared: Prepared::new(chain, options, None)?,
        })
    }

    /// Solver for the same joints with another tip or goal, which shares the atlas.
    ///
    /// Its results equal those of a newly built solver.
    pub(crate) fn retargeted(
        &self,
        chain: &Chain,
        options: LaneOptions,
    ) -> Result<Self, LaneError> {
        let atlas = self.prepared.atlas.as_ref().map(|atlas| &atlas.atlas);
        Ok(Self {
            prepared: Prepared::new(chain, options, atlas)?,
        })
    }

    /// Options of the solver.
    #[must_use]
    pub(crate) fn options(&self) -> &LaneOptions {
        &self.prepared.options
    }

    /// Number of moving joints, the length of a q.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.prepared.joints()
    }

    /// Memory of the seed atlas in bytes, 0 without an atlas.
    #[must_use]
    pub fn atlas_memory(&self) -> usize {
        let atlas = self.prepared.atlas.as_ref();
        atlas.map_or(0, |atlas| atlas.atlas.memory())
    }

    /// Solves for one pose `base_from_target`, and writes the joint values to `q`.
    ///
    /// Under [`Prefer::Start`] the lowest attempt that reaches the target wins, as in a batch. With a deadline the
    /// search stops between two iterations after that time. Without one, equal queries give bitwise equal results.
    ///
    /// # Errors
    /// Returns a [`LaneError`] for wrong lengths and numbers that are not finite.
    pub fn solve(
        &self,
        base_from_target: &Placement<f64>,
        start: &[f64],
        search: Prefer,
        deadline: Option<Instant>,
        q: &mut [f64],
    ) -> Result<PoseOutcome, LaneError> {
        let n = self.joints();
        check::length("start", start.len(), n)?;
        check::length("q", q.len(), n)?;
        check::query(0, base_from_target, start)?;
        let query = self.query(base_from_target, start, search, deadline);
        Ok(self.race(&query, false, &mut QueryOutput::of(q)))
    }

    /// Query with the attempts and iterations that the options allow.
    fn query<'a>(
        &self,
        target: &'a Placement<f64>,
        start: &'a [f64],
        search: Prefer,
        deadline: Option<Instant>,
    ) -> Query<'a> {
        Query {
            target,
            start,
            search,
            attempts: (0, self.attempts()),
            budget: self.prepared.options.total_iterations,
            deadline,
        }
    }

    fn attempts(&self) -> u32 {
        self.prepared.options.attempts.max(1)
    }

    /// Solves a query that is checked already. With `first_alone` the first attempt initially runs alone.
    pub(crate) fn race(
        &self,
        query: &Query<'_>,
        first_alone: bool,
        output: &mut QueryOutput<'_>,
    ) -> PoseOutcome {
        instruction_set::race(&self.prepared, query, first_alone, output)
    }

    /// Runs only the attempt from the start, on input that is checked already.
    pub(crate) fn attempt_from_start(
        &self,
        base_from_target: &Placement<f64>,
        start: &[f64],
        deadline: Option<Instant>,
        q: &mut [f64],
    ) -> PoseOutcome {
        let query = Query {
            target: base_from_target,
            start,
            search: Prefer::Start,
            attempts: (0, 1),
            budget: u32::MAX,
            deadline,
        };
        self.race(&query, true, &mut QueryOutput::of(q))
    }

    /// Writes the geometric Jacobian at q (radians and metres), six entries per joint.
    ///
    /// See [`Links::write_twists`](super::links::Links::write_twists).
    pub(crate) fn write_twists(&self, q: &[f64], radian: f64, entries: &mut [f64]) {
        self.prepared.links.write_twists(q, radian, entries);
    }

    /// Solver for the same chain without an atlas, whose bounds may change.
    pub(crate) fn without_atlas(&self) -> Self {
        Self {
            prepared: self.prepared.without_atlas(),
        }
    }

    /// Sets the bounds, radians or metres.
    pub(crate) fn set_bounds(&mut self, lower: &[f64], upper: &[f64]) {
        self.prepared.set_bounds(lower, upper);
    }

    /// Solves for many poses, with different queries in the lanes.
    ///
    /// The result of a query depends on that query alone, so any split of a batch gives bitwise equal results. The
    /// winner of a query is its lowest attempt that reaches the target. `starts` and `q` hold one q per target,
    /// `outcomes` one outcome per target.
    ///
    /// # Errors
    /// Returns a [`LaneError`] for wrong lengths and numbers that are not finite.
    pub fn solve_batch(
        &self,
        base_from_targets: &[Placement<f64>],
        starts: &[f64],
        search: Prefer,
        q: &mut [f64],
        outcomes: &mut [PoseOutcome],
    ) -> Result<(), LaneError> {
        check::batch(self.joints(), base_from_targets, starts, q, outcomes)?;
        self.run(Work {
            targets: base_from_targets,
            starts,
            search,
            attempts: Attempts::UpTo(self.attempts()),
            deadline: None,
            q,
            outcomes,
        });
        Ok(())
    }

    /// [`solve_batch`](Self::solve_batch) over the threads of the current rayon pool.
    ///
    /// # Errors
    /// Returns a [`LaneError`] for wrong lengths and numbers that are not finite.
    #[cfg(feature = "rayon")]
    pub fn solve_batch_parallel(
        &self,
        base_from_targets: &[Placement<f64>],
        starts: &[f64],
        search: Prefer,
        q: &mut [f64],
        outcomes: &mut [PoseOutcome],
    ) -> Result<(), LaneError> {
        use rayon::prelude::*;
        /// Queries per task, enough to keep the lanes filled.
        const CHUNK: usize = 128;
        let n = self.joints();
        check::batch(n, base_from_targets, starts, q, outcomes)?;
        base_from_targets
            .par_chunks(CHUNK)
            .zip(starts.par_chunks(CHUNK * n))
            .zip(q.par_chunks_mut(CHUNK * n))
            .zip(outcomes.par_chunks_mut(CHUNK))
            .for_each(|(((targets, starts), q), outcomes)| {
                self.run(Work {
                    targets,
                    starts,
                    search,
                    attempts: Attempts::UpTo(self.attempts()),
                    deadline: None,
                    q,
                    outcomes,
                });
            });
        Ok(())
    }

    /// Runs attempts `first`, `first + 1`, … of one query, one per entry of `outcomes`, and returns every result.
    ///
    /// It serves searches that compare solutions. Attempt numbers are those of [`solve`](Self::solve). Under
    /// [`Prefer::Start`] attempt 0 is the start, followed by the atlas's configurations and then random ones. Under
    /// [`Prefer::First`] the atlas's come first.
    ///
    /// # Errors
    /// Returns a [`LaneError`] for wrong lengths and numbers that are not finite.
    pub fn run_attempts(
        &self,
        base_from_target: &Placement<f64>,
        start: &[f64],
        search: Prefer,
        first: u32,
        q: &mut [f64],
        outcomes: &mut [PoseOutcome],
    ) -> Result<(), LaneError> {
        let n = self.joints();
        check::length("start", start.len(), n)?;
        check::length("q", q.len(), n * outcomes.len())?;
        check::query(0, base_from_target, start)?;
        self.run(Work {
            targets: std::slice::from_ref(base_from_target),
            starts: start,
            search,
            attempts: Attempts::From(first),
            deadline: None,
            q,
            outcomes,
        });
        Ok(())
    }

    /// Appends the atlas's configurations for a target, from its cell and the neighbouring cells with numbers `cells`.
    ///
    /// Values are radians and metres within the bounds. Returns true if there are further cells.
    #[cfg(feature = "collision")]
    pub(crate) fn neighbour_seeds(
        &self,
        target: &Placement<f64>,
        cells: std::ops::Range<usize>,
        q: &mut Vec<f64>,
    ) -> bool {
        self.prepared.neighbour_seeds(target, cells, q)
    }

    /// Adds whole revolutions to the joints that can make them, as near to the start as bounds allow; radians and
    /// metres.
    #[cfg(feature = "collision")]
    pub(crate) fn unwrap_towards(&self, start: &[f64], q: &mut [f64]) {
        super::revolutions::unwrap_towards(&self.prepared, start, q);
    }

    /// Runs a batch that is checked already.
    pub(crate) fn run(&self, work: Work<'_>) {
        instruction_set::batch(&self.prepared, work);
    }

    /// Solves for the targets of a path in sequence, each from the q of the previous one.
    ///
    /// Each query prefers the solution of that attempt, as [`Prefer::Start`].
    ///
    /// # Errors
    /// Returns a [`LaneError`] for wrong lengths and numbers that are not finite.
    pub fn track(
        &self,
        base_from_targets: &[Placement<f64>],
        start: &[f64],
        q: &mut [f64],
        outcomes: &mut [PoseOutcome],
    ) -> Result<(), LaneError> {
        let n = self.joints();
        check::length("start", start.len(), n)?;
        check::length("q", q.len(), n * base_from_targets.len())?;
        check::length("outcomes", outcomes.len(), base_from_targets.len())?;
        for (index, target) in base_from_targets.iter().enumerate() {
            check::query(index, target, start)?;
        }
        let mut last = [0.0; MAX_JOINTS];
        last[..n].copy_from_slice(start);
        let steps = base_from_targets
            .iter()
            .zip(q.chunks_exact_mut(n))
            .zip(outcomes);
        for ((target, q), outcome) in steps {
            let query = self.query(target, &last[..n], Prefer::Start, None);
            *outcome = self.race(&query, true, &mut QueryOutput::of(q));
            last[..n].copy_from_slice(q);
        }
        Ok(())
    }
}
