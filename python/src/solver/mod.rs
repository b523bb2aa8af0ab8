//! Solvers: a method with its limits and restarts.

mod batch;
mod drag;
mod methods;
mod moves;
mod watch;

use std::time::Duration;

use kinopt_bindings::method::SolverMethod;
use kinopt_bindings::option::solver::SolverOptions;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arrays;
use crate::error::{OrRaise, invalid};
use crate::has_model::configuration_of_model;
use crate::object::Object;
use crate::pickling;
use crate::problem::{Problem, raised};
use crate::solution::Solution;
pub(crate) use batch::Solutions;
pub(crate) use drag::Drag;
pub(crate) use watch::Iteration;
use watch::Watch;

/// A solver with its settings: immutable and thread-safe.
///
/// `method` is one of `kinopt.methods` or its name: "levenberg-marquardt", "gauss-newton", "projected-gradient", "ccd",
/// "fabrik". The search ends at the first attempt that reaches. `patience` may be inf. Options:
///
/// Raises `InvalidValueError` for settings out of range. Results are bitwise reproducible on any machine, unless a time
/// limit is set.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Solver {
    engine: SolverMethod,
    limits: SolverOptions,
    options: Py<PyDict>,
}

impl Solver {
    /// Returns its optimiser; `user` names the caller in the error for geometric methods.
    pub(crate) fn optimiser(&self, user: &str) -> PyResult<&kinopt::Solver> {
        match &self.engine {
            SolverMethod::Optimiser(solver) => Ok(solver),
            SolverMethod::Geometric(_) => Err(invalid(format!(
                "{user} needs a method that minimises, which {} does not",
                self.engine.name()
            ))),
        }
    }
}

