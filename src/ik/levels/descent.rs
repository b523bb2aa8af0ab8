//! A rank's descent within what the ranks above leave free.
//!
//! Minimise ½‖r‖² of one rank over the configurations at which the ranks above are what they were when their
//! own searches ended, by successive projection: a step that is best for a model of the rank and leaves what is
//! [held](super::held_ranks) alone, then the shortest steps that bring that back. The steps are those of
//! [Newton's method](super::newton). Below a missed rank, preferences in a frame of a drag take cheaper
//! [conjugate steps](super::conjugate_steps).
//!
//! Conjugate steps would oscillate in frames that reach their goals: the held rows bend, the Gauss-Newton model omits that, and a
//! step that lowers the cost still overshoots its minimum.

use nalgebra::DMatrix;

use super::descent_problem::DescentProblem;
use super::held_ranks::Held;
use super::newton::NewtonMemory;
use super::step_limits::Extent;
use crate::problem::{Problem, Question, Share};
use crate::solver::{HeldStep, LeastSquares, Observer, Termination, half_squared};

/// Longest step of one joint, as a share of half a turn or of the reach.
const LONGEST: f64 = 0.25;

/// How a descent went; where it ended is in its x.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Descended {
    pub(super) iterations: usize,
    /// What ended it before nothing more was gained.
    pub(super) cut: Option<Termination>,
}

/// Where a descent starts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start<'a> {
    pub(super) x: &'a [f64],
    /// The residual there of the ranks above.
    pub(super) residual: &'a [f64],
    /// What is to be kept of the first of them, where their own searches came to that: the residual of their rows.
    pub(super) kept: &'a [f64],
}

/// A rank's descent, and room for it.
#[derive(Clone, Debug, Default)]
pub(super) struct Descent {
    pub(super) rank: usize,
    /// Where it stands.
    pub(super) x: Vec<f64>,
    pub(super) trial: Vec<f64>,
    /// The best step by the linear model, this time and last time.
    pub(super) best: Vec<f64>,
    pub(super) last_best: Vec<f64>,
    /// Where the search goes.
    pub(super) direction: Vec<f64>,
    /// What two steps do to the rank.
    pub(super) effects: [Vec<f64>; 2],
    pub(super) fixed: Vec<bool>,
    pub(super) held: Held,
    pub(super) pulls: Vec<f64>,
    pub(super) jacobian: DMatrix<f64>,
    pub(super) step: HeldStep,
    pub(super) newton: NewtonMemory,
}

impl Descent {
    /// Makes room for a rank of a problem.
    pub(super) fn fit(&mut self, problem: &Problem, rank: usize) {
        let n = problem.variables();
        let pulls = problem.rows_of(Share::rank(rank));
        self.rank = rank;
        for (vector, room) in [
            (&mut self.x, n),
            (&mut self.trial, n),
            (&mut self.best, n),
            (&mut self.last_best, n),
            (&mut self.direction, n),
            (&mut self.pulls, pulls),
        ] {
            vector.resize(room, 0.0);
        }
        for effect in &mut self.effects {
            effect.resize(pulls, 0.0);
        }
        self.fixed.resize(n, false);
        if self.jacobian.shape() != (pulls, n) {
            self.jacobian = DMatrix::zeros(pulls, n);
        }
        let held = self.held.fit(problem, rank);
        let rows = problem.rows_of(Share::above(rank + 1));
        self.newton.fit(n, rows, problem.edges_above(rank + 1));
        self.step.reserve(held, pulls, n);
    }

    /// Goes from a place to where the rank gains nothing more: a level's goals in so many steps at most,
    /// preferences in so many by whether the ranks above are reached.
    pub(super) fn run(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        from: &Start<'_>,
        extent: Extent,
        observer: &mut dyn Observer,
    ) -> Descended {
        let is_level = self.rank < descent.question.problem.ranks().levels();
        self.x.copy_from_slice(from.x);
        let Self { held, fixed, .. } = self;
        let reached = held.take(descent, self.rank, from.x, from.residual, fixed);
        if reached && !from.kept.is_empty() {
            self.return_to(descent, from.kept);
        }
        let steps = match is_level {
            true => extent.of_levels(),
            false => extent.of_preferences(reached),
        };
        match is_level || reached || extent == Extent::Whole {
            true => self.by_newton(descent, steps, observer),
            false => self.by_conjugate_steps(descent, steps, observer),
        }
    }

    /// Moves to where the first held rows are what their own searches left, if that is near.
    fn return_to(&mut self, descent: &mut DescentProblem<'_, '_>, kept: &[f64]) {
        self.cost_at_x(descent);
        descent.jacobian(Share::rank(self.rank), &self.x, &mut self.jacobian);
        if !self.step.take_pulls(&self.jacobian, &self.pulls) {
            return;
        }
        self.trial.copy_from_slice(&self.x);
        let here = self.held.keep(kept);
        match self.bring_back(descent) {
            true => self.x.copy_from_slice(&self.trial),
            false => {
                self.held.keep(&here);
            }
        }
    }

    /// Brings back at the trial what is held; whether it is.
    pub(super) fn bring_back(&mut self, descent: &mut DescentProblem<'_, '_>) -> bool {
        (self.held).bring_back(descent, &mut self.trial, &mut self.step, &self.fixed)
    }

    /// Whether its goals are reached by the last residual, where it has nothing else.
    pub(super) fn is_reached(&self, problem: &Problem) -> bool {
        let share = Share::rank(self.rank);
        self.rank < problem.ranks().levels()
            && !problem.pulls_in(share)
            && problem.is_reached_by(share, &self.pulls)
    }

    pub(super) fn cost_at_x(&mut self, descent: &mut DescentProblem<'_, '_>) -> f64 {
        let mut pulls = descent.evaluate(Share::rank(self.rank));
        pulls.residual(&self.x, &mut self.pulls);
        half_squared(&self.pulls)
    }

    pub(super) fn cost_at_trial(&mut self, descent: &mut DescentProblem<'_, '_>) -> f64 {
        let mut pulls = descent.evaluate(Share::rank(self.rank));
        pulls.residual(&self.trial, &mut self.pulls);
        half_squared(&self.pulls)
    }

    /// How much of the step the longest move of one joint allows.
    pub(super) fn longest_share(&self, question: Question<'_>) -> f64 {
        let moves = self.direction.iter().enumerate();
        let longest = moves.map(|(j, step)| step.abs() / (LONGEST * question.problem.spread(j)));
        1.0 / longest.fold(f64::MIN_POSITIVE, f64::max)
    }
}

/// J Δ.
pub(super) fn multiply(jacobian: &DMatrix<f64>, step: &[f64], product: &mut [f64]) {
    product.fill(0.0);
    let columns = jacobian.as_slice().chunks_exact(product.len().max(1));
    for (column, &step) in columns.zip(step).filter(|(_, step)| **step != 0.0) {
        for (sum, entry) in product.iter_mut().zip(column) {
            *sum += step * entry;
        }
    }
}
