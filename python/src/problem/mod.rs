//! Problems: tasks on a model, and bounds.

mod camera;
mod compiled;
mod derivative;
mod frozen;
mod parameters;
mod python_residual;
mod task;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use kinopt::collision::Checker;
use kinopt::nalgebra::DMatrix;
use kinopt::solver::LeastSquares;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};

use crate::arrays;
use crate::collision::Obstacles;
use crate::error::{OrRaise, invalid};
use crate::has_model::configuration_of_model;
use crate::pickling;
use crate::solution::Collision;
use crate::world::World;
pub(crate) use camera::Camera;
pub(crate) use compiled::{CompiledProblem, Move};
pub(crate) use derivative::SolutionDerivative;
pub(crate) use frozen::{goal, numbers, placement, rotation, target};
pub(crate) use parameters::{ParameterMap, limits as limits_of, parameters_of};
pub(crate) use python_residual::{is_raised, raise_later, raised};
pub(crate) use task::{add, tolerances};

/// A bounded nonlinear least-squares problem: tasks on the frames and joints of a model, within bounds.
///
/// Its unknowns are a configuration of shape (configuration_len,), radians and metres. Targets are in metres and radians.
///
/// `model` is a robot, a rig, a skeleton or a model; `tasks` are those of `kinopt.tasks`, and `add` appends more.
/// Arguments are validated immediately. Several threads can solve one problem, each with its own targets
/// (`Solver.solve(problem, start, targets={"name": target})`). Running solves and drags keep the tasks from their
/// start.
///
/// `parameters` defines the free, locked and coupled joints. By default all joints are free except a robot's mimic
/// joints. `bounds` narrows joints for this problem: {"joint": (lower, upper)}, radians or metres. `tolerance` is that
/// of all tasks that set none: a number for metres and radians, or a dict by quantity. The default is 1e-6 m (of a
/// model in its own unit 1e-6 of its reach), 1e-6 rad and 1e-3 px. It is infinite for joint units and ratios.
/// `derivatives` is "analytic", "dual", "forward_difference" or "central_difference". `preferences` act "within_goals",
/// at no cost to required tasks, or are "traded": weighted against them.
///
/// A `world` (copied at this moment), a `margin` in metres or a `collision_model` enables collision avoidance with the
/// world's obstacles and within the body. The distance of each pair is at least the margin. A solution in collision
/// lists the pairs (`Solution.collisions`); a `Drag` slides along obstacles. A robot has shapes, and a rig with a skin
/// gets capsules along its bones; any other model needs a `collision_model`.
///
/// `weights`, shape (rows of `Solution.rows`,), replace those of the tasks. `joint_origins`, {"joint": (x, y, z)} in
/// metres and the parent's axes, replace those of the model, for other link lengths. A solution is differentiable with
/// respect to both.
///
/// Raises `UnknownNameError` for unknown frames and joints. Raises `InvalidValueError`, with the task's name, for
/// targets that are not finite, weights and tolerances below 0, and empty bounds. Solving a problem without tasks
/// raises `InvalidValueError`.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Problem {
    model: Py<PyAny>,
    options: Py<PyDict>,
    /// Collision checker, created once.
    checker: Option<Checker>,
    /// Locked briefly, never during a computation or a call of Python.
    current: Mutex<Current>,
}

/// Current tasks of a problem.
struct Current {
    tasks: Py<PyTuple>,
    /// Compiled tasks, or the message of a problem without tasks.
    compiled: Result<Arc<CompiledProblem>, String>,
}

