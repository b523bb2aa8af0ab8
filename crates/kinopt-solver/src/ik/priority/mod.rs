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

use kinopt_kinematics::clock::Instant;

use curvature::{MIN_INDEPENDENT_PART, add_rows};
use descent::{Descent, Start};
use descent_problem::DescentProblem;
use level_constraints::COST_TOLERANCE;
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
    first_levels: Attempts,
    /// Variables found for all levels together, and for the first levels alone.
    starts: [Vec<f64>; 2],
    /// Residual of the first levels, each from its own search with those above it, if that search reached them.
    reached_residual: Vec<f64>,
    /// Number of levels in `reached_residual`.
    reached_levels: usize,
    /// Variables found for the levels so far, and the residual of the levels above the next one.
    x: Vec<f64>,
    residual: Vec<f64>,
    /// Descents of all levels but the first.
    descents: Vec<Descent>,
    higher_span: RowSpan,
    /// Multipliers of the rows of required tasks. They define the gradient that identifies the limits of the first
    /// unreached level.
    pub(super) multipliers: Vec<f64>,
}

impl LevelWorkspace {
    /// Resizes the memory for a problem.
    pub(super) fn fit(&mut self, instance: ProblemInstance<'_>) {
        let problem = instance.problem;
        let ranks = problem.ranks().count();
        self.x.resize(problem.variables(), 0.0);
        self.residual.resize(problem.rows(), 0.0);
        self.reached_levels = 0;
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
            self.reached_residual.resize(goals, 0.0);
        }
    }
}

/// Priority levels of a problem instance during a solve.
pub(super) struct PriorityLevels<'q, 'm> {
    pub(super) instance: ProblemInstance<'q>,
    pub(super) descent: PriorityDescent<'m>,
    pub(super) scratch: &'m mut Scratch,
    pub(super) state: &'m mut SolverState,
    pub(super) workspace: &'m mut LevelWorkspace,
    pub(super) observer: &'m mut dyn Observer,
    /// Collision check of the steps of searches, if any.
    pub(super) guard: Option<&'m mut dyn StepGuard>,
}

impl PriorityLevels<'_, '_> {
    /// Solves the levels one after the other. Use it after a search for all levels together did not reach a target.
    ///
    /// `search` holds that search and receives the result. `result` accumulates its statistics.
    pub(super) fn solve_levels(&mut self, search: &mut Attempts, result: &mut SearchResult) {
        let problem = self.instance.problem;
        let last_level = problem.ranks().levels() - 1;
        let [mut combined_x, mut first_levels_x] = std::mem::take(&mut self.workspace.starts);
        combined_x.clone_from(&search.keeper.x);
        first_levels_x.clone_from(&search.start);
        let mut first_unreached = last_level;
        for level in 0..last_level {
            let reached = self.search(level + 1, &first_levels_x, self.descent.schedule, result);
            if reached || level == 0 {
                first_levels_x.copy_from_slice(&self.workspace.x);
            }
            if reached {
                let LevelWorkspace {
                    reached_residual,
                    first_levels,
                    ..
                } = &mut *self.workspace;
                let row_range = problem.ranks().rows_of(level);
                reached_residual[row_range.clone()]
                    .copy_from_slice(&first_levels.keeper.residual[row_range]);
                self.workspace.reached_levels = level + 1;
            }
            if !reached {
                first_unreached = level;
                break;
            }
        }
        // All levels together usually end nearer to the minimum of the lower levels.
        let first_levels_cost = half_squared(&self.workspace.first_levels.keeper.residual);
        let reached = self.search(
            first_unreached.max(1),
            &combined_x,
            self.descent.schedule.once(),
            result,
        );
        let combined_cost = half_squared(&self.workspace.first_levels.keeper.residual);
        let is_as_good = reached
            || (first_unreached == 0
                && combined_cost <= first_levels_cost * (1.0 + COST_TOLERANCE));
        if !is_as_good {
            self.workspace.x.copy_from_slice(&first_levels_x);
        }
        self.workspace.starts = [combined_x, first_levels_x];
        if self.descent.extent.continues_from_start()
            && !self.is_better_than(&search.start, &mut search.keeper.residual)
        {
            self.workspace.x.copy_from_slice(&search.start);
        }

        result.termination = Termination::Stationary;
        for rank in first_unreached.max(1)..=last_level {
            let early_end = self.descend(rank, result);
            if let Some(early_end) = early_end {
                result.termination = early_end;
            }
        }
        search.keeper.x.copy_from_slice(&self.workspace.x);
        let subset = problem.goals();
        Evaluation::of(subset, self.instance, self.scratch)
            .residual(&search.keeper.x, &mut search.keeper.residual);
        result.reached = problem.is_reached_by(subset, &search.keeper.residual);
        if result.reached {
            result.termination = Termination::Reached;
        }
    }

