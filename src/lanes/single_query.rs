//! One query: its attempts race in the lanes.

use std::time::Instant;

use super::chain::MAX_JOINTS;
use super::group::Group;
use super::judge::Errors;
use super::lane::LaneScalar;
use super::lm_step::Ended;
use super::options::{Outcome, Search};
use super::prepared::Prepared;
use super::seeds::QuerySeeds;
use super::stages::Stages;
use super::turns::unwrap_towards;
use crate::spatial::Placement;

/// One query as the drivers see it.
#[derive(Clone, Copy)]
pub(crate) struct Query<'a> {
    pub(crate) target: &'a Placement<f64>,
    pub(crate) start: &'a [f64],
    pub(crate) search: Search,
    /// The first attempt, and one more than the last.
    pub(crate) attempts: (u32, u32),
    /// Iterations after which no attempt begins.
    pub(crate) budget: u32,
    /// When to give up, checked between iterations.
    pub(crate) deadline: Option<Instant>,
}

/// Where a query's configurations go.
#[derive(Default)]
pub(crate) struct Answer<'a> {
    /// The solution; after a miss the end of the start's own attempt under [`Search::Start`] (where
    /// it is among the attempts), the best of all attempts otherwise.
    pub(crate) q: &'a mut [f64],
    /// After a miss under [`Search::Start`] the best of all attempts; empty where nobody asks.
    pub(crate) best: &'a mut [f64],
    /// After a miss which attempt the best of all is.
    pub(crate) best_attempt: u32,
}

impl<'a> Answer<'a> {
    /// For who does not ask for the best of all.
    pub(crate) fn of(q: &'a mut [f64]) -> Self {
        Self {
            q,
            ..Self::default()
        }
    }
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
    let mut race = Race::new(prepared, query);
    let mut group = Group::<V, N>::new(race.n);
    let mut lanes = if lone { 1 } else { V::WIDTH };
    loop {
        race.fill(stages, &mut group, lanes);
        if race.active == 0 {
            break;
        }
        let ended = (stages.step)(&mut group, &prepared.links, &prepared.settings);
        let failed = race.age(&ended, V::WIDTH);
        let close = (ended.reached | ended.closing) & race.active;
        let mut over = close | failed;
        while over != 0 {
            let lane = over.trailing_zeros() as usize;
            over &= over - 1;
            let won = close >> lane & 1 != 0
                && race.may_win(lane)
                && race.wins(stages, &group, lane, &ended, answer);
            if won || failed >> lane & 1 != 0 {
                race.active &= !(1 << lane);
            }
            if !won && failed >> lane & 1 != 0 && race.winner.is_none() {
                race.keep_miss(&group, lane, answer);
            }
        }
        if race.is_decided(V::WIDTH) {
            break;
        }
        // A lone attempt has the lanes to itself until it ends.
        let alone = lone && race.winner.is_none() && race.active != 0;
        lanes = if alone { 1 } else { V::WIDTH.min(MAX_LANES) };
    }
    race.outcome(stages, answer)
}

/// A lane that reached.
struct Winner {
    attempt: u32,
    iterations: u32,
    errors: Errors,
}

/// The attempts of one query under way.
struct Race<'a> {
    prepared: &'a Prepared,
    query: &'a Query<'a>,
    goal_from_first: Placement<f64>,
    /// Number of joints.
    n: usize,
    seeds: QuerySeeds,
    /// A configuration on its way into or out of a lane.
    q: [f64; MAX_JOINTS],
    /// By lane.
    attempt: [u32; MAX_LANES],
    age: [u32; MAX_LANES],
    /// The lanes with an attempt under way, bit by bit.
    active: u32,
    /// The next attempt.
    next: u32,
    iterations: u32,
    late: bool,
    /// Cost and attempt of the best miss so far.
    best: Option<(f64, u32)>,
    winner: Option<Winner>,
}

