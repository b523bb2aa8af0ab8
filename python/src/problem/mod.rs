//! Problems: tasks on a model, and bounds.

mod body_tasks;
mod camera;
mod derivative;
mod frozen;
mod parameters;
mod python_residual;
mod stated;
mod target;
mod task;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use kinopt::collision::Checker;
use kinopt::nalgebra::DMatrix;
use kinopt::problem::{Derivatives, Preferences};
use kinopt::solver::LeastSquares;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};

use crate::arrays;
use crate::collision::Obstacles;
use crate::error::{OrRaise, invalid};
use crate::pickling;
use crate::solution::Collision;
use crate::world::World;
pub(crate) use camera::Camera;
pub(crate) use derivative::SolutionDerivative;
pub(crate) use frozen::{numbers, placement, rotation};
pub(crate) use parameters::{ParameterMap, limits as limits_of, parameters_of};
pub(crate) use python_residual::{is_raised, raise_later, raised};
pub(crate) use stated::Stated;
pub(crate) use target::Target;
pub(crate) use task::{Adds, Aimed, AnyTask, Move, add, items, tolerances};

/// A bounded nonlinear least-squares problem: what the frames of a model should do, and within which
/// bounds.
///
/// `model` is a robot, a rig, a skeleton or a model; `tasks` are those of `kinopt.tasks`, and `add` takes more.
/// Everything is checked where it is given. Many threads solve one problem, each with targets of
/// its own (`Solver.solve(problem, start, targets={"name": target})`); solves and drags that have begun keep the
/// tasks that they began with.
///
/// `parameters` says which joints are free, locked or coupled; without it all are free but a robot's mimic
/// joints, which follow. `bounds` narrows joints for this problem: {"joint": (lower, upper)}, radians or
/// metres. `tolerance` is that of all tasks that set none: a number for metres and radians, or a dict by
/// quantity; unset it is 1e-6 m (of a model in its own unit 1e-6 of its reach), 1e-6 rad and 1e-3 px, and infinite for joint
/// units and ratios.
/// `derivatives` is "analytic", "dual", "forward_difference" or "central_difference". `preferences` act
/// "within_goals", costing them nothing, or are "traded" off against them by their weights.
///
/// With a `world` (as it is now), a `margin` in metres or a `collision_model` the body keeps clear of the world's obstacles and of itself,
/// each pair at least the margin apart, and a solution that is not says which pairs touch (`Solution.collisions`); a `Drag` slides along what
/// is in its way. A robot has shapes, a rig with a skin gets capsules along its bones; anything else takes a `collision_model`.
///
/// `weights`, shape (rows of `Solution.rows`,), take the place of those that the tasks say, and `joint_origins`,
/// {"joint": (x, y, z)} in metres and the parent's axes, that of the model's: links of other lengths. A solution is
/// differentiable by both.
///
/// Raises `UnknownNameError` for frames and joints that do not exist, and `InvalidValueError`, with the
/// task's name, for targets that are not finite, weights and tolerances below 0, bounds that leave nothing.
/// What there is to solve raises `InvalidValueError` as long as there are no tasks.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Problem {
    model: Py<PyAny>,
    options: Py<PyDict>,
    /// What it keeps clear of, made once.
    checker: Option<Checker>,
    /// Locked for moments only, never while anything is computed or Python is called.
    current: Mutex<Current>,
}

/// What a problem is made of now.
struct Current {
    tasks: Py<PyTuple>,
    /// Where there are no tasks, that in words.
    stated: Result<Arc<Stated>, String>,
}