    /// Searches for the first `levels` levels alone. Returns whether they are reached.
    fn search(
        &mut self,
        levels: usize,
        start: &[f64],
        schedule: Schedule,
        total: &mut SearchResult,
    ) -> bool {
        let subset = TaskSubset::above(levels);
        let first_levels = &mut self.workspace.first_levels;
        first_levels.fit(self.instance, subset);
        first_levels.start.copy_from_slice(start);
        let deadline = self.descent.deadline;
        let mut engine = Minimiser {
            instance: self.instance,
            subset,
            method: self.descent.method,
            deadline,
            observer: &mut *self.observer,
            scratch: &mut *self.scratch,
            memory: &mut *self.state,
            guard: reborrowed(&mut self.guard),
            moved: None,
        };
        let result = run(
            self.instance,
            subset,
            &schedule,
            deadline,
            &mut engine,
            first_levels,
        );
        self.workspace.x.copy_from_slice(&first_levels.keeper.x);
        total.iterations += result.iterations;
        // Each search has the solver's number of attempts, from the same starts.
        total.attempts = total.attempts.max(result.attempts);
        total.counts += result.counts;
        result.reached
    }

    /// Returns whether the required tasks cost less at the current variables than at `x`, and overwrites `residual`
    /// with that at `x`.
    fn is_better_than(&mut self, x: &[f64], residual: &mut [f64]) -> bool {
        let problem = self.instance.problem;
        let subset = problem.goals();
        let own_residual = &mut self.workspace.residual[..problem.rows_of(subset)];
        let mut evaluation = Evaluation::of(subset, self.instance, self.scratch);
        evaluation.residual(x, residual);
        evaluation.residual(&self.workspace.x, own_residual);
        is_better(problem, 1.0 - COST_TOLERANCE, own_residual, residual)
    }

    /// Runs the descent of a level from the result of the levels above. Returns the reason if it ended early.
    fn descend(&mut self, rank: usize, total: &mut SearchResult) -> Option<Termination> {
        let subset = TaskSubset::above(rank);
        let LevelWorkspace {
            x,
            residual,
            descents,
            reached_residual,
            reached_levels,
            ..
        } = &mut *self.workspace;
        let descent = descents.get_mut(rank - 1)?;
        let residual = &mut residual[..self.instance.problem.rows_of(subset)];
        Evaluation::of(subset, self.instance, self.scratch).residual(x, residual);
        let reached_rows = self
            .instance
            .problem
            .rows_of(TaskSubset::above((*reached_levels).min(rank)));
        let mut problem = DescentProblem {
            instance: self.instance,
            scratch: &mut *self.scratch,
            state: &mut *self.state,
            stopping: self.descent.stopping,
            deadline: self.descent.deadline,
            counts: Counts::default(),
        };
        let result = descent.run(
            &mut problem,
            &Start {
                x,
                residual,
                held_residual: &reached_residual[..reached_rows],
            },
            self.descent.extent,
            self.observer,
        );
        total.iterations += result.iterations;
        total.counts += problem.counts;
        x.copy_from_slice(&descent.x);
        result.early_end
    }