#[pymethods]
impl Problem {
    #[new]
    #[pyo3(signature = (
        model, tasks = None, *, tolerance = None, bounds = None, world = None, margin = None,
        collision_model = None, parameters = None, preferences = "within_goals", weights = None,
        joint_origins = None, derivatives = "analytic"
    ))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn new(
        model: &Bound<'_, PyAny>,
        tasks: Option<&Bound<'_, PyAny>>,
        tolerance: Option<&Bound<'_, PyAny>>,
        bounds: Option<&Bound<'_, PyAny>>,
        world: Option<&Bound<'_, PyAny>>,
        margin: Option<&Bound<'_, PyAny>>,
        collision_model: Option<&Bound<'_, PyAny>>,
        parameters: Option<&Bound<'_, ParameterMap>>,
        preferences: &str,
        weights: Option<&Bound<'_, PyAny>>,
        joint_origins: Option<&Bound<'_, PyAny>>,
        derivatives: &str,
    ) -> PyResult<Self> {
        let py = model.py();
        let keywords = [
            ("bounds", bounds),
            ("tolerance", tolerance),
            ("world", world),
            ("margin", margin),
            ("collision_model", collision_model),
            ("weights", weights),
            ("joint_origins", joint_origins),
        ];
        let options = pickling::kept(py, &keywords)?;
        options.set_item("parameters", parameters)?;
        options.set_item("derivatives", derivatives)?;
        options.set_item("preferences", preferences)?;
        let tasks = match tasks {
            None => Vec::new(),
            Some(tasks) => {
                let tasks = tasks.try_iter();
                let tasks = tasks.map_err(|_| invalid("tasks must be a list of tasks"))?;
                tasks.collect::<PyResult<_>>()?
            }
        };
        let tasks = PyTuple::new(py, tasks)?;
        let checker = Obstacles::of(&options)?.checker(model)?;
        let compiled = CompiledProblem::new(model, &tasks, &options, checker.as_ref())?;
        Ok(Self {
            model: model.clone().unbind(),
            options: options.unbind(),
            checker,
            current: Mutex::new(Current {
                tasks: tasks.unbind(),
                compiled,
            }),
        })
    }

    /// Adds a task, with the given strict priority `level` and `weight` if any, as the keywords of the task. Returns
    /// the index of the task, which `targets` and `Solution.tasks` accept like its name.
    ///
    /// Running solves and drags do not change. Raises as `Problem` does, and then leaves the problem unchanged.
    #[pyo3(signature = (task, level = None, weight = None))]
    fn add(
        &self,
        py: Python<'_>,
        task: &Bound<'_, PyAny>,
        level: Option<&Bound<'_, PyAny>>,
        weight: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<usize> {
        let overrides = PyDict::new(py);
        for (name, value) in [("level", level), ("weight", weight)] {
            if let Some(value) = value {
                overrides.set_item(name, value)?;
            }
        }
        task::check(task)?;
        let task = match overrides.is_empty() {
            true => task.clone(),
            false => task.call_method1("_with", (overrides,))?,
        };
        loop {
            let previous = self.task_tuple(py);
            let tasks = previous.bind(py);
            let number = tasks.len();
            let tasks = tasks
                .as_sequence()
                .concat(PyTuple::new(py, [&task])?.as_sequence())?
                .to_tuple()?;
            let (model, options) = (self.model.bind(py), self.options.bind(py));
            let compiled = CompiledProblem::new(model, &tasks, options, self.checker.as_ref())?;
            let mut current = self.lock();
            // Another thread may have added a task in the meantime.
            if current.tasks.is(&previous) {
                let tasks = tasks.unbind();
                let last = std::mem::replace(&mut *current, Current { tasks, compiled });
                drop(current);
                // Dropping it may call Python, so the lock is released first.
                drop(last);
                return Ok(number);
            }
        }
    }

    /// The model, robot, skeleton or rig of the problem.
    #[getter]
    pub(crate) fn model(&self, py: Python<'_>) -> Py<PyAny> {
        self.model.clone_ref(py)
    }

    /// The tasks as given.
    #[getter]
    fn tasks<'py>(&self, py: Python<'py>) -> Bound<'py, PyList> {
        self.task_tuple(py).bind(py).to_list()
    }

    /// Names of the tasks, for targets and reports.
    #[getter]
    fn task_names(&self) -> Vec<String> {
        match self.compiled() {
            Ok(compiled) => compiled.task_names().map(str::to_owned).collect(),
            Err(_) => Vec::new(),
        }
    }

    /// Number of solver variables.
    #[getter]
    fn variables(&self) -> PyResult<usize> {
        Ok(self.compiled()?.inner.variables())
    }

    /// Number of residual rows.
    #[getter]
    fn rows(&self) -> PyResult<usize> {
        Ok(self.compiled()?.inner.rows())
    }

    /// Length of a configuration.
    #[getter]
    fn configuration_len(&self) -> PyResult<usize> {
        Ok(self.compiled()?.inner.configuration_len())
    }

    /// Lower bounds of the variables, shape (variables,), radians or metres.
    #[getter]
    fn lower<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(arrays::list(py, self.compiled()?.inner.lower()))
    }

    /// Upper bounds of the variables, shape (variables,), radians or metres.
    #[getter]
    fn upper<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(arrays::list(py, self.compiled()?.inner.upper()))
    }

    /// Reach of the model, metres.
    #[getter]
    fn reach(&self) -> PyResult<f64> {
        Ok(self.compiled()?.inner.reach())
    }

    /// Derivative mode.
    #[getter]
    fn derivatives<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.options.bind(py).as_any().get_item("derivatives")
    }

    /// Mode of soft tasks: "within_goals" or "traded".
    #[getter]
    fn preferences<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.options.bind(py).as_any().get_item("preferences")
    }

    /// The problem with another derivative mode.
    ///
    /// Raises `UnknownNameError` for an unknown mode.
    fn with_derivatives(&self, py: Python<'_>, derivatives: &str) -> PyResult<Py<PyAny>> {
        self.with_option(py, "derivatives", derivatives)
    }

    /// Factors of the rows, shape (rows of `Solution.rows`,), from `weight` and `scale` of the tasks.
    #[getter]
    fn weights<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(arrays::list(py, &self.compiled()?.inner.weights()))
    }

    /// The problem with other `weights`, shape (rows of `Solution.rows`,).
    ///
    /// Raises `InvalidValueError` for another shape, weights below 0 or not finite, and a problem in a world.
    fn with_weights(&self, py: Python<'_>, weights: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        self.with_option(py, "weights", weights)
    }

    /// The problem with other origins of some joints relative to their parents, {"joint": (x, y, z)} in metres and the
    /// parent's axes. Weights and limits do not change.
    ///
    /// Raises `UnknownNameError` for unknown joints, and `InvalidValueError` for positions that are not finite and for
    /// a problem in a world.
    fn with_joint_origins(
        &self,
        py: Python<'_>,
        joint_origins: &Bound<'_, PyAny>,
    ) -> PyResult<Py<PyAny>> {
        let (options, all) = (self.options.bind(py), PyDict::new(py));
        for origins in [
            options.get_item("joint_origins")?.as_ref(),
            Some(joint_origins),
        ] {
            for (joint, origin) in arrays::items(origins, "joint_origins")? {
                all.set_item(joint, origin)?;
            }
        }
        self.with_option(py, "joint_origins", all)
    }

    /// The problem with another world, copied at this moment, and another margin in metres; None keeps the margin.
    ///
    /// Raises `InvalidValueError` as `Problem`.
    #[pyo3(signature = (world, margin = None))]
    fn with_world(
        &self,
        py: Python<'_>,
        world: &Bound<'_, World>,
        margin: Option<f64>,
    ) -> PyResult<Py<PyAny>> {
        let options = self.options.bind(py).copy()?;
        options.set_item("world", world)?;
        if let Some(margin) = margin {
            options.set_item("margin", margin)?;
        }
        self.with_options(&options)
    }

    /// Pairs nearer to each other than the margin at a configuration, the deepest first.
    ///
    /// Raises `InvalidValueError` for a problem that was made without `world` and without `margin`, for another length
    /// and numbers that are not finite.
    fn collisions(&self, py: Python<'_>, q: &Bound<'_, PyAny>) -> PyResult<Vec<Collision>> {
        let q = configuration_of_model(self.model.bind(py), q, "q")?;
        let q = arrays::copied(&q, "q")?;
        let Some(checker) = &self.checker else {
            return Err(invalid(
                "the problem has no collision avoidance: create it with world, margin or collision_model",
            ));
        };
        let collisions = py.detach(|| checker.collisions(&q)).or_raise()?;
        Ok(collisions.into_iter().map(Collision::from).collect())
    }

    /// Weighted residual r at `x`, shape (rows,). `x` is the variables, shape (variables,), or a configuration, shape
    /// (nq,), such as a solution's `q`.
    ///
    /// Raises `InvalidValueError` for another length, for a configuration outside the problem's limits or with another
    /// value of a locked joint, and as `Solver.solve` for `targets`. Exceptions of a custom residual propagate.
    #[pyo3(signature = (x, targets = None))]
    fn residual<'py>(
        &self,
        py: Python<'py>,
        x: &Bound<'py, PyAny>,
        targets: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let r = self
            .compiled()?
            .evaluate(py, x, targets, |problem, x, rows, _| {
                let mut r = vec![0.0; rows];
                problem.residual(x, &mut r);
                r
            })?;
        Ok(arrays::list(py, &r))
    }

    /// Jacobian of the weighted residual with respect to the variables at `x`, as for `residual`, by the problem's
    /// derivative mode: shape (rows, variables). A ball joint and the rotation of a free base are three variables.
    ///
    /// Raises as `residual`.
    #[pyo3(signature = (x, targets = None))]
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        x: &Bound<'py, PyAny>,
        targets: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let compiled = self.compiled()?;
        let jacobian = compiled.evaluate(py, x, targets, |problem, x, rows, variables| {
            let mut jacobian = DMatrix::zeros(rows, variables);
            problem.jacobian(x, &mut jacobian);
            jacobian.transpose()
        })?;
        arrays::list(py, jacobian.as_slice())
            .reshape([compiled.inner.rows(), compiled.inner.variables()])
    }

    /// Gradient of half the squared residual with respect to the variables at `x`, as for `residual`, by reverse mode
    /// if derivatives are analytic: shape (variables,).
    ///
    /// Raises as `residual`.
    #[pyo3(signature = (x, targets = None))]
    fn gradient<'py>(
        &self,
        py: Python<'py>,
        x: &Bound<'py, PyAny>,
        targets: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let gradient =
            self.compiled()?
                .evaluate(py, x, targets, |problem, x, rows, variables| {
                    let mut jacobian = DMatrix::zeros(rows, variables);
                    let (mut r, mut gradient) = (vec![0.0; rows], vec![0.0; variables]);
                    problem.residual(x, &mut r);
                    problem.gradient(x, &r, &mut gradient, &mut jacobian);
                    gradient
                })?;
        Ok(arrays::list(py, &gradient))
    }

    /// Derivative of the solution `q` of this problem, shape (nq,), with respect to its targets, weights and links: a
    /// `SolutionDerivative`. `targets` are those of the solve.
    ///
    /// Raises as `Solver.solve`.
    #[pyo3(signature = (q, targets = None))]
    fn derivative(
        slf: &Bound<'_, Self>,
        q: &Bound<'_, PyAny>,
        targets: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<SolutionDerivative> {
        SolutionDerivative::new(slf, q, targets)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let arguments = PyTuple::new(
            py,
            [self.model.bind(py), self.task_tuple(py).bind(py).as_any()],
        )?;
        pickling::by_keywords::<Self>(py, &arguments, self.options.bind(py))
    }

    fn __repr__(&self) -> String {
        match self.compiled() {
            Ok(compiled) => format!(
                "Problem({} variables, {} rows, tasks {:?})",
                compiled.inner.variables(),
                compiled.inner.rows(),
                self.task_names()
            ),
            Err(_) => "Problem(no tasks)".to_owned(),
        }
    }
}

