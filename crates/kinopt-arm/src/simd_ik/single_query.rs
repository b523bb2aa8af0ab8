//! Search for a single query: its attempts run in parallel lanes.

use kinopt_kinematics::clock::is_past;

use super::chain::MAX_JOINTS;
use super::evaluation::Errors;
use super::group::LaneGroup;
use super::lane::LaneScalar;
use super::lm_step::EndMasks;
use super::options::{PoseOutcome, Prefer};
use super::prepared::Prepared;
use super::query::{Query, QueryOutput};
use super::revolutions::unwrap_towards;
use super::seeds::QuerySeeds;
use super::stages::Stages;
use kinopt_kinematics::spatial::Placement;

/// Largest number of lanes of a single query.
const MAX_LANES: usize = 8;

/// Runs numbered attempts, a group of lanes in lock step, until the preference of the search has a winner.
///
/// Under [`Prefer::Start`] the lowest attempt that reaches the target wins, as in a batch. Under [`Prefer::First`] the
/// fewest iterations win, then the lowest attempt. A lane whose attempt fails takes the next attempt at once. The
/// result depends on time only if a deadline is set.
///
/// With `first_alone` the attempt from the start runs alone first, and the other lanes fill only if it fails. This
/// suits tracking, where it rarely fails.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn race<V: LaneScalar, const N: usize>(
    stages: &Stages<V, N>,
    prepared: &Prepared,
    query: &Query<'_>,
    first_alone: bool,
    output: &mut QueryOutput<'_>,
) -> PoseOutcome {
    // Outside `Race`, to avoid moving kilobytes.
    let mut group = LaneGroup::new(prepared.joints());
    let mut race = Race::new(stages, prepared, query, output, &mut group);
    let mut lanes = if first_alone { 1 } else { V::WIDTH };
    loop {
        race.fill(lanes);
        if race.active == 0 {
            break;
        }
        let ended = (stages.step)(race.group, &prepared.links, &prepared.settings);
        race.record_start_cost();
        let failed = race.count_step(&ended);
        let near_goal = (ended.reached | ended.closing) & race.active;
        let mut finished = near_goal | failed;
        while finished != 0 {
            let lane = finished.trailing_zeros() as usize;
            let bit = 1 << lane;
            finished &= finished - 1;
            let won =
                near_goal & bit != 0 && race.may_win(lane) && race.becomes_winner(lane, &ended);
            if won || failed & bit != 0 {
                race.active &= !bit;
            }
            if !won && failed & bit != 0 && race.is_first_of_nearby(lane) {
                race.end_with_first(lane);
                break;
            }
            if !won && failed & bit != 0 && race.winner.is_none() {
                race.record_failure(lane);
            }
        }
        if race.is_decided() {
            break;
        }
        // With `first_alone`, no other attempt runs until the first ends.
        let first_still_alone = first_alone && race.winner.is_none() && race.active != 0;
        lanes = if first_still_alone {
            1
        } else {
            V::WIDTH.min(MAX_LANES)
        };
    }
    race.outcome()
}

/// The best successful attempt so far.
struct Winner {
    attempt: u32,
    iterations: u32,
    errors: Errors,
}

/// The running attempts of one query.
struct Race<'a, 'b, V, const N: usize> {
    stages: &'a Stages<V, N>,
    prepared: &'a Prepared,
    query: &'a Query<'a>,
    output: &'a mut QueryOutput<'b>,
    goal_from_first: Placement<f64>,
    group: &'a mut LaneGroup<V, N>,
    seeds: QuerySeeds,
    /// Buffer for a configuration read from or written to a lane.
    q: [f64; MAX_JOINTS],
    /// Number of the attempt in each lane.
    attempt: [u32; MAX_LANES],
    /// Iterations of the attempt in each lane.
    attempt_iterations: [u32; MAX_LANES],
    /// Bit mask of the lanes with a running attempt.
    active: u32,
    /// Number of the next attempt.
    next: u32,
    iterations: u32,
    is_late: bool,
    /// True if the first attempt has ended the search.
    ended: bool,
    /// True if the lowest attempt that reaches wins.
    by_number: bool,
    /// True if the attempts include the one from the start, under `Prefer::Start`.
    has_start_attempt: bool,
    /// True before the first step.
    before_first_step: bool,
    /// True if the target is so near to the start that a failed first attempt ends the query.
    nearby: bool,
    /// Twice the cost and number of the best failed attempt so far.
    best: Option<(f64, u32)>,
    winner: Option<Winner>,
}

