//! Batches of queries: each lane solves one query and then takes the next.

use super::chain::MAX_JOINTS;
use super::continue_starts::continue_starts;
use super::evaluation::Errors;
use super::group::LaneGroup;
use super::lane::LaneScalar;
use super::lm_step::EndMasks;
use super::options::{PoseOutcome, Prefer};
use super::prepared::Prepared;
use super::query::Query;
use super::revolutions::unwrap_towards;
use super::seeds::QuerySeeds;
use super::stages::Stages;
use kinopt_kinematics::clock::{Instant, is_past};
use kinopt_kinematics::spatial::Placement;

/// Input and output of a batch.
pub(crate) struct Work<'a> {
    /// One target per query; or a single target, whose attempts are the work.
    pub(crate) targets: &'a [Placement<f64>],
    /// One start per target, joint values in sequence.
    pub(crate) starts: &'a [f64],
    pub(crate) search: Prefer,
    pub(crate) attempts: Attempts,
    /// After this time attempts end at their current point. Those not begun are misses with infinite errors and
    /// unchanged q.
    pub(crate) deadline: Option<Instant>,
    pub(crate) q: &'a mut [f64],
    pub(crate) outcomes: &'a mut [PoseOutcome],
}

/// Attempts to run.
#[derive(Clone, Copy)]
pub(crate) enum Attempts {
    /// Attempts of each query in order, until one reaches the target; at most this number.
    UpTo(u32),
    /// Attempts of the single target from this number on, one per result.
    From(u32),
    /// One attempt from each start to the single target, by [continuation](super::continue_starts).
    ///
    /// The outcomes report only whether it reaches.
    Continued,
}

/// Runs the attempts of each query in sequence in one lane.
///
/// The result of a query therefore depends on that query alone. The attempt of the lowest number that reaches wins.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn batch<V: LaneScalar, const L: usize, const N: usize>(
    stages: &Stages<V, N>,
    prepared: &Prepared,
    work: Work<'_>,
) {
    if matches!(work.attempts, Attempts::Continued) {
        continue_starts::<V, L, N>(stages, prepared, work);
        return;
    }
    let mut batch = Batch::<V, L, N>::new(stages, prepared, work);
    // Initially every lane counts as finished, without a job.
    let (mut finished, mut ended) = ((1u32 << L) - 1, EndMasks::none());
    loop {
        while finished != 0 {
            let lane = finished.trailing_zeros() as usize;
            finished &= finished - 1;
            if batch.end_attempt(lane, &ended) {
                batch.begin_attempt(lane);
            }
        }
        if batch.active == 0 {
            return;
        }
        ended = (stages.step)(&mut batch.group, &prepared.links, &prepared.settings);
        finished = batch.count_step(&ended);
    }
}

/// The query that a lane works on.
struct Job<'a> {
    index: usize,
    query: Query<'a>,
    goal_from_first: Placement<f64>,
    attempt: u32,
    /// Number of finished attempts.
    finished_attempts: u32,
    /// Iterations of the current attempt.
    attempt_iterations: u32,
    /// Iterations of the finished attempts.
    iterations: u32,
    best_twice_cost: f64,
    /// True if the target is so near to the start that a failed first attempt ends the query.
    nearby: bool,
}

/// The running queries of a batch, in L lanes.
struct Batch<'a, V, const L: usize, const N: usize> {
    stages: &'a Stages<V, N>,
    prepared: &'a Prepared,
    work: Work<'a>,
    group: LaneGroup<V, N>,
    /// Index of the next result to work on.
    next: usize,
    jobs: [Option<Job<'a>>; L],
    seeds: [QuerySeeds; L],
    /// Bit mask of the lanes that have a job.
    active: u32,
    /// True after the deadline.
    is_late: bool,
    /// A configuration on its way into or out of a lane.
    q: [f64; MAX_JOINTS],
}