impl Problem {
    fn lock(&self) -> MutexGuard<'_, Current> {
        self.current.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The problem with another value of an option.
    fn with_option<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        value: impl IntoPyObject<'py>,
    ) -> PyResult<Py<PyAny>> {
        let options = self.options.bind(py).copy()?;
        options.set_item(name, value)?;
        self.with_options(&options)
    }

    fn with_options(&self, options: &Bound<'_, PyDict>) -> PyResult<Py<PyAny>> {
        let py = options.py();
        let arguments = (self.model.bind(py), self.task_tuple(py));
        let problem = py.get_type::<Self>().call(arguments, Some(options))?;
        Ok(problem.unbind())
    }

    fn task_tuple(&self, py: Python<'_>) -> Py<PyTuple> {
        self.lock().tasks.clone_ref(py)
    }

    /// Independent problem with the current tasks.
    fn as_it_is(&self, py: Python<'_>) -> Self {
        let current = self.lock();
        Self {
            model: self.model.clone_ref(py),
            options: self.options.clone_ref(py),
            checker: self.checker.clone(),
            current: Mutex::new(Current {
                tasks: current.tasks.clone_ref(py),
                compiled: current.compiled.clone(),
            }),
        }
    }

    /// Returns the compiled problem. Raises `InvalidValueError` without tasks.
    pub(crate) fn compiled(&self) -> PyResult<Arc<CompiledProblem>> {
        let compiled = self.lock().compiled.clone();
        compiled.map_err(invalid)
    }
}