#[pymethods]
impl Problem {
    #[new]
    #[pyo3(signature = (
        model, tasks = None, *, parameters = None, bounds = None, tolerance = None,
        derivatives = "analytic", preferences = "within_goals", world = None, margin = None,
        collision_model = None, weights = None, joint_origins = None
    ))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn new(
        model: &Bound<'_, PyAny>,
        tasks: Option<&Bound<'_, PyAny>>,
        parameters: Option<&Bound<'_, ParameterMap>>,
        bounds: Option<&Bound<'_, PyAny>>,
        tolerance: Option<&Bound<'_, PyAny>>,
        derivatives: &str,
        preferences: &str,
        world: Option<&Bound<'_, PyAny>>,
        margin: Option<&Bound<'_, PyAny>>,
        collision_model: Option<&Bound<'_, PyAny>>,
        weights: Option<&Bound<'_, PyAny>>,
        joint_origins: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let py = model.py();
        let options = PyDict::new(py);
        options.set_item("parameters", parameters)?;
        // What may be changed later by who made it is copied.
        let given = [
            ("bounds", bounds),
            ("tolerance", tolerance),
            ("world", world),
            ("margin", margin),
            ("collision_model", collision_model),
            ("weights", weights),
            ("joint_origins", joint_origins),
        ];
        for (name, value) in given {
            if let Some(value) = value {
                let copy = py.import("copy")?.call_method1("deepcopy", (value,))?;
                options.set_item(name, copy)?;
            }
        }
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
        let stated = Stated::new(model, &tasks, &options, checker.as_ref())?;
        Ok(Self {
            model: model.clone().unbind(),
            options: options.unbind(),
            checker,
            current: Mutex::new(Current {
                tasks: tasks.unbind(),
                stated,
            }),
        })
    }

    /// Adds a task, on a strict `level` and with a `weight` of its own where they are given, as those keywords of
    /// the task say. Returns the task's number, by which `targets` and `Solution.tasks` know it, as by its name.
    ///
    /// Solves and drags that have begun go on without it. Raises as `Problem` does, and leaves the problem as it
    /// was then.
    #[pyo3(signature = (task, level = None, weight = None))]
    fn add(
        &self,
        py: Python<'_>,
        task: &Bound<'_, PyAny>,
        level: Option<&Bound<'_, PyAny>>,
        weight: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<usize> {
        let own = PyDict::new(py);
        for (name, value) in [("level", level), ("weight", weight)] {
            if let Some(value) = value {
                own.set_item(name, value)?;
            }
        }
        task::check(task)?;
        let task = match own.is_empty() {
            true => task.clone(),
            false => task.call_method1("_with", (own,))?,
        };
        loop {
            let before = self.given(py);
            let tasks = before.bind(py);
            let number = tasks.len();
            let tasks = tasks
                .as_sequence()
                .concat(PyTuple::new(py, [&task])?.as_sequence())?
                .to_tuple()?;
            let (model, options) = (self.model.bind(py), self.options.bind(py));
            let stated = Stated::new(model, &tasks, options, self.checker.as_ref())?;
            let mut current = self.lock();
            // Another thread may have added one meanwhile.
            if current.tasks.is(&before) {
                let tasks = tasks.unbind();
                let last = std::mem::replace(&mut *current, Current { tasks, stated });
                drop(current);
                // What was is freed by Python, where the lock is free again.
                drop(last);
                return Ok(number);
            }
        }
    }

    /// What the problem was stated on.
    #[getter]
    pub(crate) fn model(&self, py: Python<'_>) -> Py<PyAny> {
        self.model.clone_ref(py)
    }

    /// The tasks, as they were given.
    #[getter]
    fn tasks<'py>(&self, py: Python<'py>) -> Bound<'py, PyList> {
        self.given(py).bind(py).to_list()
    }

    /// The names of the tasks, by which targets are given and solutions report.
    #[getter]
    fn task_names(&self) -> Vec<String> {
        match self.stated() {
            Ok(stated) => stated.task_names().map(str::to_owned).collect(),
            Err(_) => Vec::new(),
        }
    }

    /// How many solver variables there are.
    #[getter]
    fn variables(&self) -> PyResult<usize> {
        Ok(self.stated()?.inner.variables())
    }

    /// How many residual rows there are.
    #[getter]
    fn rows(&self) -> PyResult<usize> {
        Ok(self.stated()?.inner.rows())
    }

    /// How many numbers a configuration has.
    #[getter]
    fn configuration_len(&self) -> PyResult<usize> {
        Ok(self.stated()?.inner.configuration_len())
    }

    /// Lower bounds of the variables, shape (variables,), radians or metres.
    #[getter]
    fn lower<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(arrays::list(py, self.stated()?.inner.lower()))
    }

    /// Upper bounds of the variables, shape (variables,), radians or metres.
    #[getter]
    fn upper<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(arrays::list(py, self.stated()?.inner.upper()))
    }

    /// The model's own length scale, metres.
    #[getter]
    fn reach(&self) -> PyResult<f64> {
        Ok(self.stated()?.inner.reach())
    }

    /// Which derivative route is taken.
    #[getter]
    fn derivatives(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        Ok(self
            .options
            .bind(py)
            .as_any()
            .get_item("derivatives")?
            .unbind())
    }

    /// What preferences may cost the goals.
    #[getter]
    fn preferences(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        Ok(self
            .options
            .bind(py)
            .as_any()
            .get_item("preferences")?
            .unbind())
    }

    /// The same problem by another derivative route.
    ///
    /// Raises `UnknownNameError` for another route.
    fn with_derivatives(&self, py: Python<'_>, derivatives: &str) -> PyResult<Py<PyAny>> {
        let options = self.options.bind(py).copy()?;
        options.set_item("derivatives", derivatives)?;
        self.with_options(&options)
    }

    /// What multiplies the rows, shape (rows of `Solution.rows`,), as the tasks' `weight` and `times` say.
    #[getter]
    fn weights<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(arrays::list(py, &self.stated()?.inner.weights()))
    }

    /// The same problem with other `weights`, shape (rows of `Solution.rows`,).
    ///
    /// Raises `InvalidValueError` for another shape, weights below 0 or not finite, and a problem in a world.
    fn with_weights(&self, py: Python<'_>, weights: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        let options = self.options.bind(py).copy()?;
        options.set_item("weights", weights)?;
        self.with_options(&options)
    }

    /// The same problem with the origins of some joints elsewhere on their parents, {"joint": (x, y, z)} in metres and
    /// the parent's axes. Weights and limits stay.
    ///
    /// Raises `UnknownNameError` for joints that do not exist, and `InvalidValueError` for places that are not finite
    /// and a problem in a world.
    fn with_joint_origins(
        &self,
        py: Python<'_>,
        joint_origins: &Bound<'_, PyAny>,
    ) -> PyResult<Py<PyAny>> {
        let options = self.options.bind(py).copy()?;
        let all = PyDict::new(py);
        for own in [
            options.get_item("joint_origins")?.as_ref(),
            Some(joint_origins),
        ] {
            for (joint, origin) in items(own, "joint_origins")? {
                all.set_item(joint, origin)?;
            }
        }
        options.set_item("joint_origins", all)?;
        self.with_options(&options)
    }

    /// The same problem in another world, as it is now, with another margin in metres or the same.
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

    /// The pairs that are nearer to each other than the margin at a configuration, the deepest first.
    ///
    /// Raises `InvalidValueError` for a problem that was made without `world` and without `margin`, of which it is not known what
    /// touches, for another length and numbers that are not finite.
    fn collisions(&self, py: Python<'_>, q: &Bound<'_, PyAny>) -> PyResult<Vec<Collision>> {
        let q = arrays::copied(q, "q")?;
        let Some(checker) = &self.checker else {
            return Err(invalid(
                "what touches is not known: the problem was made without a world or a margin to keep clear of",
            ));
        };
        let found = py.detach(|| checker.collisions(&q)).or_raise()?;
        Ok(found.into_iter().map(Collision::from).collect())
    }

    /// The weighted residual r at `x`, shape (rows,): at variables, shape (variables,), or at a configuration,
    /// shape (nq,), such as a solution's `q`.
    ///
    /// Raises `InvalidValueError` for another length, for a configuration that the problem cannot have (beyond limits, or a locked
    /// joint elsewhere), and as `Solver.solve` for `targets`; what a residual of yours raises comes out of here.
    #[pyo3(signature = (x, targets = None))]
    fn residual<'py>(
        &self,
        py: Python<'py>,
        x: &Bound<'py, PyAny>,
        targets: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let r = self
            .stated()?
            .evaluate(py, x, targets, |problem, x, rows, _| {
                let mut r = vec![0.0; rows];
                problem.residual(x, &mut r);
                r
            })?;
        Ok(arrays::list(py, &r))
    }

    /// The derivative of the weighted residual by the variables at `x`, as `residual` takes it, by the problem's route:
    /// shape (rows, variables). A ball joint and the turn of a free base are three variables.
    ///
    /// Raises as `residual`.
    #[pyo3(signature = (x, targets = None))]
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        x: &Bound<'py, PyAny>,
        targets: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let stated = self.stated()?;
        let jacobian = stated.evaluate(py, x, targets, |problem, x, rows, variables| {
            let mut jacobian = DMatrix::zeros(rows, variables);
            problem.jacobian(x, &mut jacobian);
            jacobian.transpose()
        })?;
        arrays::list(py, jacobian.as_slice())
            .reshape([stated.inner.rows(), stated.inner.variables()])
    }

    /// The gradient of half the squared residual by the variables at `x`, as `residual` takes it, by reverse mode where
    /// derivatives are analytic: shape (variables,).
    ///
    /// Raises as `residual`.
    #[pyo3(signature = (x, targets = None))]
    fn gradient<'py>(
        &self,
        py: Python<'py>,
        x: &Bound<'py, PyAny>,
        targets: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let gradient = self
            .stated()?
            .evaluate(py, x, targets, |problem, x, rows, variables| {
                let mut jacobian = DMatrix::zeros(rows, variables);
                let (mut r, mut gradient) = (vec![0.0; rows], vec![0.0; variables]);
                problem.residual(x, &mut r);
                problem.gradient(x, &r, &mut gradient, &mut jacobian);
                gradient
            })?;
        Ok(arrays::list(py, &gradient))
    }

    /// How the solution `q` of this problem, shape (nq,), changes with its targets, weights and links: a
    /// `SolutionDerivative`. `targets` are those that it was solved with.
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
        let arguments = PyTuple::new(py, [self.model.bind(py), self.given(py).bind(py).as_any()])?;
        pickling::by_keywords::<Self>(py, &arguments, self.options.bind(py))
    }

    fn __repr__(&self) -> String {
        match self.stated() {
            Ok(stated) => format!(
                "Problem({} variables, {} rows, tasks {:?})",
                stated.inner.variables(),
                stated.inner.rows(),
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

    fn with_options(&self, options: &Bound<'_, PyDict>) -> PyResult<Py<PyAny>> {
        let py = options.py();
        let arguments = (self.model.bind(py), self.given(py));
        let problem = py.get_type::<Self>().call(arguments, Some(options))?;
        Ok(problem.unbind())
    }

    fn given(&self, py: Python<'_>) -> Py<PyTuple> {
        self.lock().tasks.clone_ref(py)
    }

    /// A problem of its own with these tasks.
    fn as_it_is(&self, py: Python<'_>) -> Self {
        let current = self.lock();
        Self {
            model: self.model.clone_ref(py),
            options: self.options.clone_ref(py),
            checker: self.checker.clone(),
            current: Mutex::new(Current {
                tasks: current.tasks.clone_ref(py),
                stated: current.stated.clone(),
            }),
        }
    }

    /// What there is to solve, as it is now. Raises `InvalidValueError` where there are no tasks.
    pub(crate) fn stated(&self) -> PyResult<Arc<Stated>> {
        let stated = self.lock().stated.clone();
        stated.map_err(invalid)
    }
}

const DERIVATIVES: [(&str, Derivatives); 4] = [
    ("analytic", Derivatives::Analytic),
    ("dual", Derivatives::Dual),
    ("forward_difference", Derivatives::ForwardDifference),
    ("central_difference", Derivatives::CentralDifference),
];

const PREFERENCES: [(&str, Preferences); 2] = [
    ("within_goals", Preferences::WithinGoals),
    ("traded", Preferences::Traded),
];

/// One of some values by its name.
pub(crate) fn named<T: Copy>(
    kind: &'static str,
    name: &str,
    known: &[(&'static str, T)],
) -> PyResult<T> {
    let found = known.iter().find(|(own, _)| *own == name);
    let names = known.iter().map(|(own, _)| *own);
    found
        .map(|(_, value)| *value)
        .ok_or_else(|| kinopt::model::UnknownName::new(kind, name, names))
        .or_raise()
}