#[pymethods]
impl Solver {
    #[new]
    #[pyo3(signature = (
        method = None, *, attempts = None, seed = None, time_limit = None, max_iterations = None, agreeing = None,
        gradient_tolerance = None, step_tolerance = None, patience = None, restart_steps = None
    ))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn new(
        py: Python<'_>,
        method: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = crate::arrays::whole_or_none)] attempts: Option<u64>,
        #[pyo3(from_py_with = crate::arrays::whole_or_none)] seed: Option<u64>,
        time_limit: Option<f64>,
        #[pyo3(from_py_with = crate::arrays::whole_or_none)] max_iterations: Option<u64>,
        #[pyo3(from_py_with = crate::arrays::whole_or_none)] agreeing: Option<u64>,
        gradient_tolerance: Option<f64>,
        step_tolerance: Option<f64>,
        patience: Option<f64>,
        #[pyo3(from_py_with = crate::arrays::whole_or_none)] restart_steps: Option<u64>,
    ) -> PyResult<Self> {
        let counts = [("attempts", attempts), ("agreeing", agreeing)];
        if let Some((name, _)) = counts.iter().find(|(_, count)| *count == Some(0)) {
            return Err(invalid(format!("{name} is 0, which is less than 1")));
        }
        let limits = SolverOptions {
            max_iterations,
            gradient_tolerance: at_least_zero("gradient_tolerance", gradient_tolerance)?,
            step_tolerance: at_least_zero("step_tolerance", step_tolerance)?,
            patience: patience.map(steps).transpose()?,
            time_limit: seconds(time_limit)?,
            attempts,
            seed,
            agreeing,
            restart_steps,
        };
        let default = "levenberg-marquardt".into_pyobject(py)?.into_any();
        let method = method.unwrap_or(&default);
        let engine = methods::method(method, &limits)?;
        let options = PyDict::new(py);
        options.set_item("method", method)?;
        let entries = [
            ("max_iterations", max_iterations.into_pyobject(py)?),
            ("gradient_tolerance", gradient_tolerance.into_pyobject(py)?),
            ("step_tolerance", step_tolerance.into_pyobject(py)?),
            ("patience", patience.into_pyobject(py)?),
            ("time_limit", time_limit.into_pyobject(py)?),
            ("attempts", attempts.into_pyobject(py)?),
            ("seed", seed.into_pyobject(py)?),
            ("agreeing", agreeing.into_pyobject(py)?),
            ("restart_steps", restart_steps.into_pyobject(py)?),
        ];
        for (name, value) in entries {
            if !value.is_none() {
                options.set_item(name, value)?;
            }
        }
        Ok(Self {
            engine,
            limits,
            options: options.unbind(),
        })
    }

    /// Name of the method.
    #[getter]
    fn method(&self) -> &'static str {
        self.engine.name()
    }

    /// Solves `problem` from the configuration `start`, shape (nq,) or a dict by joint name whose missing joints are at
    /// the neutral configuration. It is projected into the limits. Locked joints and mimic joints take their values from
    /// the problem's parameters.
    ///
    /// `max_move` is a hard bound of each joint's displacement from `start`; of a ball joint, of its rotation angle. It
    /// is one number for each number of a configuration, shape (nq,), radians or metres, with inf for no limit and four
    /// equal numbers for a ball. `robot.velocity_limits * dt` is the step of a controller. It may also be a dict of
    /// those by joint, or one angle for all. A prismatic joint then moves at most the distance by which that angle
    /// moves a point at a quarter of the model's reach. Active bounds of this kind are among the `active_limits`, with
    /// the kind "move".
    ///
    /// `targets` replaces targets of the problem, by the tasks' names or indices: {"hand": [0.4, 0.1, 0.3]}; the
    /// problem itself does not change. `observer` is called with an `Iteration` before the first and after every step
    /// of each attempt, and stops the search by returning True. Ctrl-C and exceptions of a residual or an observer
    /// propagate to the caller.
    ///
    /// A target that is not reached is no error: see `Solution.reached` and `Solution.explain()`. Raises
    /// `InvalidValueError` for a start of another length or one that is not finite, for targets and moves of another
    /// shape, and for moves below 0. Raises it also for problems that a geometric method does not support.
    #[pyo3(signature = (problem, start, targets = None, *, max_move = None, observer = None))]
    fn solve(
        &self,
        py: Python<'_>,
        problem: &Bound<'_, Problem>,
        start: &Bound<'_, PyAny>,
        targets: Option<&Bound<'_, PyAny>>,
        max_move: Option<&Bound<'_, PyAny>>,
        observer: Option<Py<PyAny>>,
    ) -> PyResult<Solution> {
        let python_problem = problem.get();
        let problem = python_problem.compiled()?;
        let start = configuration_of_model(python_problem.model(py).bind(py), start, "start")?;
        let start = arrays::vector(&start, "start")?.to_vec();
        let moves = problem.moves(targets)?;
        let targets = problem.targets_with(moves.iter().map(|(_, aim)| aim))?;
        let mut instance = problem.instance(&targets)?;
        let limits = max_move
            .map(|max_move| moves::move_limits((python_problem, &problem), max_move, &start));
        let limits = limits.transpose()?;
        if let Some(limits) = &limits {
            instance = instance.with_moves(limits).or_raise()?;
        }
        let solution = py.detach(|| {
            problem.workspaces.with(|workspace| {
                let mut watch = Watch::new(observer.as_ref());
                let solution =
                    (self.engine).solve::<Object>(instance, &start, workspace, &mut watch);
                raised().and(solution)
            })
        })?;
        Ok(Solution::new(solution, problem.coordinates(py)?))
    }

    /// Solves `problem` from each of `starts`, shape (N, nq), or N times from one, shape (nq,).
    ///
    /// `targets` has N targets for each task, by the tasks' names or indices: {"hand": array of shape (N, 3)}. Without
    /// targets, `starts` defines the number of queries. The batch runs on `threads` threads (None: one for each core);
    /// results are equal at any number of them. `progress` is called with (done, total) from time to time; True shows a
    /// progress bar if tqdm is installed. Ctrl-C interrupts the batch. `max_move`, as in `solve`, bounds the
    /// displacement from each query's start. Raises as `solve`.
    #[pyo3(signature = (problem, starts, targets = None, *, max_move = None, threads = 1, progress = None))]
    fn solve_batch(
        &self,
        problem: &Bound<'_, Problem>,
        starts: &Bound<'_, PyAny>,
        targets: Option<&Bound<'_, PyAny>>,
        max_move: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = crate::arrays::whole_or_none)] threads: Option<usize>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Solutions> {
        let arguments = (starts, targets, max_move);
        batch::solve(&self.engine, problem, arguments, threads, progress)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pickling::by_keywords::<Self>(py, &PyTuple::empty(py), self.options.bind(py))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let mut options = Vec::new();
        for (name, value) in self.options.bind(py).iter() {
            options.push(format!("{name}={}", value.repr()?));
        }
        Ok(format!("Solver({})", options.join(", ")))
    }
}

fn at_least_zero(name: &str, value: Option<f64>) -> PyResult<Option<f64>> {
    match value {
        Some(value) if value.is_nan() || value < 0.0 => Err(invalid(format!(
            "{name} is {value}, which is no number of at least 0"
        ))),
        _ => Ok(value),
    }
}

/// Reads a number of steps, or infinity for no limit.
fn steps(patience: f64) -> PyResult<Option<usize>> {
    match patience {
        f64::INFINITY => Ok(None),
        _ if patience >= 1.0 && patience.fract() == 0.0 && patience <= 1e15 => {
            Ok(Some(patience as usize))
        }
        _ => Err(invalid(format!(
            "patience is {patience}, which is no whole number of at least 1, nor inf"
        ))),
    }
}

fn seconds(limit: Option<f64>) -> PyResult<Option<Duration>> {
    let Some(limit) = at_least_zero("time_limit", limit)? else {
        return Ok(None);
    };
    // A limit beyond the range of `Duration` is no limit.
    Ok(Duration::try_from_secs_f64(limit).ok())
}
