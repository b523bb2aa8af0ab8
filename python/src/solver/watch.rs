//! Observation of a search from Python: an observer of the caller, Ctrl-C, and exceptions.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use kinopt::solver::Observer;
use pyo3::prelude::*;

use crate::arrays::Floats;
use crate::problem::{is_raised, raise_later};

/// Time between two checks for signals.
const SIGNAL_CHECK_INTERVAL: Duration = Duration::from_millis(5);

/// State of a search for an observer, after every step and once before the first.
#[pyclass(frozen, get_all, module = "kinopt")]
pub(crate) struct Iteration {
    /// Index of the step in its attempt; 0 before the first.
    index: usize,
    /// Half the sum of squared weighted residuals at `x`.
    cost: f64,
    /// Largest slope of the cost along a free variable; None if unknown.
    projected_gradient: Option<f64>,
    /// Length of the last step; 0 if it was rejected.
    step: f64,
    /// Parameter of the method: a damping or a step length.
    control: f64,
    /// Solver variables, shape (variables,).
    x: Floats,
}

#[pymethods]
impl Iteration {
    fn __repr__(&self) -> String {
        format!("Iteration({}, cost={:e})", self.index, self.cost)
    }
}

/// Library observer for the searches of one thread.
pub(super) struct Watch<'a> {
    observer: Option<&'a Py<PyAny>>,
    stop: Option<&'a AtomicBool>,
    next: Instant,
}

impl<'a> Watch<'a> {
    /// Calls an observer, if there is one, and checks for signals.
    pub(super) fn new(observer: Option<&'a Py<PyAny>>) -> Self {
        let next = Instant::now() + SIGNAL_CHECK_INTERVAL;
        let stop = None;
        Self {
            observer,
            stop,
            next,
        }
    }

    /// Stops when another thread sets the flag.
    pub(super) fn until(stop: &'a AtomicBool) -> Self {
        Self {
            stop: Some(stop),
            ..Self::new(None)
        }
    }

    /// Checks for signals every few milliseconds. Python raises them as exceptions on its main thread.
    pub(super) fn look_at_signals(&mut self) {
        let now = Instant::now();
        if now >= self.next {
            if let Err(error) = Python::attach(|py| py.check_signals()) {
                raise_later(error);
            }
            self.next = now + SIGNAL_CHECK_INTERVAL;
        }
    }
}

impl Observer for Watch<'_> {
    fn observe(&mut self, iteration: &kinopt::solver::Iteration<'_>) -> ControlFlow<()> {
        if let (Some(observer), false) = (self.observer, is_raised()) {
            match Python::attach(|py| ask(py, observer, iteration)) {
                Ok(false) => {}
                Ok(true) => return ControlFlow::Break(()),
                Err(error) => raise_later(error),
            }
        }
        match self.stop {
            None => self.look_at_signals(),
            Some(stop) if stop.load(Ordering::Relaxed) => return ControlFlow::Break(()),
            Some(_) => {}
        }
        match is_raised() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }
}

/// Calls the observer; true if it stops the search.
fn ask(
    py: Python<'_>,
    observer: &Py<PyAny>,
    seen: &kinopt::solver::Iteration<'_>,
) -> PyResult<bool> {
    let iteration = Iteration {
        index: seen.index,
        cost: seen.cost,
        projected_gradient: seen.projected_gradient,
        step: seen.step,
        control: seen.control,
        x: Floats(seen.x.to_vec()),
    };
    observer.bind(py).call1((iteration,))?.is_truthy()
}
