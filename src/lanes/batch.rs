//! Many queries: every lane works on its own, and takes the next when it is done.

use super::chain::MAX_JOINTS;
use super::group::Group;
use super::kernel::Ended;
use super::lane::LaneScalar;
use super::options::{Outcome, Search};
use super::prepared::Prepared;
use super::query::Query;
use super::seeds::QuerySeeds;
use super::stages::Stages;
use super::turns::unwrap_towards;
use crate::spatial::Placement;

/// What a lane is busy with.
struct Job<'a> {
    index: usize,
    query: Query<'a>,
    goal_from_first: Placement<f64>,
    attempt: u32,
    /// Attempts ended.
    begun: u32,
    age: u32,
    iterations: u32,
    best_cost: f64,
}

/// What a batch is given.
pub(crate) struct Work<'a> {
    /// One a query; or one alone, whose attempts are the work.
    pub(crate) targets: &'a [Placement<f64>],
    /// One start a target, joint values one after another.
    pub(crate) starts: &'a [f64],
    pub(crate) search: Search,
    /// Run only this attempt and those that follow it, one a result, of the single target.
    pub(crate) attempts_from: Option<u32>,
    /// Most attempts of one query.
    pub(crate) attempts: u32,
    pub(crate) q: &'a mut [f64],
    pub(crate) outcomes: &'a mut [Outcome],
}

/// Runs the attempts of each query one after another in one lane, so that what a query gives depends
/// on nothing but itself. The winner is the lowest attempt that reaches.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn batch<V: LaneScalar, const L: usize, const N: usize>(
    stages: &Stages<V, N>,
    prepared: &Prepared,
    work: Work<'_>,
) {
    let n = prepared.links.links.len();
    let settings = &prepared.settings;
    let options = &prepared.options;
    let mut group = Group::<V, N>::new(n);
    let mut seed = [0.0; MAX_JOINTS];
    let Work {
        targets,
        starts,
        search,
        attempts_from,
        attempts,
        q: q_out,
        outcomes,
    } = work;
    let mut next = 0;
    let mut jobs: [Option<Job<'_>>; L] = [const { None }; L];
    let mut seeds: [QuerySeeds; L] = std::array::from_fn(|_| QuerySeeds::new());
    // A macro, as a closure might be compiled without the vector features.
    macro_rules! take {
        () => {{
            let source = if attempts_from.is_some() { 0 } else { next };
            match (targets.get(source), outcomes.get(next)) {
                (Some(target), Some(_)) => {
                    let query = Query {
                        target,
                        start: &starts[source * n..(source + 1) * n],
                        search,
                        attempts: (0, attempts),
                        budget: options.total_iterations,
                        deadline: None,
                    };
                    next += 1;
                    Some(Job {
                        index: next - 1,
                        goal_from_first: prepared.links.goal_from_first(target, settings.weighted),
                        query,
                        attempt: attempts_from.map_or(0, |first| first + (next - 1) as u32),
                        begun: 0,
                        age: 0,
                        iterations: 0,
                        best_cost: f64::INFINITY,
                    })
                }
                _ => None,
            }
        }};
    }
    let mut active = 0u32;
    // At first every lane is done with nothing.
    let mut over = (1u32 << L) - 1;
    let mut ended = Ended::none();
    loop {
        while over != 0 {
            let lane = over.trailing_zeros() as usize;
            over &= over - 1;
            if let Some(job) = &mut jobs[lane] {
                let q = &mut q_out[job.index * n..(job.index + 1) * n];
                let mut reached = ended.reached >> lane & 1 != 0;
                let mut errors = None;
                if !reached && ended.closing >> lane & 1 != 0 {
                    group.next_point(lane, &mut seed);
                    unwrap_towards(prepared, job.query.start, &mut seed[..n]);
                    let (close, found) = (stages.judge)(prepared, &job.goal_from_first, &seed[..n]);
                    if close {
                        reached = true;
                        errors = Some(found);
                        q.copy_from_slice(&seed[..n]);
                    } else if ended.stalled >> lane & 1 == 0 && job.age < options.iterations {
                        continue;
                    }
                }
                // A miss keeps the start's own end where that counts, else the best. The first attempt
                // is kept even where costs overflow.
                let kept = match search {
                    Search::Start => job.begun == 0,
                    Search::First => job.begun == 0 || group.cost(lane) < job.best_cost,
                };
                if errors.is_none() && (reached || kept) {
                    job.best_cost = group.cost(lane);
                    group.point(lane, q);
                }
                job.iterations += job.age;
                job.age = 0;
                let attempt = job.attempt;
                job.attempt += 1;
                job.begun += 1;
                if reached
                    || attempts_from.is_some()
                    || job.begun >= attempts
                    || job.iterations >= options.total_iterations
                {
                    let winner = reached.then_some(attempt);
                    let errors = match errors {
                        Some(errors) => errors,
                        None => {
                            unwrap_towards(prepared, job.query.start, q);
                            let (close, errors) = (stages.judge)(prepared, &job.goal_from_first, q);
                            reached = close;
                            errors
                        }
                    };
                    prepared.links.to_metres(q);
                    outcomes[job.index] = Outcome {
                        reached,
                        position_error: errors.position,
                        orientation_error: errors.orientation,
                        iterations: job.iterations,
                        attempts: job.begun,
                        winner,
                    };
                    jobs[lane] = None;
                }
            }
            if jobs[lane].is_none() {
                jobs[lane] = take!();
                seeds[lane].forget();
            }
            match &mut jobs[lane] {
                Some(job) => {
                    let (goal, query) = (&job.goal_from_first, &job.query);
                    (stages.seed)(
                        &mut seeds[lane],
                        prepared,
                        query,
                        goal,
                        job.attempt,
                        &mut seed,
                    );
                    group.load(lane, &job.goal_from_first, &seed, settings);
                    active |= 1 << lane;
                }
                None => active &= !(1 << lane),
            }
        }
        if active == 0 {
            return;
        }
        ended = (stages.step)(&mut group, &prepared.links, settings);
        over = (ended.reached | ended.stalled | ended.closing) & active;
        for (lane, job) in jobs.iter_mut().enumerate() {
            if let Some(job) = job {
                job.age += 1;
                over |= u32::from(job.age >= options.iterations) << lane;
            }
        }
    }
}
