//! Problems: tasks on a model, and bounds.

mod body_tasks;
mod camera;
mod derivative;
mod frozen;
mod parameters;
mod python_residual;
mod target;
mod task;

use kinopt::Workspace;
use kinopt::nalgebra::DMatrix;
use kinopt::problem::{Derivatives, Evaluation, Preferences, Question, Targets};
use kinopt::solver::LeastSquares;
use kinopt::task::Quantity;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};

use crate::arrays;
use crate::error::{OrRaise, invalid};
use crate::has_model::model_of;
use crate::pickling;
use crate::pool::Pool;
use crate::robot::Robot;
pub(crate) use camera::Camera;
pub(crate) use derivative::SolutionDerivative;
pub(crate) use frozen::{numbers, placement, rotation};
pub(crate) use parameters::{ParameterMap, parameters_of};
pub(crate) use python_residual::{is_raised, raise_later, raised};
pub(crate) use task::{Aimed, AnyTask, Move};
use task::{Numbers, items};

/// A bounded nonlinear least-squares problem: what the frames of a model should do, and within which
/// bounds.
///
/// `model` is a robot, a rig, a skeleton or a model; `tasks` are those of `kinopt.tasks`. Everything is
/// checked once, here, and nothing changes afterwards: many threads solve one problem, each with targets of
/// its own (`Solver.solve(problem, start, targets={"name": target})`).
///
/// `parameters` says which joints are free, locked or coupled; without it all are free but a robot's mimic
/// joints, which follow. `bounds` narrows joints for this problem: {"joint": (lower, upper)}, radians or
/// metres. `tolerance` is that of all tasks that set none: a number for metres and radians, or a dict by
/// quantity; unset it is 1e-6 m, 1e-6 rad and 1e-3 px, and infinite for joint units and ratios.
/// `derivatives` is "analytic", "dual", "forward_difference" or "central_difference". `preferences` act
/// "within_goals", costing them nothing, or are "traded" off against them by their weights.
///
/// Raises `UnknownNameError` for frames and joints that do not exist, and `InvalidValueError`, with the
/// task's name, for targets that are not finite, weights and tolerances below 0, bounds that leave nothing.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Problem {
    pub(crate) inner: kinopt::Problem,
    ids: Vec<Box<dyn AnyTask>>,
    pub(crate) workspaces: Pool<Workspace>,
    model: Py<PyAny>,
    given: Py<PyTuple>,
    options: Py<PyDict>,
}

