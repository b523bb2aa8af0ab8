//! Observation and cancellation of a search.

use std::ops::ControlFlow;

/// State of a search, passed to observers after every step and once before the first.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Iteration<'a> {
    /// Number of steps so far; 0 is the start.
    pub index: usize,
    /// ½‖r(x)‖².
    pub cost: f64,
    /// ‖proj(x − g) − x‖∞; `None` at a point that reaches the goal without derivatives.
    pub projected_gradient: Option<f64>,
    /// ‖x − previous x‖∞, 0 for a rejected step.
    pub step: f64,
    /// Quantity that controls the length of the next step, see [`Method::control`](super::Method::control).
    ///
    /// It is λ for Levenberg-Marquardt, and the step length for the other methods.
    pub control: f64,
    /// Current point of the search.
    pub x: &'a [f64],
}

/// Observer of every iteration, which may cancel the search. Closures are observers.
pub trait Observer {
    /// Called after every step; `Break` ends the search as cancelled.
    fn observe(&mut self, iteration: &Iteration<'_>) -> ControlFlow<()>;
}

impl<F: FnMut(&Iteration<'_>) -> ControlFlow<()>> Observer for F {
    fn observe(&mut self, iteration: &Iteration<'_>) -> ControlFlow<()> {
        self(iteration)
    }
}

/// Observer that does nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Observer for Silent {
    fn observe(&mut self, _iteration: &Iteration<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}
