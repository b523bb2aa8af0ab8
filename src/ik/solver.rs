//! A method with its limits and restarts: what a user calls.

use std::sync::Arc;

use super::levels::{ByRank, Extent, Ranked};
use super::minimiser::Minimiser;
use super::{Restarts, Solution, SolveError, Workspace};
use crate::bad_option::BadOption;
use crate::problem::{Question, Share};
use crate::search::{Schedule, check_start, run};
use crate::solver::{AnyMethod, LevenbergMarquardt, Method, Observer, Silent, Stopping};

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
        let problem = question.problem;
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
        let deadline = self.stopping.deadline();
        let mut engine = Minimiser {
            question,
            share,
            method: &*self.method,
            deadline,
            observer: &mut *observer,
            scratch: &mut scratch,
            memory: &mut workspace.memory,
        };
        let search = &mut workspace.search;
        let mut found = run(question, share, &schedule, deadline, &mut engine, search);
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
                observer,
            };
            let strict = problem.ranks().levels() > 1;
            if strict && !found.reached && !found.termination.is_cut() {
                ranked.solve_levels(search, &mut found);
            }
            ranked.refine(search, &mut found);
            if strict {
                ranked.take_multipliers(&search.keeper.x, &search.keeper.residual);
            }
        }
        workspace.report(question, &self.stopping, &mut scratch, &found);
        workspace.scratch = Some(scratch);
        Ok(&workspace.solution)
    }
}