#[pymethods]
impl Problem {
    #[new]
    #[pyo3(signature = (
        model, tasks, *, parameters = None, bounds = None, tolerance = None,
        derivatives = "analytic", preferences = "within_goals"
    ))]
    fn new(
        model: &Bound<'_, PyAny>,
        tasks: &Bound<'_, PyAny>,
        parameters: Option<&Bound<'_, ParameterMap>>,
        bounds: Option<&Bound<'_, PyAny>>,
        tolerance: Option<&Bound<'_, PyAny>>,
        derivatives: &str,
        preferences: &str,
    ) -> PyResult<Self> {
        let py = model.py();
        let own = model_of(model)?;
        let mut builder = kinopt::Problem::builder(&own);
        match (parameters, model.cast::<Robot>()) {
            (Some(map), _) => {
                builder.parameters(map.get().inner.clone());
            }
            (None, Ok(robot)) => {
                builder.parameters(robot.get().inner.map().clone());
            }
            (None, Err(_)) => {}
        }
        let tasks = tasks
            .try_iter()
            .map_err(|_| invalid("tasks must be a list of tasks"))?;
        let tasks: Vec<_> = tasks.collect::<PyResult<_>>()?;
        let ids = (tasks.iter()).map(|task| task::add(task, model, &own, &mut builder));
        let ids = ids.collect::<PyResult<Vec<_>>>()?;
        for (joint, limits) in items(bounds, "bounds")? {
            let joint = arrays::name(&joint, "a joint of bounds")?;
            let joint = own.joint(&joint).or_raise()?;
            builder.bound(joint, parameters::limits(&limits, "bounds")?);
        }
        if let Some(tolerance) = tolerance {
            let both = [Quantity::Metres, Quantity::Radians].into_iter();
            for (quantity, tolerance) in Numbers::of(tolerance, "tolerance")?.by(both) {
                builder.tolerance(quantity, tolerance);
            }
        }
        builder.derivatives(named("derivatives", derivatives, &DERIVATIVES)?);
        builder.preferences(named("preferences", preferences, &PREFERENCES)?);
        let inner = builder.build().or_raise()?;
        let options = PyDict::new(py);
        options.set_item("parameters", parameters)?;
        for (name, value) in [("bounds", bounds), ("tolerance", tolerance)] {
            if let Some(value) = value {
                let copy = py.import("copy")?.call_method1("deepcopy", (value,))?;
                options.set_item(name, copy)?;
            }
        }
        options.set_item("derivatives", derivatives)?;
        options.set_item("preferences", preferences)?;
        Ok(Self {
            inner,
            ids,
            workspaces: Pool::new(Workspace::new()),
            model: model.clone().unbind(),
            given: PyTuple::new(py, tasks)?.unbind(),
            options: options.unbind(),
        })
    }

    /// What the problem was stated on.
    #[getter]
    pub(crate) fn model(&self, py: Python<'_>) -> Py<PyAny> {
        self.model.clone_ref(py)
    }

    /// The tasks, as they were given.
    #[getter]
    fn tasks<'py>(&self, py: Python<'py>) -> Bound<'py, PyList> {
        self.given.bind(py).to_list()
    }

    /// The names of the tasks, by which targets are given and solutions report.
    #[getter]
    fn task_names(&self) -> Vec<&str> {
        let tasks = 0..self.inner.tasks();
        tasks
            .filter_map(|task| self.inner.task_name(task))
            .collect()
    }

    /// How many solver variables there are.
    #[getter]
    fn variables(&self) -> usize {
        self.inner.variables()
    }

    /// How many residual rows there are.
    #[getter]
    fn rows(&self) -> usize {
        self.inner.rows()
    }

    /// How many numbers a configuration has.
    #[getter]
    fn configuration_len(&self) -> usize {
        self.inner.configuration_len()
    }

    /// Lower bounds of the variables, shape (variables,), radians or metres.
    #[getter]
    fn lower<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::list(py, self.inner.lower())
    }

    /// Upper bounds of the variables, shape (variables,), radians or metres.
    #[getter]
    fn upper<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::list(py, self.inner.upper())
    }

    /// The model's own length scale, metres.
    #[getter]
    fn reach(&self) -> f64 {
        self.inner.reach()
    }

    /// Which derivative route is taken.
    #[getter]
    fn derivatives(&self) -> &'static str {
        name_of(self.inner.derivatives(), &DERIVATIVES)
    }

    /// What preferences may cost the goals.
    #[getter]
    fn preferences(&self) -> &'static str {
        name_of(self.inner.preferences(), &PREFERENCES)
    }

    /// The same problem by another derivative route.
    ///
    /// Raises `UnknownNameError` for another route.
    fn with_derivatives(&self, py: Python<'_>, derivatives: &str) -> PyResult<Py<PyAny>> {
        let options = self.options.bind(py).copy()?;
        options.set_item("derivatives", derivatives)?;
        let arguments = (self.model.bind(py), self.given.bind(py));
        let problem = py.get_type::<Self>().call(arguments, Some(&options))?;
        Ok(problem.unbind())
    }

    /// The weighted residual r at variables `x`, shape (variables,) to shape (rows,).
    ///
    /// Raises `InvalidValueError` for another length, and as `Solver.solve` for `targets`; what a residual of
    /// yours raises comes out of here.
    #[pyo3(signature = (x, targets = None))]
    fn residual<'py>(
        &self,
        py: Python<'py>,
        x: &Bound<'py, PyAny>,
        targets: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let r = self.evaluate(py, x, targets, |problem, x, rows, _| {
            let mut r = vec![0.0; rows];
            problem.residual(x, &mut r);
            r
        })?;
        Ok(arrays::list(py, &r))
    }

    /// The derivative of the weighted residual at variables `x`, by the problem's route, shape (variables,)
    /// to shape (rows, variables).
    ///
    /// Raises as `residual`.
    #[pyo3(signature = (x, targets = None))]
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        x: &Bound<'py, PyAny>,
        targets: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let jacobian = self.evaluate(py, x, targets, |problem, x, rows, variables| {
            let mut jacobian = DMatrix::zeros(rows, variables);
            problem.jacobian(x, &mut jacobian);
            jacobian.transpose()
        })?;
        arrays::list(py, jacobian.as_slice()).reshape([self.rows(), self.variables()])
    }

    /// The gradient of half the squared residual at variables `x`, by reverse mode where derivatives are
    /// analytic, shape (variables,) to shape (variables,).
    ///
    /// Raises as `residual`.
    #[pyo3(signature = (x, targets = None))]
    fn gradient<'py>(
        &self,
        py: Python<'py>,
        x: &Bound<'py, PyAny>,
        targets: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let gradient = self.evaluate(py, x, targets, |problem, x, rows, variables| {
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
        let arguments = PyTuple::new(py, [self.model.bind(py), self.given.bind(py).as_any()])?;
        pickling::by_keywords::<Self>(py, &arguments, self.options.bind(py))
    }

    fn __repr__(&self) -> String {
        format!(
            "Problem({} variables, {} rows, tasks {:?})",
            self.variables(),
            self.rows(),
            self.task_names()
        )
    }
}

