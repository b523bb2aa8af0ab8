//! A method with its limits and restarts: what a user calls.

use std::sync::Arc;

use super::clear_engine::{ClearEngine, EngineRoom};
use super::levels::{ByRank, Extent, Ranked};
use super::minimiser::Minimiser;
use super::step_guard::{StepGuard, reborrowed};
use super::{Restarts, Solution, SolveError, Workspace};
use crate::bad_option::BadOption;
use crate::clock::Instant;
use crate::problem::{Evaluation, Fence, Question, Share};
use crate::search::{self, Engine, Found, Schedule, check_start};
use crate::solver::{
    AnyMethod, LeastSquares, LevenbergMarquardt, Method, Observer, Silent, Stopping,
};

/// A solver with its settings. Immutable and shareable; the memory is the caller's
/// [`Workspace`].
#[derive(Clone)]
pub struct Solver {
    method: Arc<dyn AnyMethod>,
    stopping: Stopping,
    restarts: Restarts,
    /// How far preferences act within what the goals leave free.
    refining: Extent,
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
    /// Levenberg-Marquardt with gain-ratio damping and default restarts.
    fn default() -> Self {
        Self::new(LevenbergMarquardt::default())
    }
}

impl Solver {
    /// A solver around any method, with default limits and restarts.
    #[must_use]
    pub fn new(method: impl Method) -> Self {
        Self {
            method: Arc::new(method),
            stopping: Stopping::default(),
            restarts: Restarts::default(),
            refining: Extent::Whole,
        }
    }

    getters! {
        /// The limits of each attempt.
        pub(super) fn stopping(&self) -> &Stopping = &self.stopping;
        /// How far preferences act.
        pub(super) fn refining(&self) -> Extent = self.refining;
        /// The method's name.
        pub fn method(&self) -> &'static str = self.method.name();
    }

    setters! {
        /// Sets how far preferences act within what the goals leave free.
        pub(super) fn with_refining(mut self, extent: Extent) { self.refining = extent }
        /// Sets the limits of each attempt; the time limit is for all of them together.
        pub fn with_stopping(mut self, stopping: Stopping) { self.stopping = stopping }
        /// Sets how often to try again.
        pub fn with_restarts(mut self, restarts: Restarts) { self.restarts = restarts }
    }

    /// Whether every option is in its range.
    pub(super) fn check(&self) -> Result<(), BadOption> {
        self.method.check()?;
        self.stopping.check()?;
        self.restarts.check()
    }

