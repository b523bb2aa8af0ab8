//! Solver with a method, stopping criteria and restarts: the entry point of inverse kinematics.

use std::sync::Arc;

use super::collision_free_search::{CollisionFreeEngine, SearchWorkspace};
use super::minimiser::Minimiser;
use super::priority::{Extent, PriorityDescent, PriorityLevels};
use super::step_guard::{StepGuard, reborrowed};
use super::{Restarts, Solution, SolveError, Workspace};
use crate::bad_option::BadOption;
use crate::clock::Instant;
use crate::problem::{CollisionConstraint, Evaluation, ProblemInstance, TaskSubset};
use crate::search::{self, Engine, Schedule, SearchResult, check_start};
use crate::solver::{
    AnyMethod, LeastSquares, LevenbergMarquardt, Method, Observer, Silent, Stopping,
};

/// Solver with its settings. It is immutable and shareable. The scratch memory is the caller's [`Workspace`].
#[derive(Clone)]
pub struct Solver {
    method: Arc<dyn AnyMethod>,
    stopping: Stopping,
    restarts: Restarts,
    /// Effort spent on soft tasks in the null space of the required tasks.
    extent: Extent,
}

impl std::fmt::Debug for Solver {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Solver")
            .field("method", &self.method.name())
            .field("stopping", &self.stopping)
            .field("restarts", &self.restarts)
            .finish()
    }
}

impl Default for Solver {
    /// Returns a Levenberg-Marquardt solver with gain-ratio damping and default restarts.
    fn default() -> Self {
        Self::new(LevenbergMarquardt::default())
    }
}

impl Solver {
    /// Creates a solver with a method, default stopping criteria and default restarts.
    #[must_use]
    pub fn new(method: impl Method) -> Self {
        Self {
            method: Arc::new(method),
            stopping: Stopping::default(),
            restarts: Restarts::default(),
            extent: Extent::Whole,
        }
    }

    /// Stopping criteria of each attempt.
    #[must_use]
    pub(super) fn stopping(&self) -> &Stopping {
        &self.stopping
    }

    /// Effort spent on soft tasks.
    #[must_use]
    pub(super) fn extent(&self) -> Extent {
        self.extent
    }