impl<'a> Race<'a> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn new(prepared: &'a Prepared, query: &'a Query<'a>) -> Self {
        let links = &prepared.links;
        Self {
            prepared,
            query,
            goal_from_first: links.goal_from_first(query.target, prepared.settings.weighted),
            n: links.links.len(),
            seeds: QuerySeeds::new(),
            q: [0.0; MAX_JOINTS],
            attempt: [0; MAX_LANES],
            age: [0; MAX_LANES],
            active: 0,
            next: query.attempts.0,
            iterations: 0,
            late: false,
            best: None,
            winner: None,
        }
    }

    /// Whether the lowest attempt that reaches wins.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn by_number(&self) -> bool {
        self.query.search == Search::Start
    }

    /// Whether the start's own attempt is among these.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn has_own(&self) -> bool {
        self.by_number() && self.query.attempts.0 == 0
    }

    /// Gives the lanes that are free the next attempts, while there are any to make.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn fill<V: LaneScalar, const N: usize>(
        &mut self,
        stages: &Stages<V, N>,
        group: &mut Group<V, N>,
        lanes: usize,
    ) {
        let (first, end) = self.query.attempts;
        for lane in 0..lanes {
            if self.active >> lane & 1 == 0
                && self.next < end
                && self.winner.is_none()
                && !self.late
                && self.iterations < self.query.budget.max(1)
            {
                (stages.seed)(
                    &mut self.seeds,
                    self.prepared,
                    self.query,
                    &self.goal_from_first,
                    self.next,
                    &mut self.q,
                );
                // Before the first step all lanes take harmless numbers.
                let last = if self.next == first {
                    V::WIDTH
                } else {
                    lane + 1
                };
                for lane in lane..last {
                    let settings = &self.prepared.settings;
                    group.load(lane, &self.goal_from_first, &self.q, settings);
                }
                (self.attempt[lane], self.age[lane]) = (self.next, 0);
                self.active |= 1 << lane;
                self.next += 1;
            }
        }
    }

    /// Counts a step of all lanes; those that give up.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn age(&mut self, ended: &Ended, width: usize) -> u32 {
        self.iterations += self.active.count_ones();
        // No closure here: one that is not inlined would be compiled without the vector features.
        self.late = match self.query.deadline {
            Some(deadline) => Instant::now() >= deadline,
            None => false,
        };
        let mut spent = if self.late { u32::MAX } else { 0 };
        for (lane, age) in self.age.iter_mut().enumerate().take(width) {
            *age += 1;
            spent |= u32::from(*age >= self.prepared.options.iterations) << lane;
        }
        (ended.stalled | spent) & self.active
    }

    /// Whether the attempt of a lane would win over the winner so far.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn may_win(&self, lane: usize) -> bool {
        let (attempt, age) = (self.attempt[lane], self.age[lane]);
        match &self.winner {
            None => true,
            Some(winner) if self.by_number() => attempt < winner.attempt,
            Some(winner) => (age, attempt) < (winner.iterations, winner.attempt),
        }
    }

    /// Judges the point of a lane that is close to the goal; whether it reaches, and so is the winner.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn wins<V: LaneScalar, const N: usize>(
        &mut self,
        stages: &Stages<V, N>,
        group: &Group<V, N>,
        lane: usize,
        ended: &Ended,
        answer: &mut Answer<'_>,
    ) -> bool {
        if ended.reached >> lane & 1 != 0 {
            group.point(lane, &mut self.q);
        } else {
            group.next_point(lane, &mut self.q);
        }
        let q = &mut self.q[..self.n];
        unwrap_towards(self.prepared, self.query.start, q);
        let (reached, errors) = (stages.judge)(self.prepared, &self.goal_from_first, q);
        if reached {
            answer.q.copy_from_slice(q);
            self.winner = Some(Winner {
                attempt: self.attempt[lane],
                iterations: self.age[lane],
                errors,
            });
        }
        reached
    }

    /// Keeps what an attempt came to that gave up, if it is the best of all or the start's own.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn keep_miss<V: LaneScalar, const N: usize>(
        &mut self,
        group: &Group<V, N>,
        lane: usize,
        answer: &mut Answer<'_>,
    ) {
        let (cost, attempt) = (group.cost(lane), self.attempt[lane]);
        // Costs that overflow are all alike: the lowest attempt, the start itself, is kept.
        let better = match self.best {
            None => true,
            Some((best, by)) => cost < best || cost == best && attempt < by,
        };
        if better {
            self.best = Some((cost, attempt));
            answer.best_attempt = attempt;
            match self.has_own() {
                true => group.point(lane, answer.best),
                false => group.point(lane, answer.q),
            }
        }
        if self.has_own() && attempt == 0 {
            group.point(lane, answer.q);
        }
    }

    /// Whether no attempt under way can win any more.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn is_decided(&self, width: usize) -> bool {
        let Some(winner) = &self.winner else {
            return false;
        };
        let mut decided = true;
        for lane in 0..width {
            let lower = self.active >> lane & 1 != 0 && self.attempt[lane] < winner.attempt;
            decided &= !(self.by_number() && lower);
        }
        decided
    }

    /// What the race came to; the configurations that are answered are in metres from here on.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn outcome<V: LaneScalar, const N: usize>(
        &mut self,
        stages: &Stages<V, N>,
        answer: &mut Answer<'_>,
    ) -> Outcome {
        let (prepared, start) = (self.prepared, self.query.start);
        let (reached, errors, winner) = match &self.winner {
            Some(winner) => (true, winner.errors, Some(winner.attempt)),
            None => {
                if self.has_own() {
                    unwrap_towards(prepared, start, answer.best);
                    prepared.links.to_metres(answer.best);
                }
                unwrap_towards(prepared, start, answer.q);
                let (reached, errors) = (stages.judge)(prepared, &self.goal_from_first, answer.q);
                (reached, errors, None)
            }
        };
        prepared.links.to_metres(answer.q);
        Outcome {
            reached,
            position_error: errors.position,
            orientation_error: errors.orientation,
            iterations: self.iterations,
            attempts: self.next - self.query.attempts.0,
            winner,
        }
    }
}