    /// Solves a problem, or a [question](Question) to it, from the configuration `start` (degrees of freedom; projected into the
    /// limits; locked and following joints take their values from the parameter map).
    ///
    /// Of a problem that [keeps clear](crate::problem::ProblemBuilder::keep_clear) of something, every attempt first meets the goals as if
    /// nothing were in the way; where it then touches something, it goes on from there with the clearance among the goals. The
    /// lowest attempt that is free counts, and preferences act within what goals and clearance leave free. Where none is free, the
    /// one counts that meets the goals and touches least, and [`Solution::collisions`] says what. The way from the start to
    /// the answer may be blocked: a [`Drag`](super::Drag) keeps that free.
    ///
    /// # Errors
    /// A start of the wrong length, or one that is not finite; an option out of its range. A target that is not reached is no
    /// error: see [`Solution::reached`] and [`Solution::explain`].
    pub fn solve<'a, 'w>(
        &self,
        question: impl Into<Question<'a>>,
        start: &[f64],
        workspace: &'w mut Workspace,
    ) -> Result<&'w Solution, SolveError> {
        self.solve_observed(question, start, workspace, &mut Silent)
    }

    /// As [`solve`](Self::solve), with memory of its own that is thrown away.
    ///
    /// # Errors
    /// As [`solve`](Self::solve).
    pub fn solve_once<'a>(
        &self,
        question: impl Into<Question<'a>>,
        start: &[f64],
    ) -> Result<Solution, SolveError> {
        let mut workspace = Workspace::new();
        self.solve(question, start, &mut workspace)?;
        Ok(workspace.solution)
    }

    /// As [`solve`](Self::solve), with an observer that sees every iteration of every attempt and
    /// may cancel. Iterations count from 0 in each attempt.
    ///
    /// # Errors
    /// As [`solve`](Self::solve).
    pub fn solve_observed<'a, 'w>(
        &self,
        question: impl Into<Question<'a>>,
        start: &[f64],
        workspace: &'w mut Workspace,
        observer: &mut dyn Observer,
    ) -> Result<&'w Solution, SolveError> {
        let question = question.into();
        let deadline = self.stopping.deadline();
        let mut run = Run {
            deadline,
            observer,
            guard: None,
            clear: None,
        };
        match question.problem.fence() {
            None => self.run(question, start, workspace, &mut run)?,
            Some(fence) => self.run_clear(fence, question, start, workspace, &mut run)?,
        }
        Ok(&workspace.solution)
    }

    /// Solves a question as if nothing were in the way, but for what steps are guarded from.
    pub(super) fn run(
        &self,
        question: Question<'_>,
        start: &[f64],
        workspace: &mut Workspace,
        run: &mut Run<'_>,
    ) -> Result<(), SolveError> {
        let problem = question.problem;
        let deadline = run.deadline;
        self.check()?;
        check_start(problem, start)?;
        let mut scratch = workspace.fit(question);
        let map = problem.parameters();
        map.gather(start, &mut workspace.search.start);

        let share = problem.search_share();
        // Where preferences are traded the minimum is the goal, and a stall is on the way to it.
        let patient = problem.pulls_in(share);
        let asked = (question, share);
        let schedule = Schedule::of_searches(asked, self.restarts, self.stopping, patient);
        let mut engine = Minimiser {
            question,
            share,
            method: &*self.method,
            deadline,
            observer: &mut *run.observer,
            scratch: &mut scratch,
            memory: &mut workspace.memory,
            guard: reborrowed(&mut run.guard),
            // What leads out of contact reads where the whole search is.
            moved: run.clear.is_none().then_some(&mut workspace.moved),
        };
        let search = &mut workspace.search;
        let mut clear_engine;
        let engine: &mut dyn Engine = match &mut run.clear {
            None => &mut engine,
            Some((fence, room)) => {
                clear_engine = ClearEngine::new(engine, fence, room);
                &mut clear_engine
            }
        };
        let mut found = search::run(question, share, &schedule, deadline, engine, search);
        if share != Share::All {
            let mut ranked = Ranked {
                question,
                by: ByRank {
                    method: &*self.method,
                    stopping: self.stopping,
                    schedule,
                    extent: self.refining,
                    deadline,
                },
                scratch: &mut scratch,
                solver: &mut workspace.memory,
                memory: &mut workspace.ranks,
                observer: &mut *run.observer,
                guard: reborrowed(&mut run.guard),
            };
            let strict = problem.ranks().levels() > 1;
            let touches =
                run.clear.is_some() && problem.is_reached_by(share, &search.keeper.residual);
            let all = self.refining != Extent::Attempt;
            if strict && all && !found.reached && !touches && !found.termination.is_cut() {
                ranked.solve_levels(search, &mut found);
            }
            ranked.descend_preferences(search, &mut found);
            if strict {
                ranked.take_multipliers(&search.keeper.x, &search.keeper.residual);
            }
        }
        workspace.report(question, &self.stopping, &mut scratch, &found);
        workspace.scratch = Some(scratch);
        Ok(())
    }

    /// Reports on another place, to which a search with more goals than the question's came.
    pub(super) fn report_at(
        &self,
        question: Question<'_>,
        x: &[f64],
        found: Found,
        workspace: &mut Workspace,
        observer: &mut dyn Observer,
    ) {
        let problem = question.problem;
        let share = problem.search_share();
        let mut scratch = workspace.fit(question);
        let kept = &mut workspace.search.keeper;
        kept.x.copy_from_slice(x);
        Evaluation::of(share, question, &mut scratch).residual(x, &mut kept.residual);
        if problem.ranks().levels() > 1 {
            let mut ranked = Ranked {
                question,
                by: ByRank {
                    method: &*self.method,
                    stopping: self.stopping,
                    schedule: Schedule::of_searches(
                        (question, share),
                        self.restarts,
                        self.stopping,
                        false,
                    ),
                    extent: self.refining,
                    deadline: None,
                },
                scratch: &mut scratch,
                solver: &mut workspace.memory,
                memory: &mut workspace.ranks,
                observer,
                guard: None,
            };
            ranked.take_multipliers(&kept.x, &kept.residual);
        }
        workspace.report(question, &self.stopping, &mut scratch, &found);
        workspace.scratch = Some(scratch);
    }
}

/// What goes with one search.
pub(super) struct Run<'a> {
    pub(super) deadline: Option<Instant>,
    pub(super) observer: &'a mut dyn Observer,
    /// What its steps keep clear of, where they do.
    pub(super) guard: Option<&'a mut dyn StepGuard>,
    /// What attempts are led out of, where they are.
    pub(super) clear: Option<(&'a Fence, &'a mut EngineRoom)>,
}
