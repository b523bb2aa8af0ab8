//! Interface of solver methods: a method is one step, and the rest is shared.

use std::fmt::Debug;

use super::minimise::search;
use super::{Iterate, LeastSquares, Observer, Outcome, SolverState, Stopping};
use kinopt_kinematics::bad_option::BadOption;
use kinopt_kinematics::clock::Instant;

/// Result of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Step {
    /// x moved.
    Taken,
    /// x stays; the next step will be more cautious.
    Refused,
    /// No acceptable step is left.
    Stuck,
}

/// Method for one step from x to a better x.
///
/// The loop around it evaluates derivatives, counts, observes and stops. Other implementations are equal to those of
/// this crate: `examples/rust/own_method.rs` is Powell's dogleg in some 60 lines.
pub trait Method: Send + Sync + 'static {
    /// State and scratch memory that a method keeps from step to step of one search.
    type State: Clone + Debug + Default + Send + Sync + 'static;

    /// Name used in files, messages and on the command line.
    fn name(&self) -> &'static str;

    /// Returns true if [`step`](Self::step) needs the Jacobian, not only the gradient.
    fn needs_jacobian(&self) -> bool;

    /// Checks that the settings are in their ranges; called before a search.
    ///
    /// # Errors
    /// Returns an error for the first setting out of its range.
    fn check(&self) -> Result<(), BadOption> {
        Ok(())
    }

    /// Resets the state and reserves memory for a search with this many rows and variables, before any evaluation.
    fn reserve(&self, state: &mut Self::State, rows: usize, variables: usize) {
        let _ = (rows, variables);
        *state = Self::State::default();
    }

    /// Initialises the state after the first derivatives.
    fn begin(&self, state: &mut Self::State, at: &SolverState);

    /// Tries one step. The derivatives are those at the current x.
    fn step(&self, state: &mut Self::State, at: &mut Iterate<'_>) -> Step;

    /// Quantity that controls the length of the next step, for observers.
    ///
    /// It is λ for Levenberg-Marquardt, and the step length for the other methods.
    fn control(&self, state: &Self::State) -> f64;

    /// Returns true if a state read from a file belongs to a search with this many variables.
    fn fits(&self, state: &Self::State, variables: usize) -> bool {
        let _ = (state, variables);
        true
    }
}

/// [`Method`] with its type erased, for lists and settings. Every method implements it.
pub trait AnyMethod: Send + Sync {
    /// Name of the method, see [`Method::name`].
    fn name(&self) -> &'static str;

    /// Returns true if a step needs the Jacobian, see [`Method::needs_jacobian`].
    fn needs_jacobian(&self) -> bool;

    /// Checks the settings, see [`Method::check`].
    ///
    /// # Errors
    /// Returns the error of [`Method::check`].
    fn check(&self) -> Result<(), BadOption>;

    /// Runs [`minimise`](super::minimise()) without checks, with a deadline that several searches may share.
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
    fn name(&self) -> &'static str {
        Method::name(self)
    }

    fn needs_jacobian(&self) -> bool {
        Method::needs_jacobian(self)
    }

    fn check(&self) -> Result<(), BadOption> {
        Method::check(self)
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
        // Taken out for the search, so that both can change.
        let mut method_state = state.pool.take::<M::State>();
        let limits = (stopping, deadline);
        let outcome = search(
            problem,
            (self, &mut method_state),
            start,
            limits,
            observer,
            state,
        );
        state.pool.keep(method_state);
        outcome
    }
}
