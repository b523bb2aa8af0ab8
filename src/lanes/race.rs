//! One query: its attempts race in the lanes.

use super::kernel::Group;
use super::lane::LaneScalar;
use super::solver::{Outcome, PoseSolver, Search};
use super::seeds::QuerySeeds;

/// One query as the driver sees it.
pub(crate) struct Query<'a> {
    pub(crate) target: &'a crate::spatial::Placement<f64>,
    pub(crate) start: &'a [f64],
    pub(crate) search: Search,
}

/// The best lane of those that ended reached, or the least cost of those that gave up.
struct Winner {
    attempt: u32,
    iterations: u32,
}

/// Runs numbered attempts, a group of lanes in lock step, until the rule of the search has a winner.
///
/// Among lanes that reach in the same or different iterations the fewest iterations win, then the
/// lowest attempt. A lane that gives up is refilled with the next attempt at once. Nothing here
/// depends on time unless a deadline is set.
#[inline(always)]
pub(crate) fn race<V: LaneScalar, const N: usize, const EXACT: bool>(
    solver: &PoseSolver,
    query: &Query<'_>,
    q_out: &mut [f64],
) -> Outcome {
    let settings = &solver.settings;
    let options = &solver.options;
    let mut group = Group::<V, N>::new(solver.links.links.len());
    let goal_from_first = solver.links.goal_from_first(query.target);
    let seeds = QuerySeeds::new(solver, &goal_from_first, query);
    let attempts = options.attempts.max(1);

    let mut seed = [0.0; super::chain::MAX_JOINTS];
    let mut attempt = [0u32; 32];
    let mut age = [0u32; 32];
    let mut active = 0u32;
    let mut next = 0u32;
    let mut total_iterations = 0u32;
    for lane in 0..V::WIDTH {
        if next == attempts {
            seeds.fill(0, &mut seed);
        } else {
            seeds.fill(next, &mut seed);
            attempt[lane] = next;
            active |= 1 << lane;
            next += 1;
        }
        group.load(lane, &goal_from_first, &seed, settings);
    }
    let mut best_cost = f64::INFINITY;
    let mut rescue: Option<Winner> = None;
    let mut steps = 0u32;
    let winner = loop {
        let ended = group.step::<EXACT>(&solver.links, settings);
        total_iterations += active.count_ones();
        steps += 1;
        let mut spent = 0;
        for (lane, age) in age.iter_mut().enumerate().take(V::WIDTH) {
            *age += 1;
            spent |= u32::from(*age >= options.iterations) << lane;
        }
        let late = solver.options.deadline_passed(query.search, steps);
        let reached = ended.reached & active;
        let failed = (ended.stalled | spent | if late { u32::MAX } else { 0 }) & active & !reached;
        if reached | failed == 0 {
            continue;
        }
        let mut start_failed = false;
        for lane in 0..V::WIDTH {
            let bit = 1 << lane;
            if reached & bit != 0 {
                active &= !bit;
                let better = rescue.as_ref().is_none_or(|old| {
                    (age[lane], attempt[lane]) < (old.iterations, old.attempt)
                });
                if better || attempt[lane] == 0 && query.search == Search::Start {
                    group.point(lane, q_out);
                    rescue = Some(Winner {
                        attempt: attempt[lane],
                        iterations: age[lane],
                    });
                }
            }
            if failed & bit != 0 {
                active &= !bit;
                start_failed |= attempt[lane] == 0;
                if rescue.is_none() && group.cost(lane) < best_cost {
                    best_cost = group.cost(lane);
                    group.point(lane, q_out);
                }
                if next < attempts && rescue.is_none() && !late {
                    attempt[lane] = next;
                    next += 1;
                    age[lane] = 0;
                    active |= bit;
                    seeds.fill(attempt[lane], &mut seed);
                    group.load(lane, &goal_from_first, &seed, settings);
                }
            }
        }
        let start_runs = (0..V::WIDTH).any(|lane| active >> lane & 1 != 0 && attempt[lane] == 0);
        let _ = start_failed;
        if let Some(winner) = &rescue {
            if query.search == Search::First || winner.attempt == 0 || !start_runs {
                break rescue;
            }
        }
        if active == 0 {
            break rescue;
        }
    };
    solver.finish(query, q_out, total_iterations, winner.map(|w| w.attempt), next)
}
