//! A solver is one step; everything around the step is shared.

use std::fmt::Debug;

use super::minimise::search;
use super::{Iterate, LeastSquares, Observer, Outcome, SolverState, Stopping};
use crate::bad_option::BadOption;
use crate::clock::Instant;

/// What a step did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Step {
    /// x moved.
    Taken,
    /// x stays; the next step will be more careful.
    Refused,
    /// No acceptable step is left.
    Stuck,
}

/// One way to go from x to a better x.
///
/// The loop around it takes derivatives, counts, observes and stops. One of your own is as good as those
/// here: `examples/own_method.rs` is Powell's dogleg in some 60 lines.
pub trait Method: Send + Sync + 'static {
    /// What it remembers from step to step of one search, and the room that it works in.
    type State: Clone + Debug + Default + Send + Sync + 'static;

    /// The name used in files, messages and on the command line.
    fn name(&self) -> &'static str;

    /// Whether [`step`](Self::step) needs the Jacobian or only the gradient.
    fn needs_jacobian(&self) -> bool;

    /// Whether its settings are in their ranges, asked before a search.
    ///
    /// # Errors
    /// The first that is not.
    fn check(&self) -> Result<(), BadOption> {
        Ok(())
    }

    /// Forgets the last search, and makes room for one with so many rows and variables, before anything is
    /// evaluated.
    fn reserve(&self, state: &mut Self::State, rows: usize, variables: usize) {
        let _ = (rows, variables);
        *state = Self::State::default();
    }

    /// Takes its first values, after the first derivatives.
    fn begin(&self, state: &mut Self::State, at: &SolverState);

    /// Tries one step. The derivatives are those at its x.
    fn step(&self, state: &mut Self::State, at: &mut Iterate<'_>) -> Step;

    /// What controls the length of the next step, for observers: λ of Levenberg-Marquardt, the step length
    /// of the others.
    fn control(&self, state: &Self::State) -> f64;

    /// Whether a state that was read from a file is one of a search with so many variables.
    fn fits(&self, state: &Self::State, variables: usize) -> bool {
        let _ = (state, variables);
        true
    }
}

/// A [`Method`] without its type, for lists and settings. Every method is one.
pub trait AnyMethod: Send + Sync {
    /// As [`Method::name`].
    fn name(&self) -> &'static str;

    /// As [`Method::needs_jacobian`].
    fn needs_jacobian(&self) -> bool;

    /// As [`Method::check`].
    ///
    /// # Errors
    /// As there.
    fn check(&self) -> Result<(), BadOption>;

    /// As [`minimise`](super::minimise()), without that check and with a deadline that several searches may share.
    fn minimise(
        &self,
        problem: &mut dyn LeastSquares,
        start: &[f64],
        stopping: &Stopping,
        deadline: Option<Instant>,
        observer: &mut dyn Observer,
        state: &mut SolverState,
    ) -> Outcome;
}

impl<M: Method> AnyMethod for M {
    answers! {
        fn name(&self) -> &'static str = Method::name(self);
        fn needs_jacobian(&self) -> bool = Method::needs_jacobian(self);
        fn check(&self) -> Result<(), BadOption> = Method::check(self);
    }

    fn minimise(
        &self,
        problem: &mut dyn LeastSquares,
        start: &[f64],
        stopping: &Stopping,
        deadline: Option<Instant>,
        observer: &mut dyn Observer,
        state: &mut SolverState,
    ) -> Outcome {
        // Out of its room for the search, so that both can change.
        let mut own = state.pool.take::<M::State>();
        let limits = (stopping, deadline);
        let outcome = search(problem, (self, &mut own), start, limits, observer, state);
        state.pool.keep(own);
        outcome
    }
}
