//! Reports of trajectory optimisation.

use kinopt::motion::trajectory::{self, MotionBound, MotionTermination};
use kinopt_bindings::names;
use numpy::PyArray1;
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

use crate::arrays;
use crate::pickling;

/// A required task whose error exceeds its tolerance in a sample.
#[pyclass(frozen, get_all, module = "kinopt")]
#[derive(Clone, Serialize, Deserialize)]
pub(crate) struct MissedFrame {
    /// Index of the sample.
    frame: usize,
    /// Name of the task.
    task: String,
    /// Quantity of the error: metres, radians, ….
    quantity: String,
    /// Error, in the unit of the quantity.
    error: f64,
}

/// An active limit of a trajectory in a sample.
#[pyclass(frozen, get_all, module = "kinopt")]
#[derive(Clone, Serialize, Deserialize)]
pub(crate) struct ActiveMotionLimit {
    /// Index of the sample; for a speed limit, of the second of the two samples.
    frame: usize,
    /// Name of the joint.
    joint: String,
    /// "position" or "speed".
    bound: String,
    /// "lower" or "upper"; for a speed limit, the sign of the velocity.
    side: String,
    /// Slope of the cost beyond the limit, per radian or metre.
    push: f64,
}

#[pymethods]
impl MissedFrame {
    fn __repr__(&self) -> String {
        let Self {
            frame, task, error, ..
        } = self;
        format!(
            "MissedFrame({frame}, {task:?}, {error:.3e} {})",
            self.quantity
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pickling::by_json::<Self>(py, self)
    }

    #[staticmethod]
    fn _rebuild(json: &str) -> PyResult<Self> {
        pickling::of_json(json)
    }
}

#[pymethods]
impl ActiveMotionLimit {
    fn __repr__(&self) -> String {
        let Self {
            frame, joint, side, ..
        } = self;
        format!(
            "ActiveMotionLimit({frame}, {joint:?}, {side} {})",
            self.bound
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pickling::by_json::<Self>(py, self)
    }

    #[staticmethod]
    fn _rebuild(json: &str) -> PyResult<Self> {
        pickling::of_json(json)
    }
}

/// Errors and active limits of an optimised trajectory.
#[pyclass(frozen, module = "kinopt")]
#[derive(Serialize, Deserialize)]
pub(crate) struct MotionReport {
    costs: Vec<f64>,
    /// ½ Σ ‖w ∘ r‖² of all tasks and rate costs.
    #[pyo3(get)]
    cost: f64,
    /// Part of the cost from velocities, accelerations and jerks.
    #[pyo3(get)]
    cost_of_rates: f64,
    /// "stationary", "small step" or "iteration limit"; with windows that of the worst.
    #[pyo3(get)]
    termination: String,
    /// Iterations of all windows.
    #[pyo3(get)]
    iterations: usize,
    /// Largest drift of a contact from its initial position, metres.
    #[pyo3(get)]
    slip: f64,
    /// Largest closure error of a loop in any sample, metres and radians: 0 without loops. Loops with an error above
    /// 1e-9 are in `missed`.
    #[pyo3(get)]
    loop_gap: f64,
    /// Missed tasks by sample, in order.
    #[pyo3(get)]
    missed: Vec<MissedFrame>,
    /// Active position and speed limits by sample, in order.
    #[pyo3(get)]
    active_limits: Vec<ActiveMotionLimit>,
}

impl MotionReport {
    pub(super) fn new(solved: &trajectory::MotionReport, frames: usize) -> Self {
        let frames = 0..frames;
        let missed = frames.clone().flat_map(|frame| {
            solved.missed(frame).map(move |miss| MissedFrame {
                frame,
                task: miss.task.to_owned(),
                quantity: miss.quantity.to_string(),
                error: miss.error,
            })
        });
        let limits = frames.clone().flat_map(|frame| {
            solved
                .active_limits(frame)
                .map(move |limit| ActiveMotionLimit {
                    frame,
                    joint: limit.joint.to_owned(),
                    bound: match limit.bound {
                        MotionBound::Speed => "speed",
                        _ => "position",
                    }
                    .to_owned(),
                    side: names::side(limit.side).to_owned(),
                    push: limit.push,
                })
        });
        let termination = match solved.termination() {
            MotionTermination::Stationary => "stationary",
            MotionTermination::SmallStep => "small step",
            _ => "iteration limit",
        };
        Self {
            missed: missed.collect(),
            active_limits: limits.collect(),
            costs: frames
                .filter_map(|frame| solved.frame_cost(frame))
                .collect(),
            cost: solved.cost(),
            cost_of_rates: solved.cost_of_rates(),
            termination: termination.to_owned(),
            iterations: solved.iterations(),
            slip: solved.slip(),
            loop_gap: solved.loop_gap(),
        }
    }
}

#[pymethods]
impl MotionReport {
    /// Cost ½ ‖w ∘ r‖² of each sample's tasks, shape (frames,).
    #[getter]
    fn frame_costs<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::list(py, &self.costs)
    }

    /// True if every required task is within its tolerance in every sample.
    #[getter]
    fn reached(&self) -> bool {
        self.missed.is_empty()
    }

    fn __repr__(&self) -> String {
        format!(
            "MotionReport({} frames, cost {:.6e}, {}, {} missed, {} limits)",
            self.costs.len(),
            self.cost,
            self.termination,
            self.missed.len(),
            self.active_limits.len()
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pickling::by_json::<Self>(py, self)
    }

    #[staticmethod]
    fn _rebuild(json: &str) -> PyResult<Self> {
        pickling::of_json(json)
    }
}
