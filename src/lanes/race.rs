//! One query: its attempts race in the lanes.

use std::time::Instant;

use super::chain::MAX_JOINTS;
use super::errors::Errors;
use super::group::Group;
use super::lane::LaneScalar;
use super::options::{Outcome, Search};
use super::prepared::Prepared;
use super::query::{Answer, Query};
use super::seeds::QuerySeeds;
use super::stages::Stages;
use super::turns::unwrap_towards;

/// A lane that reached.
struct Winner {
    attempt: u32,
    iterations: u32,
    errors: Errors,
}

/// Most lanes a group can have here.
const MAX_LANES: usize = 8;

/// Runs numbered attempts, a group of lanes in lock step, until the rule of the search has a winner.
///
/// Under [`Search::Start`] the lowest attempt that reaches wins, as in a batch; under
/// [`Search::First`] the fewest iterations win, then the lowest attempt. A lane that gives up is
/// refilled with the next attempt at once. Nothing here depends on time unless a deadline is set.
///
/// `lone` runs the start's attempt by itself first, and fills the other lanes only if it fails: for
/// tracking, where it nearly never does.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn race<V: LaneScalar, const N: usize>(
    stages: &Stages<V, N>,
    prepared: &Prepared,
    query: &Query<'_>,
    lone: bool,
    answer: &mut Answer<'_>,
) -> Outcome {
    let settings = &prepared.settings;
    let options = &prepared.options;
    let n = prepared.links.links.len();
    let goal_from_first = prepared
        .links
        .goal_from_first(query.target, settings.weighted);
    let mut seeds = QuerySeeds::new();
    let (first, end) = query.attempts;
    let by_number = query.search == Search::Start;
    // Whether the start's own attempt is among these.
    let own = by_number && first == 0;
    let Answer {
        q: q_out,
        best: best_out,
        best_attempt,
    } = answer;

    let mut group = Group::<V, N>::new(n);
    let mut seed = [0.0; MAX_JOINTS];
    let (mut attempt, mut age) = ([0u32; MAX_LANES], [0u32; MAX_LANES]);
    let (mut active, mut next, mut iterations) = (0u32, first, 0u32);
    let mut fill_to = if lone { 1 } else { V::WIDTH };
    // Cost and attempt of the best so far.
    let mut best: Option<(f64, u32)> = None;
    let mut winner: Option<Winner> = None;
    let mut late = false;
    loop {
        for lane in 0..fill_to {
            if active >> lane & 1 == 0
                && next < end
                && winner.is_none()
                && !late
                && iterations < query.budget.max(1)
            {
                (stages.seed)(
                    &mut seeds,
                    prepared,
                    query,
                    &goal_from_first,
                    next,
                    &mut seed,
                );
                // Before the first step all lanes take harmless numbers.
                let last = if next == first { V::WIDTH } else { lane + 1 };
                for lane in lane..last {
                    group.load(lane, &goal_from_first, &seed, settings);
                }
                (attempt[lane], age[lane]) = (next, 0);
                active |= 1 << lane;
                next += 1;
            }
        }
        if active == 0 {
            break;
        }
        let ended = (stages.step)(&mut group, &prepared.links, settings);
        iterations += active.count_ones();
        late = query.deadline.is_some_and(|at| Instant::now() >= at);
        let mut spent = if late { u32::MAX } else { 0 };
        for (lane, age) in age.iter_mut().enumerate().take(V::WIDTH) {
            *age += 1;
            spent |= u32::from(*age >= options.iterations) << lane;
        }
        let failed = (ended.stalled | spent) & active;
        let mut over = (ended.reached | ended.closing) & active | failed;
        while over != 0 {
            let lane = over.trailing_zeros() as usize;
            let bit = 1 << lane;
            over &= over - 1;
            let close = (ended.reached | ended.closing) & bit != 0;
            let better = winner.as_ref().is_none_or(|old| {
                let key = |attempt, iterations| match by_number {
                    true => (attempt, 0),
                    false => (iterations, attempt),
                };
                key(attempt[lane], age[lane]) < key(old.attempt, old.iterations)
            });
            if close && better {
                if ended.reached & bit != 0 {
                    group.point(lane, &mut seed);
                } else {
                    group.next_point(lane, &mut seed);
                }
                unwrap_towards(prepared, query.start, &mut seed[..n]);
                let (reached, errors) = (stages.judge)(prepared, &goal_from_first, &seed[..n]);
                if reached {
                    q_out.copy_from_slice(&seed[..n]);
                    winner = Some(Winner {
                        attempt: attempt[lane],
                        iterations: age[lane],
                        errors,
                    });
                    active &= !bit;
                    continue;
                }
            }
            if failed & bit != 0 {
                active &= !bit;
                if winner.is_some() {
                    continue;
                }
                // Costs that overflow are all alike: the lowest attempt, the start itself, is kept.
                let found = (group.cost(lane), attempt[lane]);
                let betters = best
                    .is_none_or(|best| found.0 < best.0 || found.0 == best.0 && found.1 < best.1);
                if betters {
                    best = Some(found);
                    *best_attempt = found.1;
                    let into = if own { &mut **best_out } else { &mut **q_out };
                    group.point(lane, into);
                }
                if own && attempt[lane] == 0 {
                    group.point(lane, q_out);
                }
            }
        }
        if let Some(winner) = &winner {
            let lower = |lane: usize| active >> lane & 1 != 0 && attempt[lane] < winner.attempt;
            if !by_number || !(0..V::WIDTH).any(lower) {
                break;
            }
        }
        fill_to = V::WIDTH.min(MAX_LANES);
        if lone && winner.is_none() && active != 0 {
            fill_to = 1;
        }
    }
    let (reached, errors) = match &winner {
        Some(winner) => (true, winner.errors),
        None => {
            if own {
                unwrap_towards(prepared, query.start, best_out);
                prepared.links.to_metres(best_out);
            }
            unwrap_towards(prepared, query.start, q_out);
            (stages.judge)(prepared, &goal_from_first, q_out)
        }
    };
    prepared.links.to_metres(q_out);
    Outcome {
        reached,
        position_error: errors.position,
        orientation_error: errors.orientation,
        iterations,
        attempts: next - first,
        winner: winner.map(|winner| winner.attempt),
    }
}