/// Targets read from Python, by task.
pub(crate) type Moves = Vec<(usize, Move)>;

impl Problem {
    /// Which task a key of targets is: a name or a number.
    fn task(&self, key: &Bound<'_, PyAny>) -> PyResult<usize> {
        if let Ok(index) = key.extract::<usize>() {
            return match index < self.ids.len() {
                true => Ok(index),
                false => Err(invalid(format!(
                    "targets speaks of task {index}, the problem has {}",
                    self.ids.len()
                ))),
            };
        }
        let Ok(name) = key.extract::<String>() else {
            return Err(invalid(
                "targets must be a dict by the tasks' names or numbers",
            ));
        };
        let names = self.task_names();
        let mut found = names.iter().enumerate().filter(|(_, own)| **own == name);
        match (found.next(), found.next()) {
            (Some((index, _)), None) => Ok(index),
            (Some(_), Some(_)) => Err(invalid(format!(
                "several tasks are named `{name}`: give targets by their numbers"
            ))),
            (None, _) => Err(kinopt::model::UnknownName::new("task", &name, names)).or_raise(),
        }
    }

    /// The targets of a dict by their tasks' numbers, unread.
    pub(crate) fn targets_by_task<'py>(
        &self,
        targets: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Vec<(usize, Bound<'py, PyAny>)>> {
        let mut by_task: Vec<(usize, Bound<'py, PyAny>)> = Vec::new();
        for (key, value) in items(targets, "targets")? {
            let task = self.task(&key)?;
            if by_task.iter().any(|(known, _)| *known == task) {
                return Err(invalid(format!("targets has two for task {task}")));
            }
            by_task.push((task, value));
        }
        Ok(by_task)
    }

    /// Reads a target of a task.
    pub(crate) fn read(&self, task: usize, value: &Bound<'_, PyAny>) -> PyResult<Move> {
        let name = self.inner.task_name(task).unwrap_or_default();
        self.ids[task].read(value, &format!("the target of {name}"))
    }

    /// Reads a dict of targets.
    pub(crate) fn moves(&self, targets: Option<&Bound<'_, PyAny>>) -> PyResult<Moves> {
        let targets = self.targets_by_task(targets)?.into_iter();
        targets
            .map(|(task, value)| Ok((task, self.read(task, &value)?)))
            .collect()
    }

    /// The problem's targets with some of them moved.
    pub(crate) fn targets_with<'a>(
        &self,
        moves: impl IntoIterator<Item = &'a Move>,
    ) -> PyResult<Targets> {
        let mut targets = self.inner.targets();
        for aim in moves {
            aim(&mut Aimed::Targets(&mut targets))?;
        }
        Ok(targets)
    }

    /// A question with these targets.
    pub(crate) fn question<'a>(&'a self, targets: &'a Targets) -> PyResult<Question<'a>> {
        self.inner.with_targets(targets).or_raise()
    }

    /// Something of the problem at x.
    fn evaluate<T: Send>(
        &self,
        py: Python<'_>,
        x: &Bound<'_, PyAny>,
        targets: Option<&Bound<'_, PyAny>>,
        what: impl FnOnce(&mut Evaluation<'_>, &[f64], usize, usize) -> T + Send,
    ) -> PyResult<T> {
        let x = arrays::vector_of(x, "x", self.variables())?.to_vec();
        let moves = self.moves(targets)?;
        let targets = self.targets_with(moves.iter().map(|(_, aim)| aim))?;
        let question = self.question(&targets)?;
        let value = py.detach(|| {
            let mut scratch = question.scratch();
            let mut evaluation = Evaluation::new(question, &mut scratch);
            let value = what(&mut evaluation, &x, self.rows(), self.variables());
            raised().map(|()| value)
        })?;
        Ok(value)
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

fn name_of<T: PartialEq>(value: T, known: &[(&'static str, T)]) -> &'static str {
    let found = known.iter().find(|(_, own)| *own == value);
    found.map_or("", |(name, _)| name)
}
