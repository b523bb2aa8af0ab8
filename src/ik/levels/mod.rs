//! What ranks below others: levels of goals, and preferences.
//!
//! The goals of all levels are searched for together first: where they are reached, every level is as good as
//! it can be. Where they are not, the levels are added one by one, the first as if it were alone, for as long as
//! all so far are reached together. The first that is missed comes as near as it can
//! [within](descent) those above, then so does each after it, and at last what the goals leave free goes to the
//! preferences. So each rank is a least-squares problem over what the ranks above leave free (lexicographic
//! least squares: Escande, Mansard & Wieber 2014, "Hierarchical quadratic programming", section 2, here with
//! curvature).

mod active_bounds;
mod conjugate_steps;
mod constraint_correction;
mod curvature;
mod descent;
mod descent_problem;
mod held_ranks;
mod inequalities;
mod lagrangian;
mod newton;
mod newton_step;
mod slope_differences;
mod step_limits;
mod trial_inequalities;

use crate::clock::Instant;

use curvature::{NEW, add_rows};
use descent::{Descent, Start};
use descent_problem::DescentProblem;
use held_ranks::SAME_MISS;
pub(super) use step_limits::Extent;

use super::Minimiser;
use super::step_guard::{StepGuard, reborrowed};
use crate::problem::{Evaluation, Problem, Question, Scratch, Share};
use crate::search::{Attempts, Found, Schedule, run};
use crate::solver::{
    AnyMethod, Counts, LeastSquares, Observer, RowSpan, SolverState, Stopping, Termination,
    half_squared,
};

/// How ranks are solved, and how long that goes on.
#[derive(Clone, Copy)]
pub(super) struct ByRank<'a> {
    pub(super) method: &'a dyn AnyMethod,
    pub(super) stopping: Stopping,
    pub(super) schedule: Schedule,
    pub(super) extent: Extent,
    pub(super) deadline: Option<Instant>,
}

/// Memory of both: of searches and of descents.
#[derive(Clone, Debug, Default)]
pub(super) struct RankMemory {
    /// Of the search for some levels, apart from that for all.
    alone: Attempts,
    /// Where all levels together came to, and the first ones alone.
    starts: [Vec<f64>; 2],
    /// What the levels came to alone, each with those above it, as far as these were reached: what is kept of them.
    kept: Vec<f64>,
    /// How many of them that is.
    kept_levels: usize,
    /// Where the ranks so far have come to, and the residual there of the next one's ranks above.
    x: Vec<f64>,
    residual: Vec<f64>,
    /// One for each rank but the first.
    descents: Vec<Descent>,
    above: RowSpan,
    /// What multiplies the goals' rows in the slope that tells which limits hold the first level that misses.
    pub(super) multipliers: Vec<f64>,
}

impl RankMemory {
    /// Makes room for a problem.
    pub(super) fn fit(&mut self, question: Question<'_>) {
        let problem = question.problem;
        let ranks = problem.ranks().count();
        self.x.resize(problem.variables(), 0.0);
        self.residual.resize(problem.rows(), 0.0);
        self.kept_levels = 0;
        self.descents
            .resize_with(ranks.saturating_sub(1), Descent::default);
        for (descent, rank) in self.descents.iter_mut().zip(1..) {
            descent.fit(problem, rank);
        }
        if problem.ranks().levels() > 1 {
            for start in &mut self.starts {
                start.resize(problem.variables(), 0.0);
            }
            let goals = problem.rows_of(problem.goals());
            self.multipliers.resize(goals, 0.0);
            self.kept.resize(goals, 0.0);
        }
    }
}

/// A question's ranks, being solved.
pub(super) struct Ranked<'q, 'm> {
    pub(super) question: Question<'q>,
    pub(super) by: ByRank<'m>,
    pub(super) scratch: &'m mut Scratch,
    pub(super) solver: &'m mut SolverState,
    pub(super) memory: &'m mut RankMemory,
    pub(super) observer: &'m mut dyn Observer,
    /// What steps of searches keep clear of, where they do.
    pub(super) guard: Option<&'m mut dyn StepGuard>,
}