// All is inlined into functions compiled for an instruction set. Closures are avoided: one that is not inlined would be
// compiled without it.
impl<'a, 'b, V: LaneScalar, const N: usize> Race<'a, 'b, V, N> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn new(
        stages: &'a Stages<V, N>,
        prepared: &'a Prepared,
        query: &'a Query<'a>,
        output: &'a mut QueryOutput<'b>,
        group: &'a mut LaneGroup<V, N>,
    ) -> Self {
        let links = &prepared.links;
        let by_number = query.search == Prefer::Start;
        Self {
            stages,
            prepared,
            query,
            output,
            goal_from_first: links.goal_from_first(query.target, prepared.settings.weighted),
            group,
            seeds: QuerySeeds::new(),
            q: [0.0; MAX_JOINTS],
            attempt: [0; MAX_LANES],
            attempt_iterations: [0; MAX_LANES],
            active: 0,
            next: query.attempts.0,
            iterations: 0,
            is_late: false,
            ended: false,
            by_number,
            has_start_attempt: by_number && query.attempts.0 == 0,
            before_first_step: true,
            nearby: false,
            best: None,
            winner: None,
        }
    }

    /// Starts the next attempts in the free lanes, as far as the budget allows.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn fill(&mut self, lanes: usize) {
        let (
            Self {
                prepared, query, ..
            },
            goal,
        ) = (&*self, self.goal_from_first);
        let (prepared, query) = (*prepared, *query);
        let (first, end) = query.attempts;
        for lane in 0..lanes {
            if self.active >> lane & 1 == 0
                && self.next < end
                && self.winner.is_none()
                && !self.is_late
                && self.iterations < query.budget.max(1)
            {
                let (seeds, q) = (&mut self.seeds, &mut self.q);
                (self.stages.seed)(seeds, prepared, query, &goal, self.next, q);
                // Before the first step, fill all lanes with valid numbers.
                let last = if self.next == first {
                    V::WIDTH
                } else {
                    lane + 1
                };
                for lane in lane..last {
                    self.group.load(lane, &goal, q, &prepared.settings);
                }
                (self.attempt[lane], self.attempt_iterations[lane]) = (self.next, 0);
                self.active |= 1 << lane;
                self.next += 1;
            }
        }
    }

    /// Counts a step of all lanes. Returns the bit mask of the lanes whose attempt failed.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn count_step(&mut self, ended: &EndMasks) -> u32 {
        self.iterations += self.active.count_ones();
        self.is_late = is_past(self.query.deadline);
        let mut exhausted = if self.is_late { u32::MAX } else { 0 };
        for (lane, iterations) in self
            .attempt_iterations
            .iter_mut()
            .enumerate()
            .take(V::WIDTH)
        {
            *iterations += 1;
            exhausted |= u32::from(*iterations >= self.prepared.options.iterations) << lane;
        }
        (ended.stalled | exhausted) & self.active
    }

    /// Returns true if the attempt of a lane would win over the current winner.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn may_win(&self, lane: usize) -> bool {
        let (attempt, iterations) = (self.attempt[lane], self.attempt_iterations[lane]);
        match &self.winner {
            None => true,
            Some(winner) if self.by_number => attempt < winner.attempt,
            Some(winner) => (iterations, attempt) < (winner.iterations, winner.attempt),
        }
    }

    /// Checks the point of a lane that is close to the goal. Makes it the winner and returns true if it reaches.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn becomes_winner(&mut self, lane: usize, ended: &EndMasks) -> bool {
        let q = &mut self.q[..self.prepared.links.links.len()];
        if ended.reached >> lane & 1 != 0 {
            self.group.point(lane, q);
        } else {
            self.group.next_point(lane, q);
        }
        unwrap_towards(self.prepared, self.query.start, q);
        let (reached, errors) = (self.stages.judge)(self.prepared, &self.goal_from_first, q);
        if reached {
            self.output.q.copy_from_slice(q);
            self.winner = Some(Winner {
                attempt: self.attempt[lane],
                iterations: self.attempt_iterations[lane],
                errors,
            });
        }
        reached
    }

    /// After the first step, records whether the target is near the start.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn record_start_cost(&mut self) {
        if self.before_first_step {
            self.before_first_step = false;
            // The first attempt runs in lane 0; after one step its accepted point is still the start.
            let twice_cost = self.group.twice_cost(0);
            self.nearby =
                self.has_start_attempt && twice_cost < self.prepared.settings.nearby_twice_cost;
        }
    }

    /// Returns true if the lane runs the first attempt and the target is near the start.
    ///
    /// Returns false after the deadline, which must not discard what other attempts have reached.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn is_first_of_nearby(&self, lane: usize) -> bool {
        self.nearby && self.attempt[lane] == 0 && !self.is_late
    }

    /// Ends the search with the failed first attempt as its result, whatever the other attempts reached.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn end_with_first(&mut self, lane: usize) {
        let Self { group, output, .. } = self;
        group.point(lane, output.q);
        group.point(lane, output.best);
        output.best_attempt = 0;
        (self.winner, self.next, self.ended) = (None, 1, true);
    }

    /// Records the end of a failed attempt if it is the best so far or started at the start.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn record_failure(&mut self, lane: usize) {
        let Self { group, output, .. } = self;
        let (cost, attempt) = (group.twice_cost(lane), self.attempt[lane]);
        // Costs that overflow are equal: keep the lowest attempt, from the start.
        let is_better = match self.best {
            None => true,
            Some((best_cost, best_attempt)) => {
                cost < best_cost || cost == best_cost && attempt < best_attempt
            }
        };
        if is_better {
            self.best = Some((cost, attempt));
            output.best_attempt = attempt;
            match self.has_start_attempt {
                true => group.point(lane, output.best),
                false => group.point(lane, output.q),
            }
        }
        if self.has_start_attempt && attempt == 0 {
            group.point(lane, output.q);
        }
    }

    /// Returns true if no running attempt can still win.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn is_decided(&self) -> bool {
        let Some(winner) = &self.winner else {
            return self.ended;
        };
        for lane in 0..V::WIDTH {
            let lower = self.active >> lane & 1 != 0 && self.attempt[lane] < winner.attempt;
            if self.by_number && lower {
                return false;
            }
        }
        true
    }

    /// Result of the search. Converts the output configurations to metres.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn outcome(&mut self) -> PoseOutcome {
        let (prepared, start) = (self.prepared, self.query.start);
        let output = &mut *self.output;
        let (reached, errors, winner) = match &self.winner {
            Some(winner) => (true, winner.errors, Some(winner.attempt)),
            None => {
                if self.has_start_attempt {
                    unwrap_towards(prepared, start, output.best);
                    prepared.links.to_metres(output.best);
                }
                unwrap_towards(prepared, start, output.q);
                let judge = self.stages.judge;
                let (reached, errors) = judge(prepared, &self.goal_from_first, output.q);
                (reached, errors, None)
            }
        };
        prepared.links.to_metres(output.q);
        PoseOutcome {
            reached,
            position_error: errors.position,
            orientation_error: errors.orientation,
            iterations: self.iterations,
            attempts: self.next - self.query.attempts.0,
            winner,
        }
    }
}
