//! A chain and options compiled once; poses solved by them, one at a time or in batches.

use super::batch::{Attempts, Work};
use super::chain::{Chain, MAX_JOINTS};
use super::check;
use super::instruction_set;
use super::options::{LaneError, LaneOptions, PoseOutcome, Prefer};
use super::prepared::Prepared;
use super::query::{Answer, Query};
use crate::clock::Instant;
use crate::spatial::Placement;

/// Solves poses for one chain. It never changes once built, and is `Send` and `Sync`; solving
/// allocates nothing.
///
/// Joint values are radians and metres, in the chain's order; several queries' values stand one
/// after another in one slice. Every q that comes back lies within the bounds bit for bit, and the
/// errors beside it are those of that q. A joint that can turn right round comes out within half a
/// turn of the start; of a start beyond a million radians, where sines lose their digits, whole turns
/// are taken off first. Lengths may be in any unit, as long as it is the same everywhere. Where the
/// target is not reached, q is the end of the start's own attempt under [`Prefer::Start`], also where
/// a deadline cut it short, and under [`Prefer::First`] the point of least cost
/// `½(|p|² + (metres_per_radian)² · 2(1 − cos θ))` over all attempts.
#[derive(Clone, Debug)]
pub struct PoseSolver {
    prepared: Prepared,
}

impl PoseSolver {
    /// Prepares a chain: normalises it and builds the seed atlas.
    ///
    /// # Errors
    /// [`LaneError::Option`] for a tolerance, damping or weight out of range.
    pub fn new(chain: &Chain, options: LaneOptions) -> Result<Self, LaneError> {
        Ok(Self {
            prepared: Prepared::new(chain, options, None)?,
        })
    }

    /// A solver for the same joints with another tip or another goal, which shares the atlas: the
    /// same as a new one.
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

    getters! {
        /// What it was prepared with.
        pub(crate) fn options(&self) -> &LaneOptions = &self.prepared.options;
        /// Number of moving joints: the length of a q.
        pub fn joints(&self) -> usize = self.prepared.joints();
    }

    /// Bytes the seed atlas holds.
    #[must_use]
    pub fn atlas_memory(&self) -> usize {
        let atlas = self.prepared.atlas.as_ref();
        atlas.map_or(0, |atlas| atlas.atlas.memory())
    }

    /// Solves for one pose `base_from_target`, and writes the joint values to `q`. Under
    /// [`Prefer::Start`] the lowest attempt that reaches wins, as in a batch. With a deadline it gives up between two iterations after that time; without one, the same question has the
    /// same answer bit for bit.
    ///
    /// # Errors
    /// [`LaneError`] for wrong lengths and numbers that are not finite.
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
        Ok(self.race(&query, false, &mut Answer::of(q)))
    }

    /// A query with as many attempts and iterations as there may be.
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

    /// Answers a query that is checked already. `lone` runs the first attempt by itself at first.
    pub(crate) fn race(
        &self,
        query: &Query<'_>,
        lone: bool,
        answer: &mut Answer<'_>,
    ) -> PoseOutcome {
        instruction_set::race(&self.prepared, query, lone, answer)
    }

    /// The start's own attempt alone, for input that is checked already.
    pub(crate) fn own_attempt(
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
        self.race(&query, true, &mut Answer::of(q))
    }

    /// The geometric Jacobian at q (radians and metres), six entries a joint: see
    /// [`Links::write_twists`](super::links::Links::write_twists).
    pub(crate) fn write_twists(&self, q: &[f64], radian: f64, entries: &mut [f64]) {
        self.prepared.links.write_twists(q, radian, entries);
    }

    /// A solver for the same chain whose bounds may be moved, without an atlas.
    pub(crate) fn without_atlas(&self) -> Self {
        Self {
            prepared: self.prepared.without_atlas(),
        }
    }

    /// Moves the bounds, radians or metres.
    pub(crate) fn set_bounds(&mut self, lower: &[f64], upper: &[f64]) {
        self.prepared.set_bounds(lower, upper);
    }

    /// Solves many poses, lanes filled with different queries. What a query gives depends on
    /// nothing but itself, so any split of a batch gives the same bits. The winner of a query is
    /// its lowest attempt that reaches.
    ///
    /// `starts` and `q` hold one q a target, `outcomes` one outcome a target.
    ///
    /// # Errors
    /// [`LaneError`] for wrong lengths and numbers that are not finite.
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
    /// As there.
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
        /// Queries a task: enough to keep the lanes filled.
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

    /// Runs attempts `first`, `first + 1`, … of one query, as many as `outcomes` has places, and
    /// hands out what each gave: the ground for searches that compare solutions. Attempt numbers
    /// mean the same as in [`solve`](Self::solve): under [`Prefer::Start`] 0 is the start, then
    /// come the atlas's seeds, then random ones; under [`Prefer::First`] the atlas's come first.
    ///
    /// # Errors
    /// [`LaneError`] for wrong lengths and numbers that are not finite.
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

    /// Appends the atlas's seeds for a target from the cells beside its own, of which `cells` says which, radians and metres within the
    /// bounds; whether there are more.
    #[cfg(feature = "collision")]
    pub(crate) fn seeds_about(
        &self,
        target: &Placement<f64>,
        cells: std::ops::Range<usize>,
        q: &mut Vec<f64>,
    ) -> bool {
        self.prepared.seeds_about(target, cells, q)
    }

    /// Adds whole turns to the joints that can make them, as near to the start as bounds allow; radians and metres.
    #[cfg(feature = "collision")]
    pub(crate) fn unwrap_towards(&self, start: &[f64], q: &mut [f64]) {
        super::whole_turns::unwrap_towards(&self.prepared, start, q);
    }

    /// Runs a batch that is checked already.
    pub(crate) fn run(&self, work: Work<'_>) {
        instruction_set::batch(&self.prepared, work);
    }

    /// Follows a path of targets: each query starts from the q of the one before, and takes that
    /// attempt's solution where it succeeds ([`Prefer::Start`]).
    ///
    /// # Errors
    /// [`LaneError`] for wrong lengths and numbers that are not finite.
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
            *outcome = self.race(&query, true, &mut Answer::of(q));
            last[..n].copy_from_slice(q);
        }
        Ok(())
    }
}
