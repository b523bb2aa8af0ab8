//! Adapter of a solver method to the search engine interface.

use kinopt_kinematics::clock::Instant;

use super::step_guard::{Guarded, StepGuard};
use crate::problem::{
    Evaluation, FullObserver, MovedVariables, ProblemInstance, ReducedProblem, ReducedWorkspace,
    Scratch, TaskSubset,
};
use crate::search::{Engine, SearchResult};
use crate::solver::{AnyMethod, LeastSquares, Observer, Outcome, SolverState, Stopping};

/// Method applied to one problem instance.
#[doc(hidden)]
pub struct Minimiser<'a> {
    #[doc(hidden)]
    pub instance: ProblemInstance<'a>,
    /// Task subset that is minimised.
    #[doc(hidden)]
    pub subset: TaskSubset,
    #[doc(hidden)]
    pub method: &'a dyn AnyMethod,
    #[doc(hidden)]
    pub deadline: Option<Instant>,
    #[doc(hidden)]
    pub observer: &'a mut dyn Observer,
    #[doc(hidden)]
    pub scratch: &'a mut Scratch,
    #[doc(hidden)]
    pub memory: &'a mut SolverState,
    /// Collision check of the steps, if any.
    #[doc(hidden)]
    pub guard: Option<&'a mut dyn StepGuard>,
    /// Memory for a search over only the variables that move a task.
    #[doc(hidden)]
    pub moved: Option<&'a mut ReducedWorkspace>,
}

impl<'a> Minimiser<'a> {
    /// Returns the variables to search, if not all are searched.
    fn moved_variables(&self) -> Option<&'a MovedVariables> {
        let problem = self.instance.problem;
        let needs_all = self.guard.is_some() || self.subset != problem.searched_subset();
        problem.moved_variables().filter(|_| !needs_all)
    }

    /// Searches over the moved variables.
    fn attempt_moved(
        instance: ProblemInstance<'_>,
        moved_variables: &MovedVariables,
        evaluation: &mut Evaluation<'_>,
        (method, observer): (&dyn AnyMethod, &mut dyn Observer),
        (x, memory): (&[f64], &mut ReducedWorkspace),
        (stopping, deadline): (&Stopping, Option<Instant>),
    ) -> Outcome {
        memory.begin(instance, moved_variables, x);
        let (buffers, start, state, observed_x) = memory.parts();
        let mut observer = FullObserver {
            observer,
            moved_variables,
            x: observed_x,
        };
        let mut problem = ReducedProblem {
            evaluation,
            moved_variables,
            buffers,
        };
        let outcome = method.minimise(
            &mut problem,
            start,
            stopping,
            deadline,
            &mut observer,
            state,
        );
        memory.end(moved_variables);
        outcome
    }
}

impl Engine for Minimiser<'_> {
    fn residual_at_start(&mut self, start: &[f64]) -> &[f64] {
        let is_moved = self.moved_variables().is_some();
        let mut evaluation = Evaluation::of(self.subset, self.instance, self.scratch);
        let state = match &mut self.moved {
            Some(memory) if is_moved => &mut memory.state,
            _ => &mut *self.memory,
        };
        state.evaluate_at(&mut evaluation, start);
        state.residual()
    }

    fn attempt(&mut self, x: &[f64], stopping: &Stopping) -> SearchResult {
        let variables = self.moved_variables();
        let mut evaluation = Evaluation::of(self.subset, self.instance, self.scratch);
        if let Some((variables, memory)) = variables.zip(self.moved.as_deref_mut()) {
            let outcome = Self::attempt_moved(
                self.instance,
                variables,
                &mut evaluation,
                (self.method, &mut *self.observer),
                (x, memory),
                (stopping, self.deadline),
            );
            return attempt(&evaluation, &memory.state, &outcome);
        }
        let mut guarded;
        let minimised: &mut dyn LeastSquares = match &mut self.guard {
            None => &mut evaluation,
            Some(guard) => {
                guarded = Guarded {
                    evaluation: &mut evaluation,
                    guard: &mut **guard,
                };
                &mut guarded
            }
        };
        let outcome = self.method.minimise(
            minimised,
            x,
            stopping,
            self.deadline,
            self.observer,
            self.memory,
        );
        attempt(&evaluation, self.memory, &outcome)
    }

    fn end(&self) -> (&[f64], &[f64]) {
        match (self.moved_variables(), &self.moved) {
            (Some(_), Some(memory)) => (&memory.x, memory.state.residual()),
            _ => (self.memory.x(), self.memory.residual()),
        }
    }
}

fn attempt(evaluation: &Evaluation<'_>, state: &SolverState, outcome: &Outcome) -> SearchResult {
    SearchResult {
        cost: state.cost(),
        reached: evaluation.is_reached(state.residual()),
        counts: state.counts(),
        projected_gradient: outcome.projected_gradient,
        ..SearchResult::single_attempt(outcome.termination, outcome.iterations)
    }
}