    /// Name of the method.
    #[must_use]
    pub fn method(&self) -> &'static str {
        self.method.name()
    }

    /// Sets the effort spent on soft tasks in the null space of the required tasks.
    #[must_use]
    pub(super) fn with_extent(mut self, extent: Extent) -> Self {
        self.extent = extent;
        self
    }

    /// Sets the stopping criteria of each attempt. The time limit applies to all attempts together.
    #[must_use]
    pub fn with_stopping(mut self, stopping: Stopping) -> Self {
        self.stopping = stopping;
        self
    }

    /// Sets the restarts.
    #[must_use]
    pub fn with_restarts(mut self, restarts: Restarts) -> Self {
        self.restarts = restarts;
        self
    }

    /// Checks that every option is in its range.
    pub(super) fn check(&self) -> Result<(), BadOption> {
        self.method.check()?;
        self.stopping.check()?;
        self.restarts.check()
    }

    /// Solves a problem or a [problem instance](ProblemInstance) from the configuration `start`.
    ///
    /// `start` is projected into the joint limits. Locked joints and mimic joints take their values from the parameter
    /// map.
    ///
    /// With [collision avoidance](crate::problem::ProblemBuilder::keep_clear), every attempt first solves the required
    /// tasks without it. If the result is in collision, the attempt continues from there with collision avoidance as a
    /// required task. The collision-free attempt with the lowest index is used. Soft tasks then act in the null space
    /// of required tasks and collision avoidance. If no attempt is collision-free, the result reaches the required
    /// tasks with the least penetration, and [`Solution::collisions`] lists the pairs. The motion from `start` to the
    /// solution is not checked. A [`Drag`](super::Drag) checks it.
    ///
    /// # Errors
    /// Returns an error if `start` has the wrong length or a number that is not finite, or if an option is out of its
    /// range. An unreached target is not an error: see [`Solution::reached`] and [`Solution::explain`].
    pub fn solve<'a, 'w>(
        &self,
        instance: impl Into<ProblemInstance<'a>>,
        start: &[f64],
        workspace: &'w mut Workspace,
    ) -> Result<&'w Solution, SolveError> {
        self.solve_observed(instance, start, workspace, &mut Silent)
    }

    /// Solves like [`solve`](Self::solve), with a temporary workspace.
    ///
    /// # Errors
    /// Returns the errors of [`solve`](Self::solve).
    pub fn solve_once<'a>(
        &self,
        instance: impl Into<ProblemInstance<'a>>,
        start: &[f64],
    ) -> Result<Solution, SolveError> {
        let mut workspace = Workspace::new();
        self.solve(instance, start, &mut workspace)?;
        Ok(workspace.solution)
    }

    /// Solves like [`solve`](Self::solve) with an observer of every iteration of every attempt, which may cancel.
    ///
    /// The iteration index restarts at 0 in each attempt.
    ///
    /// # Errors
    /// Returns the errors of [`solve`](Self::solve).
    pub fn solve_observed<'a, 'w>(
        &self,
        instance: impl Into<ProblemInstance<'a>>,
        start: &[f64],
        workspace: &'w mut Workspace,
        observer: &mut dyn Observer,
    ) -> Result<&'w Solution, SolveError> {
        let instance = instance.into();
        let deadline = self.stopping.deadline();
        let mut run = Run {
            deadline,
            observer,
            guard: None,
            clear: None,
        };
        match instance.problem.collision_constraint() {
            None => self.run(instance, start, workspace, &mut run)?,
            Some(constraint) => {
                self.run_collision_free(constraint, instance, start, workspace, &mut run)?
            }
        }
        Ok(&workspace.solution)
    }

    /// Solves a problem instance without collision avoidance, except for the step guard and the engine in `run`.
    pub(super) fn run(
        &self,
        instance: ProblemInstance<'_>,
        start: &[f64],
        workspace: &mut Workspace,
        run: &mut Run<'_>,
    ) -> Result<(), SolveError> {
        let problem = instance.problem;
        let deadline = run.deadline;
        self.check()?;
        check_start(problem, start)?;
        let mut scratch = workspace.fit(instance);
        let map = problem.parameters();
        map.gather(start, &mut workspace.search.start);

        let subset = problem.searched_subset();
        // Weighted soft tasks have a minimum instead of a tolerance, and progress may stall on the path to it.
        let has_weighted_tasks = problem.has_soft_tasks(subset);
        let query = (instance, subset);
        let schedule =
            Schedule::of_searches(query, self.restarts, self.stopping, has_weighted_tasks);
        let mut engine = Minimiser {
            instance,
            subset,
            method: &*self.method,
            deadline,
            observer: &mut *run.observer,
            scratch: &mut scratch,
            memory: &mut workspace.state,
            guard: reborrowed(&mut run.guard),
            // Collision avoidance needs all variables at the end of the search.
            moved: run
                .clear
                .is_none()
                .then_some(&mut workspace.moved_variables),
        };
        let search = &mut workspace.search;
        let mut collision_free_engine;
        let engine: &mut dyn Engine = match &mut run.clear {
            None => &mut engine,
            Some((constraint, search_workspace)) => {
                collision_free_engine =
                    CollisionFreeEngine::new(engine, constraint, search_workspace);
                &mut collision_free_engine
            }
        };
        let mut result = search::run(instance, subset, &schedule, deadline, engine, search);
        if subset != TaskSubset::All {
            let mut ranked = PriorityLevels {
                instance,
                descent: PriorityDescent {
                    method: &*self.method,
                    stopping: self.stopping,
                    schedule,
                    extent: self.extent,
                    deadline,
                },
                scratch: &mut scratch,
                state: &mut workspace.state,
                workspace: &mut workspace.levels,
                observer: &mut *run.observer,
                guard: reborrowed(&mut run.guard),
            };
            let has_levels = problem.ranks().levels() > 1;
            let reaches_in_collision =
                run.clear.is_some() && problem.is_reached_by(subset, &search.keeper.residual);
            let uses_all_levels = self.extent != Extent::Attempt;
            if has_levels
                && uses_all_levels
                && !result.reached
                && !reaches_in_collision
                && !result.termination.is_cut()
            {
                ranked.solve_levels(search, &mut result);
            }
            ranked.descend_preferences(search, &mut result);
            if has_levels {
                ranked.compute_multipliers(&search.keeper.x, &search.keeper.residual);
            }
        }
        workspace.report(instance, &self.stopping, &mut scratch, &result);
        workspace.scratch = Some(scratch);
        Ok(())
    }

    /// Reports on the variables `x`, found by a search with additional required tasks.
    pub(super) fn report_at(
        &self,
        instance: ProblemInstance<'_>,
        x: &[f64],
        result: SearchResult,
        workspace: &mut Workspace,
        observer: &mut dyn Observer,
    ) {
        let problem = instance.problem;
        let subset = problem.searched_subset();
        let mut scratch = workspace.fit(instance);
        let keeper = &mut workspace.search.keeper;
        keeper.x.copy_from_slice(x);
        Evaluation::of(subset, instance, &mut scratch).residual(x, &mut keeper.residual);
        if problem.ranks().levels() > 1 {
            let mut ranked = PriorityLevels {
                instance,
                descent: PriorityDescent {
                    method: &*self.method,
                    stopping: self.stopping,
                    schedule: Schedule::of_searches(
                        (instance, subset),
                        self.restarts,
                        self.stopping,
                        false,
                    ),
                    extent: self.extent,
                    deadline: None,
                },
                scratch: &mut scratch,
                state: &mut workspace.state,
                workspace: &mut workspace.levels,
                observer,
                guard: None,
            };
            ranked.compute_multipliers(&keeper.x, &keeper.residual);
        }
        workspace.report(instance, &self.stopping, &mut scratch, &result);
        workspace.scratch = Some(scratch);
    }
}

/// Per-search state of a solve.
pub(super) struct Run<'a> {
    pub(super) deadline: Option<Instant>,
    pub(super) observer: &'a mut dyn Observer,
    /// Collision check of the steps, if any.
    pub(super) guard: Option<&'a mut dyn StepGuard>,
    /// Collision constraint and workspace of a collision-free search, if any.
    pub(super) clear: Option<(&'a CollisionConstraint, &'a mut SearchWorkspace)>,
}