impl Ranked<'_, '_> {
    /// Lets the levels give way one below the other, where a search for all of them together misses. That search
    /// has `all`, which is left where they come to, and what it found `found`.
    pub(super) fn solve_levels(&mut self, all: &mut Attempts, found: &mut Found) {
        let problem = self.question.problem;
        let last = problem.ranks().levels() - 1;
        let [mut together, mut alone] = std::mem::take(&mut self.memory.starts);
        together.clone_from(&all.keeper.x);
        alone.clone_from(&all.start);
        let mut first = last;
        for level in 0..last {
            let reached = self.search(level + 1, &alone, self.by.schedule, found);
            if reached || level == 0 {
                alone.copy_from_slice(&self.memory.x);
            }
            if reached {
                let RankMemory { kept, alone, .. } = &mut *self.memory;
                let own = problem.ranks().rows_of(level);
                kept[own.clone()].copy_from_slice(&alone.keeper.residual[own]);
                self.memory.kept_levels = level + 1;
            }
            if !reached {
                first = level;
                break;
            }
        }
        // Where all levels together came to is most often nearer to what the lower ones want.
        let cost = half_squared(&self.memory.alone.keeper.residual);
        let reached = self.search(first.max(1), &together, self.by.schedule.once(), found);
        let now = half_squared(&self.memory.alone.keeper.residual);
        let as_good = reached || (first == 0 && now <= cost * (1.0 + SAME_MISS));
        if !as_good {
            self.memory.x.copy_from_slice(&alone);
        }
        self.memory.starts = [together, alone];
        if self.by.extent.goes_on() && !self.is_better_than(&all.start, &mut all.keeper.residual) {
            self.memory.x.copy_from_slice(&all.start);
        }

        found.termination = Termination::Stationary;
        for rank in first.max(1)..=last {
            let cut = self.descend(rank, found);
            if let Some(cut) = cut {
                found.termination = cut;
            }
        }
        all.keeper.x.copy_from_slice(&self.memory.x);
        let share = problem.goals();
        Evaluation::of(share, self.question, self.scratch)
            .residual(&all.keeper.x, &mut all.keeper.residual);
        found.reached = problem.is_reached_by(share, &all.keeper.residual);
        if found.reached {
            found.termination = Termination::Reached;
        }
    }

    /// Searches for the first levels alone, so many, from a start; whether they are reached.
    fn search(
        &mut self,
        levels: usize,
        start: &[f64],
        schedule: Schedule,
        found: &mut Found,
    ) -> bool {
        let share = Share::above(levels);
        let alone = &mut self.memory.alone;
        alone.fit(self.question, share);
        alone.start.copy_from_slice(start);
        let deadline = self.by.deadline;
        let mut engine = Minimiser {
            question: self.question,
            share,
            method: self.by.method,
            deadline,
            observer: &mut *self.observer,
            scratch: &mut *self.scratch,
            memory: &mut *self.solver,
            guard: reborrowed(&mut self.guard),
            moved: None,
        };
        let more = run(
            self.question,
            share,
            &schedule,
            deadline,
            &mut engine,
            alone,
        );
        self.memory.x.copy_from_slice(&alone.keeper.x);
        found.iterations += more.iterations;
        // Each level's search has as many as the solver may make, from the same starts.
        found.attempts = found.attempts.max(more.attempts);
        found.counts += more.counts;
        more.reached
    }

    /// Whether the goals are better where the levels have come to than at x; their residual there takes the place of another.
    fn is_better_than(&mut self, x: &[f64], residual: &mut [f64]) -> bool {
        let problem = self.question.problem;
        let share = problem.goals();
        let own = &mut self.memory.residual[..problem.rows_of(share)];
        let mut goals = Evaluation::of(share, self.question, self.scratch);
        goals.residual(x, residual);
        goals.residual(&self.memory.x, own);
        is_better(problem, 1.0 - SAME_MISS, own, residual)
    }

