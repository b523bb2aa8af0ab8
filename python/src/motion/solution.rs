//! Solutions of trajectory optimisation.

use kinopt::motion::trajectory::{self, MotionBound, MotionTermination};
use kinopt::solver::Side;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

use crate::arrays;
use crate::pickling;

/// A required task whose error exceeds its tolerance in a sample.
#[pyclass(frozen, get_all, module = "kinopt")]
#[derive(Clone)]
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
#[derive(Clone)]
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

macro_rules! parts {
    ($class:ident($($part:ident: $kind:ty),*), $repr:expr) => {
        #[pymethods]
        impl $class {
            fn __repr__(&self) -> String {
                let repr: fn(&Self) -> String = $repr;
                repr(self)
            }

            fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
                let report = slf.get();
                pickling::by_rebuild::<Self>(slf.py(), ($(report.$part.clone()),*))
            }

            #[staticmethod]
            fn _rebuild($($part: $kind),*) -> Self {
                Self { $($part),* }
            }
        }
    };
}

parts!(MissedFrame(frame: usize, task: String, quantity: String, error: f64), |miss| {
    format!("MissedFrame({}, {:?}, {:.3e} {})", miss.frame, miss.task, miss.error, miss.quantity)
});
parts!(ActiveMotionLimit(frame: usize, joint: String, bound: String, side: String, push: f64), |limit| {
    format!("ActiveMotionLimit({}, {:?}, {} {})", limit.frame, limit.joint, limit.side, limit.bound)
});

/// Solution of a trajectory problem, with its errors.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct MotionSolution {
    q: Vec<f64>,
    width: usize,
    costs: Vec<f64>,
    /// Names of the numbers of a configuration, the columns of `q`.
    #[pyo3(get)]
    names: Vec<String>,
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

impl MotionSolution {
    pub(super) fn new(
        solved: &trajectory::MotionSolution,
        names: Vec<String>,
        width: usize,
    ) -> Self {
        let frames = 0..solved.frames();
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
                    side: match limit.side {
                        Side::Lower => "lower",
                        Side::Upper => "upper",
                    }
                    .to_owned(),
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
            q: solved.q().to_vec(),
            width,
            names,
            cost: solved.cost(),
            cost_of_rates: solved.cost_of_rates(),
            termination: termination.to_owned(),
            iterations: solved.iterations(),
            slip: solved.slip(),
            loop_gap: solved.loop_gap(),
        }
    }
}

/// Data that rebuild a solution.
type Parts = (
    (Vec<f64>, usize, Vec<f64>, Vec<String>),
    (f64, f64, String, usize, f64, f64),
    Vec<(usize, String, String, f64)>,
    Vec<(usize, String, String, String, f64)>,
);

#[pymethods]
impl MotionSolution {
    /// All configurations, shape (frames, nq), within all position and speed limits.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        arrays::list(py, &self.q).reshape([self.costs.len(), self.width])
    }

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

    fn __len__(&self) -> usize {
        self.costs.len()
    }

    fn __repr__(&self) -> String {
        format!(
            "MotionSolution({} frames, cost {:.6e}, {}, {} missed, {} limits)",
            self.costs.len(),
            self.cost,
            self.termination,
            self.missed.len(),
            self.active_limits.len()
        )
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let solution = slf.get();
        let missed = solution.missed.iter().map(|miss| {
            (
                miss.frame,
                miss.task.clone(),
                miss.quantity.clone(),
                miss.error,
            )
        });
        let limits = solution.active_limits.iter().map(|limit| {
            let (bound, side) = (limit.bound.clone(), limit.side.clone());
            (limit.frame, limit.joint.clone(), bound, side, limit.push)
        });
        let parts: Parts = (
            (
                solution.q.clone(),
                solution.width,
                solution.costs.clone(),
                solution.names.clone(),
            ),
            (
                solution.cost,
                solution.cost_of_rates,
                solution.termination.clone(),
                solution.iterations,
                solution.slip,
                solution.loop_gap,
            ),
            missed.collect(),
            limits.collect(),
        );
        pickling::by_rebuild::<Self>(slf.py(), (parts,))
    }

    #[staticmethod]
    fn _rebuild(parts: Parts) -> Self {
        let ((q, width, costs, names), scalars, missed, limits) = parts;
        let (cost, cost_of_rates, termination, iterations, slip, loop_gap) = scalars;
        let missed = missed
            .into_iter()
            .map(|(frame, task, quantity, error)| MissedFrame {
                frame,
                task,
                quantity,
                error,
            });
        let limits =
            limits
                .into_iter()
                .map(|(frame, joint, bound, side, push)| ActiveMotionLimit {
                    frame,
                    joint,
                    bound,
                    side,
                    push,
                });
        Self {
            q,
            width,
            costs,
            names,
            cost,
            cost_of_rates,
            termination,
            iterations,
            slip,
            loop_gap,
            missed: missed.collect(),
            active_limits: limits.collect(),
        }
    }
}
