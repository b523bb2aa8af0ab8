//! Watching a search from Python: an observer of the caller's, Ctrl-C, exceptions on their way.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use kinopt::solver::Observer;
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arrays;
use crate::problem::{is_raised, raise_later};

/// How often signals are looked at.
const SIGNALS: Duration = Duration::from_millis(5);

/// What an observer sees after every step, and once before the first.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Iteration {
    /// Number of the step in its attempt; 0 before the first.
    #[pyo3(get)]
    index: usize,
    /// Half the squared weighted residual at `x`.
    #[pyo3(get)]
    cost: f64,
    /// How steep the cost is along the steepest free variable; None where it is not known.
    #[pyo3(get)]
    projected_gradient: Option<f64>,
    /// Length of the step that led here; 0 where it was refused.
    #[pyo3(get)]
    step: f64,
    /// The method's own number: a damping or a step length.
    #[pyo3(get)]
    control: f64,
    x: Vec<f64>,
}

#[pymethods]
impl Iteration {
    /// The variables, shape (variables,).
    #[getter]
    fn x<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::list(py, &self.x)
    }

    fn __repr__(&self) -> String {
        format!("Iteration({}, cost={:e})", self.index, self.cost)
    }
}

/// The library's observer of one thread's searches.
pub(super) struct Watch<'a> {
    observer: Option<&'a Py<PyAny>>,
    stop: Option<&'a AtomicBool>,
    next: Instant,
}

impl<'a> Watch<'a> {
    /// Asks an observer, if there is one, and looks at signals.
    pub(super) fn new(observer: Option<&'a Py<PyAny>>) -> Self {
        let next = Instant::now() + SIGNALS;
        let stop = None;
        Self {
            observer,
            stop,
            next,
        }
    }

    /// Stops where another thread says so.
    pub(super) fn until(stop: &'a AtomicBool) -> Self {
        Self {
            stop: Some(stop),
            ..Self::new(None)
        }
    }

    /// Looks at signals, which Python raises as exceptions on its main thread, every few milliseconds.
    pub(super) fn look_at_signals(&mut self) {
        let now = Instant::now();
        if now >= self.next {
            if let Err(error) = Python::attach(|py| py.check_signals()) {
                raise_later(error);
            }
            self.next = now + SIGNALS;
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

/// Whether the caller's observer wants the search to stop.
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
        x: seen.x.to_vec(),
    };
    observer.bind(py).call1((iteration,))?.is_truthy()
}