impl<'a, V: LaneScalar, const L: usize, const N: usize> Batch<'a, V, L, N> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn new(stages: &'a Stages<V, N>, prepared: &'a Prepared, work: Work<'a>) -> Self {
        Self {
            stages,
            prepared,
            work,
            group: LaneGroup::new(prepared.joints()),
            next: 0,
            jobs: [const { None }; L],
            seeds: std::array::from_fn(|_| QuerySeeds::new()),
            active: 0,
            is_late: false,
            q: [0.0; MAX_JOINTS],
        }
    }

    /// Takes the next query, or the next attempt of the single one; `None` at the end.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn take_job(&mut self) -> Option<Job<'a>> {
        let (work, index) = (&self.work, self.next);
        let (source, attempt, max_attempts) = match work.attempts {
            Attempts::UpTo(max_attempts) => (index, 0, max_attempts),
            Attempts::From(first) => (0, first + index as u32, 1),
            // `continue_starts` has a loop for these.
            Attempts::Continued => return None,
        };
        if source >= work.targets.len() || index >= work.outcomes.len() {
            return None;
        }
        if self.is_late && index > 0 {
            self.work.outcomes[index..].fill(PoseOutcome::NOT_BEGUN);
            self.next = self.work.outcomes.len();
            return None;
        }
        self.next += 1;
        let (target, n) = (&work.targets[source], self.prepared.joints());
        let (links, settings) = (&self.prepared.links, &self.prepared.settings);
        Some(Job {
            index,
            goal_from_first: links.goal_from_first(target, settings.weighted),
            query: Query {
                target,
                start: &work.starts[source * n..(source + 1) * n],
                search: work.search,
                attempts: (0, max_attempts),
                budget: self.prepared.options.total_iterations,
                deadline: None,
            },
            attempt,
            finished_attempts: 0,
            attempt_iterations: 0,
            iterations: 0,
            best_twice_cost: f64::INFINITY,
            nearby: false,
        })
    }

    /// Starts the next attempt of a lane's job, or of the next job if the lane has none.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn begin_attempt(&mut self, lane: usize) {
        if self.jobs[lane].is_none() {
            self.jobs[lane] = self.take_job();
            self.seeds[lane].reset();
        }
        let Some(job) = &self.jobs[lane] else {
            self.active &= !(1 << lane);
            return;
        };
        (self.stages.seed)(
            &mut self.seeds[lane],
            self.prepared,
            &job.query,
            &job.goal_from_first,
            job.attempt,
            &mut self.q,
        );
        self.group
            .load(lane, &job.goal_from_first, &self.q, &self.prepared.settings);
        self.active |= 1 << lane;
    }

    /// Counts a step of all lanes. Returns the bit mask of the lanes whose attempt may have ended.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn count_step(&mut self, ended: &EndMasks) -> u32 {
        self.is_late = is_past(self.work.deadline);
        let late_lanes = if self.is_late { self.active } else { 0 };
        let mut finished =
            (ended.reached | ended.stalled | ended.closing) & self.active | late_lanes;
        for (lane, job) in self.jobs.iter_mut().enumerate() {
            if let Some(job) = job {
                job.attempt_iterations += 1;
                // After one step the accepted point of a first attempt is still the start.
                if job.attempt_iterations == 1 && job.attempt == 0 {
                    let twice_cost = self.group.twice_cost(lane);
                    job.nearby = job.query.search == Prefer::Start
                        && twice_cost < self.prepared.settings.nearby_twice_cost;
                }
                finished |=
                    u32::from(job.attempt_iterations >= self.prepared.options.iterations) << lane;
            }
        }
        finished
    }

    /// Ends the attempt of a lane, unless it is still converging. Returns true if the lane can start another attempt.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn end_attempt(&mut self, lane: usize, ended: &EndMasks) -> bool {
        let (prepared, n) = (self.prepared, self.prepared.joints());
        let options = &prepared.options;
        let Some(job) = &mut self.jobs[lane] else {
            return true;
        };
        let q = &mut self.work.q[job.index * n..(job.index + 1) * n];
        let mut reached = ended.reached >> lane & 1 != 0;
        let mut errors = None;
        if !reached && ended.closing >> lane & 1 != 0 {
            let point = &mut self.q[..n];
            self.group.next_point(lane, point);
            unwrap_towards(prepared, job.query.start, point);
            let (point_reached, point_errors) =
                (self.stages.judge)(prepared, &job.goal_from_first, point);
            if point_reached {
                reached = true;
                errors = Some(point_errors);
                q.copy_from_slice(point);
            } else if ended.stalled >> lane & 1 == 0
                && job.attempt_iterations < options.iterations
                && !self.is_late
            {
                return false;
            }
        }
        // A failed query keeps the first attempt's end or the best point, by preference. The first attempt is kept even
        // if its cost overflows.
        let keep_end = match self.work.search {
            Prefer::Start => job.finished_attempts == 0,
            Prefer::First => {
                job.finished_attempts == 0 || self.group.twice_cost(lane) < job.best_twice_cost
            }
        };
        if errors.is_none() && (reached || keep_end) {
            job.best_twice_cost = self.group.twice_cost(lane);
            self.group.point(lane, q);
        }
        job.iterations += job.attempt_iterations;
        job.attempt_iterations = 0;
        job.attempt += 1;
        job.finished_attempts += 1;
        let job_done = reached
            || job.nearby
            || self.is_late
            || job.finished_attempts >= job.query.attempts.1
            || job.iterations >= options.total_iterations;
        if job_done {
            self.finish(lane, reached, errors);
        }
        true
    }

    /// Finishes the job of a lane. `errors` are those of the winning attempt, if it was judged already.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn finish(&mut self, lane: usize, won: bool, errors: Option<Errors>) {
        let (prepared, n) = (self.prepared, self.prepared.joints());
        let Some(job) = self.jobs[lane].take() else {
            return;
        };
        let q = &mut self.work.q[job.index * n..(job.index + 1) * n];
        let (reached, errors) = match errors {
            Some(errors) => (won, errors),
            None => {
                unwrap_towards(prepared, job.query.start, q);
                (self.stages.judge)(prepared, &job.goal_from_first, q)
            }
        };
        prepared.links.to_metres(q);
        self.work.outcomes[job.index] = PoseOutcome {
            reached,
            position_error: errors.position,
            orientation_error: errors.orientation,
            iterations: job.iterations,
            attempts: job.finished_attempts,
            winner: won.then_some(job.attempt - 1),
        };
    }
}
