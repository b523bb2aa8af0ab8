//! The memory of solving, which belongs to the caller.

use super::Solution;
use super::attempts::{Found, settled};
use super::pulling::Pulls;
use super::refine::{Limits, Place, Refinement};
use crate::problem::{Evaluation, Question, Scratch, Share};
use crate::solver::{
    LeastSquares, Memory, Observer, Stopping, half_squared, negligible_slope,
    projected_gradient_norm,
};

/// Scratch memory and room for the solution. Reuse it from solve to solve: after the first on a
/// problem, a solve allocates nothing. It fits any problem, one at a time.
#[derive(Debug, Default)]
pub struct Workspace {
    pub(super) memory: Memory,
    pub(super) scratch: Option<Scratch>,
    pub(super) start: Vec<f64>,
    pub(super) attempt: Vec<f64>,
    pub(super) wander: Vec<bool>,
    /// Where the attempt from the start ended.
    pub(super) first_x: Vec<f64>,
    pub(super) best_x: Vec<f64>,
    /// The cost of every attempt that came to its end or stalled.
    pub(super) costs: Vec<f64>,
    /// Of the tasks that the search is for.
    pub(super) best_residual: Vec<f64>,
    /// Of all tasks.
    whole_residual: Vec<f64>,
    refinement: Refinement,
    pub(super) solution: Solution,
}

impl Workspace {
    /// Empty memory, which the first solve fills.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The solution of the last solve.
    #[must_use]
    pub fn solution(&self) -> &Solution {
        &self.solution
    }

    /// ½ Σ ‖W r‖² where the last solve ended, of what it searched for: of the goals alone where preferences
    /// act within them.
    pub(super) fn searched_cost(&self) -> f64 {
        half_squared(&self.best_residual)
    }

    /// Takes the problem's shape and hands out its scratch memory, new only for a new problem.
    pub(super) fn fit(&mut self, question: Question<'_>) -> Scratch {
        let problem = question.problem;
        let Self {
            start,
            attempt,
            first_x,
            best_x,
            ..
        } = self;
        for vector in [start, attempt, first_x, best_x] {
            vector.resize(problem.variables(), 0.0);
        }
        self.wander.resize(problem.variables(), true);
        let share = problem.search_share();
        self.best_residual.resize(problem.rows_of(share), 0.0);
        if share == Share::Goals {
            self.whole_residual.resize(problem.rows(), 0.0);
            self.refinement.fit(problem);
        }
        self.solution.pulling.clear();
        self.solution.pulling.reserve(problem.tasks());
        // A first solve that reaches its target names no limit; a later one may name them all.
        self.solution.blocked.clear();
        self.solution.blocked.reserve(problem.variables());
        match self.scratch.take() {
            Some(mut scratch) if scratch.fits(problem) => {
                if question.places_moved() {
                    scratch.forget();
                }
                scratch
            }
            _ => problem.scratch(),
        }
    }

    /// Lets the preferences act within what the goals leave free, from where these came to.
    pub(super) fn refine(
        &mut self,
        question: Question<'_>,
        scratch: &mut Scratch,
        found: &mut Found,
        limits: &Limits,
        observer: &mut dyn Observer,
    ) {
        let reached = question
            .problem
            .is_reached_by(Share::Goals, &self.best_residual);
        let follows = limits.extent.follows(reached, found.iterations);
        if !follows || (!reached && !settled(found.outcome.termination)) {
            return;
        }
        let from = Place {
            x: &self.best_x,
            residual: &self.best_residual,
            reached,
        };
        let memory = &mut self.memory;
        let refined = self
            .refinement
            .run(question, scratch, memory, &from, limits, observer);
        found.iterations += refined.iterations;
        found.counts += refined.counts;
        if let Some(cut) = refined.cut {
            found.outcome.termination = cut;
        }
        self.best_x.copy_from_slice(&self.refinement.x);
        let mut goals = Evaluation::of(Share::Goals, question, scratch);
        goals.residual(&self.best_x, &mut self.best_residual);
    }

    /// Fills the solution in from what a search found.
    pub(super) fn report(
        &mut self,
        question: Question<'_>,
        stopping: &Stopping,
        scratch: &mut Scratch,
        found: &Found,
    ) {
        let problem = question.problem;
        let solution = &mut self.solution;
        let share = problem.search_share();
        let (x, residual) = (&self.best_x, &self.best_residual);
        let cost = half_squared(residual);
        let reached = problem.is_reached_by(share, residual);
        solution.termination = found.outcome.termination;
        solution.projected_gradient = found.outcome.projected_gradient;
        solution.iterations = found.iterations;
        solution.attempts = found.attempts;
        let compared = !reached && settled(found.outcome.termination);
        solution.agreeing = if compared { found.agreeing } else { 0 };
        solution.counts = found.counts;
        solution.pulling.clear();
        let (mut gradient, mut column_norm): (&[f64], f64) = (&[], 0.0);
        if !reached {
            let mut evaluation = Evaluation::of(share, question, scratch);
            (gradient, column_norm) = self.memory.slope_at(&mut evaluation, x, residual);
        }
        let negligible = negligible_slope(column_norm, cost, stopping);
        let mut evaluation = Evaluation::new(question, scratch);
        if share == Share::All {
            solution.cost = found.cost;
            solution.measure(&mut evaluation, x, residual, gradient, negligible);
        } else {
            evaluation.residual(x, &mut self.whole_residual);
            let whole = &self.whole_residual;
            solution.cost = half_squared(whole);
            if !reached {
                let (lower, upper) = (question.lower(), question.upper());
                let left = projected_gradient_norm(x, gradient, 1.0, lower, upper);
                solution.projected_gradient = Some(left);
            }
            solution.measure(&mut evaluation, x, whole, gradient, negligible);
        }
        if reached {
            return;
        }
        solution.find_beyond(question);
        if share == Share::All && problem.has_preferences() {
            let pulls = Pulls {
                question,
                jacobian: self.memory.jacobian(),
                residual,
                negligible,
            };
            pulls.list(x, &mut self.attempt, &mut solution.pulling);
        }
    }
}
