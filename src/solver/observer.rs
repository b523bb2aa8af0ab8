//! Watching a search, and stopping it.

use std::ops::ControlFlow;

/// What an observer sees after every step, and once before the first.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Iteration<'a> {
    /// Steps so far; 0 is the start.
    pub index: usize,
    /// ½‖r(x)‖².
    pub cost: f64,
    /// ‖proj(x − g) − x‖∞; `None` at a point that is good enough to need no derivatives.
    pub projected_gradient: Option<f64>,
    /// ‖x − previous x‖∞, 0 for a refused step.
    pub step: f64,
    /// What controls the next step's length ([`Method::control`](super::Method::control)): λ of
    /// Levenberg-Marquardt, the step length of the others.
    pub control: f64,
    /// Where the search stands.
    pub x: &'a [f64],
}

/// Sees every iteration and may cancel. Closures are observers.
pub trait Observer {
    /// Called after every step; `Break` ends the search as cancelled.
    fn observe(&mut self, iteration: &Iteration<'_>) -> ControlFlow<()>;
}

impl<F: FnMut(&Iteration<'_>) -> ControlFlow<()>> Observer for F {
    fn observe(&mut self, iteration: &Iteration<'_>) -> ControlFlow<()> {
        self(iteration)
    }
}

/// Watches nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Observer for Silent {
    fn observe(&mut self, _iteration: &Iteration<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}