    /// Descends the soft tasks in the null space of the required tasks, from the result of these.
    pub(super) fn descend_preferences(&mut self, search: &mut Attempts, result: &mut SearchResult) {
        let problem = self.instance.problem;
        let (levels, ranks) = (problem.ranks().levels(), problem.ranks().count());
        let (extent, keeper) = (self.descent.extent, &mut search.keeper);
        let reached = problem.is_reached_by(problem.goals(), &keeper.residual);
        let runs_soft_tasks = extent.runs_soft_tasks(reached, result.iterations);
        if levels == ranks || !runs_soft_tasks || (!reached && !result.termination.is_settled()) {
            return;
        }
        self.workspace.x.copy_from_slice(&keeper.x);
        for rank in levels..ranks {
            let early_end = self.descend(rank, result);
            // An iteration limit is not reported: soft tasks may converge slowly.
            if let Some(early_end) =
                early_end.filter(|early_end| *early_end != Termination::IterationLimit)
            {
                result.termination = early_end;
                break;
            }
        }
        keeper.x.copy_from_slice(&self.workspace.x);
        let mut evaluation = Evaluation::of(problem.goals(), self.instance, self.scratch);
        evaluation.residual(&keeper.x, &mut keeper.residual);
    }

    /// Computes the multipliers of the Lagrangian gradient of the first unreached level at `x`.
    ///
    /// They are its own residual, and for the rows of the levels above the values that cancel the gradient in their row
    /// space.
    pub(super) fn compute_multipliers(&mut self, x: &[f64], residual: &[f64]) {
        let problem = self.instance.problem;
        let unreached = (0..problem.ranks().levels()).find(|&level| {
            let level_residual = &residual[problem.ranks().rows_of(level)];
            !problem.is_reached_by(TaskSubset::rank(level), level_residual)
        });
        let LevelWorkspace {
            higher_span,
            multipliers,
            ..
        } = &mut *self.workspace;
        let (Some(level), subset) = (unreached, problem.goals()) else {
            return multipliers.copy_from_slice(residual);
        };
        let row_range = problem.ranks().rows_of(level);
        multipliers.fill(0.0);
        multipliers[row_range.clone()].copy_from_slice(&residual[row_range.clone()]);
        let mut evaluation = Evaluation::of(subset, self.instance, self.scratch);
        self.state.resize_derivatives(residual.len(), x.len());
        let (slope, _) = self.state.slope_at(&mut evaluation, x, multipliers);
        higher_span.clear();
        let slope = slope.to_vec();
        let is_at_bound: Vec<bool> = (0..x.len())
            .map(|j| !self.instance.space().is_between_bounds(x, j))
            .collect();
        add_rows(
            higher_span,
            self.state.jacobian(),
            0..row_range.start,
            &is_at_bound,
            MIN_INDEPENDENT_PART,
        );
        for (row, multiplier) in higher_span.multipliers(&slope) {
            multipliers[row] = multiplier;
        }
    }
}

/// Returns whether the required tasks of `residual` are better than those of `other_residual`.
///
/// The first level that differs decides. Its cost must be less than `max_ratio` times the other cost.
pub(super) fn is_better(
    problem: &Problem,
    max_ratio: f64,
    residual: &[f64],
    other_residual: &[f64],
) -> bool {
    for level in 0..problem.ranks().levels() {
        let rows = problem.ranks().rows_of(level);
        let is_reached = |r: &[f64]| problem.is_reached_by(TaskSubset::rank(level), r);
        let (residual, other_residual) = (&residual[rows.clone()], &other_residual[rows]);
        let (cost, other_cost) = (half_squared(residual), half_squared(other_residual));
        match (is_reached(residual), is_reached(other_residual)) {
            (true, true) => {}
            (true, false) => return true,
            (false, true) => return false,
            (false, false) if cost < max_ratio * other_cost => return true,
            (false, false) if cost > other_cost * (1.0 + COST_TOLERANCE) => return false,
            (false, false) => {}
        }
    }
    false
}
