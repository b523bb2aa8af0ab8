//! Adapter of a solver method to the search engine interface.

use crate::clock::Instant;

use super::step_guard::{Guarded, StepGuard};
use crate::problem::{Evaluation, ProblemInstance, Scratch, TaskSubset};
use crate::search::{Attempt, Engine};
use crate::solver::{AnyMethod, LeastSquares, Observer, SolverState, Stopping};

/// Method applied to one problem instance.
pub(crate) struct Minimiser<'a> {
    pub(crate) question: ProblemInstance<'a>,
    /// Task subset that is minimised.
    pub(crate) share: TaskSubset,
    pub(crate) method: &'a dyn AnyMethod,
    pub(crate) deadline: Option<Instant>,
    pub(crate) observer: &'a mut dyn Observer,
    pub(crate) scratch: &'a mut Scratch,
    pub(crate) memory: &'a mut SolverState,
    /// Collision check of the steps, if any.
    pub(crate) guard: Option<&'a mut dyn StepGuard>,
}

impl Engine for Minimiser<'_> {
    fn residual_at_start(&mut self, start: &[f64]) -> &[f64] {
        let mut evaluation = Evaluation::of(self.share, self.question, self.scratch);
        self.memory.evaluate_at(&mut evaluation, start);
        self.memory.residual()
    }

    fn attempt(&mut self, x: &[f64], stopping: &Stopping) -> Attempt {
        let mut evaluation = Evaluation::of(self.share, self.question, self.scratch);
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
        Attempt {
            termination: outcome.termination,
            cost: self.memory.cost(),
            reached: evaluation.is_reached(self.memory.residual()),
            iterations: outcome.iterations,
            counts: self.memory.counts(),
            projected_gradient: outcome.projected_gradient,
        }
    }

    fn end(&self) -> (&[f64], &[f64]) {
        (self.memory.x(), self.memory.residual())
    }
}
