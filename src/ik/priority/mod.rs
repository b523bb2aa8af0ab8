//! Priority levels of tasks: lexicographic least squares.
//!
//! The required tasks of all levels are first solved together. If they are not reached, levels are added one by one as
//! long as all so far are reached together. The first unreached level [descends](descent) in the null space of the
//! levels above it, then so does each level after it. Soft tasks follow last. Method: Escande, Mansard & Wieber 2014,
//! "Hierarchical quadratic programming", section 2, here with curvature.

mod active_bounds;
mod conjugate_steps;
mod constraint_correction;
mod curvature;
mod descent;
mod descent_problem;
mod inequalities;
mod lagrangian;
mod level_constraints;
mod newton;
mod newton_step;
mod slope_differences;
mod step_limits;
mod trial_inequalities;

use crate::clock::Instant;

use curvature::{NEW, add_rows};
use descent::{Descent, Start};
use descent_problem::DescentProblem;
use level_constraints::SAME_MISS;
pub(super) use step_limits::Extent;

use super::Minimiser;
use super::step_guard::{StepGuard, reborrowed};
use crate::problem::{Evaluation, Problem, ProblemInstance, Scratch, TaskSubset};
use crate::search::{Attempts, Schedule, SearchResult, run};
use crate::solver::{
    AnyMethod, Counts, LeastSquares, Observer, RowSpan, SolverState, Stopping, Termination,
    half_squared,
};

/// Method and limits of the descents of all levels.
#[derive(Clone, Copy)]
pub(super) struct PriorityDescent<'a> {
    pub(super) method: &'a dyn AnyMethod,
    pub(super) stopping: Stopping,
    pub(super) schedule: Schedule,
    pub(super) extent: Extent,
    pub(super) deadline: Option<Instant>,
}

/// Scratch memory of the searches and descents.
#[derive(Clone, Debug, Default)]
pub(super) struct LevelWorkspace {
    /// Search for the first levels alone.
    alone: Attempts,
    /// Variables found for all levels together, and for the first levels alone.
    starts: [Vec<f64>; 2],
    /// Residual of the first levels, each from its own search with those above it, if that search reached them.
    kept: Vec<f64>,
    /// Number of levels in `kept`.
    kept_levels: usize,
    /// Variables found for the levels so far, and the residual of the levels above the next one.
    x: Vec<f64>,
    residual: Vec<f64>,
    /// Descents of all levels but the first.
    descents: Vec<Descent>,
    above: RowSpan,
    /// Multipliers of the rows of required tasks. They define the gradient that identifies the limits of the first
    /// unreached level.
    pub(super) multipliers: Vec<f64>,
}

impl LevelWorkspace {
    /// Resizes the memory for a problem.
    pub(super) fn fit(&mut self, question: ProblemInstance<'_>) {
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

/// Priority levels of a problem instance during a solve.
pub(super) struct Ranked<'q, 'm> {
    pub(super) question: ProblemInstance<'q>,
    pub(super) by: PriorityDescent<'m>,
    pub(super) scratch: &'m mut Scratch,
    pub(super) solver: &'m mut SolverState,
    pub(super) memory: &'m mut LevelWorkspace,
    pub(super) observer: &'m mut dyn Observer,
    /// Collision check of the steps of searches, if any.
    pub(super) guard: Option<&'m mut dyn StepGuard>,
}

impl Ranked<'_, '_> {
    /// Solves the levels one after the other. Use it after a search for all levels together did not reach a target.
    ///
    /// `all` holds that search and receives the result. `found` accumulates its statistics.
    pub(super) fn solve_levels(&mut self, all: &mut Attempts, found: &mut SearchResult) {
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
                let LevelWorkspace { kept, alone, .. } = &mut *self.memory;
                let own = problem.ranks().rows_of(level);
                kept[own.clone()].copy_from_slice(&alone.keeper.residual[own]);
                self.memory.kept_levels = level + 1;
            }
            if !reached {
                first = level;
                break;
            }
        }
        // All levels together usually end nearer to the minimum of the lower levels.
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

    /// Searches for the first `levels` levels alone. Returns whether they are reached.
    fn search(
        &mut self,
        levels: usize,
        start: &[f64],
        schedule: Schedule,
        found: &mut SearchResult,
    ) -> bool {
        let share = TaskSubset::above(levels);
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
        // Each search has the solver's number of attempts, from the same starts.
        found.attempts = found.attempts.max(more.attempts);
        found.counts += more.counts;
        more.reached
    }

    /// Returns whether the required tasks cost less at the current variables than at `x`, and overwrites `residual`
    /// with that at `x`.
    fn is_better_than(&mut self, x: &[f64], residual: &mut [f64]) -> bool {
        let problem = self.question.problem;
        let share = problem.goals();
        let own = &mut self.memory.residual[..problem.rows_of(share)];
        let mut goals = Evaluation::of(share, self.question, self.scratch);
        goals.residual(x, residual);
        goals.residual(&self.memory.x, own);
        is_better(problem, 1.0 - SAME_MISS, own, residual)
    }

    /// Runs the descent of a level from the result of the levels above. Returns the reason if it ended early.
    fn descend(&mut self, rank: usize, found: &mut SearchResult) -> Option<Termination> {
        let share = TaskSubset::above(rank);
        let LevelWorkspace {
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
            .rows_of(TaskSubset::above((*kept_levels).min(rank)));
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

    /// Descends the soft tasks in the null space of the required tasks, from the result of these.
    pub(super) fn descend_preferences(&mut self, all: &mut Attempts, found: &mut SearchResult) {
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
            // An iteration limit is not reported: soft tasks may converge slowly.
            if let Some(cut) = cut.filter(|cut| *cut != Termination::IterationLimit) {
                found.termination = cut;
                break;
            }
        }
        kept.x.copy_from_slice(&self.memory.x);
        let mut goals = Evaluation::of(problem.goals(), self.question, self.scratch);
        goals.residual(&kept.x, &mut kept.residual);
    }

    /// Computes the multipliers of the Lagrangian gradient of the first unreached level at `x`.
    ///
    /// They are its own residual, and for the rows of the levels above the values that cancel the gradient in their row
    /// space.
    pub(super) fn take_multipliers(&mut self, x: &[f64], residual: &[f64]) {
        let problem = self.question.problem;
        let missed = (0..problem.ranks().levels()).find(|&level| {
            let own = &residual[problem.ranks().rows_of(level)];
            !problem.is_reached_by(TaskSubset::rank(level), own)
        });
        let LevelWorkspace {
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

/// Returns whether the required tasks of `residual` are better than those of `than`.
///
/// The first level that differs decides. Its cost must be less than `share` times the other cost.
pub(super) fn is_better(problem: &Problem, share: f64, residual: &[f64], than: &[f64]) -> bool {
    for level in 0..problem.ranks().levels() {
        let own = problem.ranks().rows_of(level);
        let reached = |r: &[f64]| problem.is_reached_by(TaskSubset::rank(level), r);
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