    /// A rank's descent from where the ranks above are; what ended it early.
    fn descend(&mut self, rank: usize, found: &mut Found) -> Option<Termination> {
        let share = Share::above(rank);
        let RankMemory {
            x,
            residual,
            descents,
            kept,
            kept_levels,
            ..
        } = &mut *self.memory;
        let descent = descents.get_mut(rank - 1)?;
        let residual = &mut residual[..self.question.problem.rows_of(share)];
        Evaluation::of(share, self.question, self.scratch).residual(x, residual);
        let first = self
            .question
            .problem
            .rows_of(Share::above((*kept_levels).min(rank)));
        let mut problem = DescentProblem {
            question: self.question,
            scratch: &mut *self.scratch,
            memory: &mut *self.solver,
            stopping: self.by.stopping,
            deadline: self.by.deadline,
            counts: Counts::default(),
        };
        let descended = descent.run(
            &mut problem,
            &Start {
                x,
                residual,
                kept: &kept[..first],
            },
            self.by.extent,
            self.observer,
        );
        found.iterations += descended.iterations;
        found.counts += problem.counts;
        x.copy_from_slice(&descent.x);
        descended.cut
    }

    /// Lets the preferences act within what the goals leave free, from where these came to.
    pub(super) fn descend_preferences(&mut self, all: &mut Attempts, found: &mut Found) {
        let problem = self.question.problem;
        let (levels, ranks) = (problem.ranks().levels(), problem.ranks().count());
        let (extent, kept) = (self.by.extent, &mut all.keeper);
        let reached = problem.is_reached_by(problem.goals(), &kept.residual);
        let follows = extent.follows(reached, found.iterations);
        if levels == ranks || !follows || (!reached && !found.termination.is_settled()) {
            return;
        }
        self.memory.x.copy_from_slice(&kept.x);
        for rank in levels..ranks {
            let cut = self.descend(rank, found);
            // Steps that run out are no news: preferences may go on for ever.
            if let Some(cut) = cut.filter(|cut| *cut != Termination::IterationLimit) {
                found.termination = cut;
                break;
            }
        }
        kept.x.copy_from_slice(&self.memory.x);
        let mut goals = Evaluation::of(problem.goals(), self.question, self.scratch);
        goals.residual(&kept.x, &mut kept.residual);
    }

    /// Takes the slope at x that tells what holds back the first level that misses: its own residual, and the
    /// multipliers of the rows above it, for which no slope is left along what they leave free.
    pub(super) fn take_multipliers(&mut self, x: &[f64], residual: &[f64]) {
        let problem = self.question.problem;
        let missed = (0..problem.ranks().levels()).find(|&level| {
            let own = &residual[problem.ranks().rows_of(level)];
            !problem.is_reached_by(Share::rank(level), own)
        });
        let RankMemory {
            above, multipliers, ..
        } = &mut *self.memory;
        let (Some(level), share) = (missed, problem.goals()) else {
            return multipliers.copy_from_slice(residual);
        };
        let own = problem.ranks().rows_of(level);
        multipliers.fill(0.0);
        multipliers[own.clone()].copy_from_slice(&residual[own.clone()]);
        let mut goals = Evaluation::of(share, self.question, self.scratch);
        self.solver.take_shape(residual.len(), x.len());
        let (slope, _) = self.solver.slope_at(&mut goals, x, multipliers);
        above.clear();
        let slope = slope.to_vec();
        let bound: Vec<bool> = (0..x.len())
            .map(|j| !self.question.space().is_between_bounds(x, j))
            .collect();
        add_rows(above, self.solver.jacobian(), 0..own.start, &bound, NEW);
        for (row, multiplier) in above.multipliers(&slope) {
            multipliers[row] = multiplier;
        }
    }
}

/// Whether the goals of one residual are better than those of another: of the first level that is not the same,
/// by less than this share of its cost.
pub(super) fn is_better(problem: &Problem, share: f64, residual: &[f64], than: &[f64]) -> bool {
    for level in 0..problem.ranks().levels() {
        let own = problem.ranks().rows_of(level);
        let reached = |r: &[f64]| problem.is_reached_by(Share::rank(level), r);
        let (own, other) = (&residual[own.clone()], &than[own]);
        let (cost, before) = (half_squared(own), half_squared(other));
        match (reached(own), reached(other)) {
            (true, true) => {}
            (true, false) => return true,
            (false, true) => return false,
            (false, false) if cost < share * before => return true,
            (false, false) if cost > before * (1.0 + SAME_MISS) => return false,
            (false, false) => {}
        }
    }
    false
}
