//! Immutable compiled problems.

use std::ops::Deref;
use std::sync::Arc;

use kinopt::Workspace;
use kinopt::collision::Checker;
use kinopt::model::JointId;
use kinopt::problem::{Evaluation, ProblemError};
use kinopt_bindings::names::{DERIVATIVES, PREFERENCES, named};
use kinopt_bindings::problem::NamedProblem;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyTuple};

use super::{ParameterMap, parameters, raised, task};
use crate::arrays::{self, items};
use crate::coordinates::Coordinates;
use crate::error::{OrRaise, invalid};
use crate::has_model::model_of;
use crate::object::Object;
use crate::pool::Pool;
use crate::robot::Robot;

/// A converted target.
pub(crate) type Move = kinopt_bindings::task::Move<Object>;

/// Targets read from Python, with task indices.
pub(crate) type Moves = Vec<(usize, Move)>;

/// Snapshot of a problem at the start of a solve.
pub(crate) struct CompiledProblem {
    problem: NamedProblem<Object>,
    model: Arc<kinopt::Model>,
    coordinates: PyOnceLock<Py<Coordinates>>,
    pub(crate) workspaces: Pool<Workspace>,
}

impl Deref for CompiledProblem {
    type Target = NamedProblem<Object>;

    fn deref(&self) -> &NamedProblem<Object> {
        &self.problem
    }
}

impl CompiledProblem {
    /// Names, limits and units of the numbers of a configuration.
    pub(crate) fn coordinates(&self, py: Python<'_>) -> PyResult<Py<Coordinates>> {
        let coordinates = self
            .coordinates
            .get_or_try_init(py, || Py::new(py, Coordinates::of_model(&self.model)));
        Ok(coordinates?.clone_ref(py))
    }

    /// Validates and compiles the tasks, with the options and the collision checker of a `Problem`. Without tasks,
    /// returns the error of the library.
    pub(crate) fn new(
        model: &Bound<'_, PyAny>,
        tasks: &Bound<'_, PyTuple>,
        options: &Bound<'_, PyDict>,
        checker: Option<&Checker>,
    ) -> PyResult<Result<Arc<Self>, String>> {
        let option = |name: &str| options.get_item(name);
        let inner_model = model_of(model)?;
        let mut builder = kinopt::Problem::builder(&inner_model);
        let map = option("parameters")?.filter(|map| !map.is_none());
        match (map, model.cast::<Robot>()) {
            (Some(map), _) => {
                builder.parameters(map.cast::<ParameterMap>()?.get().inner.clone());
            }
            (None, Ok(robot)) => {
                builder.parameters(robot.get().inner.map().clone());
            }
            (None, Err(_)) => {}
        }
        let ids = (tasks.iter()).map(|task| task::add(&task, model, &inner_model, &mut builder));
        let ids = ids.collect::<PyResult<Vec<_>>>()?;
        for (joint, limits) in items(option("bounds")?.as_ref(), "bounds")? {
            let joint = arrays::name(&joint, "a joint of bounds")?;
            let joint = inner_model.joint(&joint).or_raise()?;
            builder.bound(joint, parameters::limits(&limits, "bounds")?);
        }
        if let Some(tolerance) = option("tolerance")? {
            for (quantity, tolerance) in task::tolerances(&tolerance)? {
                builder.tolerance(quantity, tolerance);
            }
        }
        let text = |name: &str| options.as_any().get_item(name)?.extract::<String>();
        let derivatives = named("derivatives", &text("derivatives")?, &DERIVATIVES);
        builder.derivatives(derivatives.or_raise()?);
        let preferences = named("preferences", &text("preferences")?, &PREFERENCES);
        builder.preferences(preferences.or_raise()?);
        if let Some(checker) = checker {
            builder.keep_clear(checker);
        }
        let inner = match builder.build() {
            Err(none @ ProblemError::NoTasks { .. }) => return Ok(Err(none.to_string())),
            built => built.or_raise()?,
        };
        let inner = match option("weights")?.filter(|weights| !weights.is_none()) {
            Some(weights) => {
                let weights = arrays::vector(&weights, "weights")?.to_vec();
                inner.with_weights(&weights).or_raise()?
            }
            None => inner,
        };
        let inner = match origins(option("joint_origins")?.as_ref(), &inner_model)? {
            origins if origins.is_empty() => inner,
            origins => {
                let moved = kinopt::Model::clone(&inner_model);
                let moved = moved.with_joint_origins(origins).or_raise()?;
                inner.with_joint_origins(&moved).or_raise()?
            }
        };
        Ok(Ok(Arc::new(Self {
            problem: NamedProblem::new(inner, ids),
            model: inner_model,
            coordinates: PyOnceLock::new(),
            workspaces: Pool::new(Workspace::new()),
        })))
    }

    /// Index of the task for a key of targets: a name or an index.
    pub(crate) fn task(&self, key: &Bound<'_, PyAny>) -> PyResult<usize> {
        if let Ok(index) = key.extract() {
            return self.task_at(index);
        }
        let name = key.extract::<String>();
        self.task_named(
            &name.map_err(|_| invalid("targets must be a dict by the tasks' names or indices"))?,
        )
    }

    /// Targets of a dict with task indices, not yet converted.
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

    /// Converts a dict of targets.
    pub(crate) fn moves(&self, targets: Option<&Bound<'_, PyAny>>) -> PyResult<Moves> {
        let targets = self.targets_by_task(targets)?.into_iter();
        targets
            .map(|(task, value)| Ok((task, self.read(task, &Object::of(&value))?)))
            .collect()
    }

    /// Reads variables or a configuration. If both have the same length they are equal: every missing variable is a
    /// locked or mimic coordinate, or the fourth number of a quaternion.
    fn variables(&self, x: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
        let numbers = arrays::vector(x, "x")?;
        let (variables, configuration_len) =
            (self.inner.variables(), self.inner.configuration_len());
        match numbers.len() {
            length if length == variables => Ok(numbers.to_vec()),
            length if length == configuration_len => self.variables_of(&self.model, &numbers),
            length if configuration_len == variables => Err(invalid(format!(
                "x has shape ({length},), expected ({configuration_len},)"
            ))),
            length => Err(invalid(format!(
                "x has shape ({length},), expected variables, ({variables},), \
                 or a configuration, ({configuration_len},)"
            ))),
        }
    }

    /// Evaluates a quantity of the problem at x.
    pub(super) fn evaluate<T: Send>(
        &self,
        py: Python<'_>,
        x: &Bound<'_, PyAny>,
        targets: Option<&Bound<'_, PyAny>>,
        what: impl FnOnce(&mut Evaluation<'_>, &[f64], usize, usize) -> T + Send,
    ) -> PyResult<T> {
        let x = self.variables(x)?;
        let moves = self.moves(targets)?;
        let targets = self.targets_with(moves.iter().map(|(_, aim)| aim))?;
        let instance = self.instance(&targets)?;
        let value = py.detach(|| {
            let mut scratch = instance.scratch();
            let mut evaluation = Evaluation::new(instance, &mut scratch);
            let value = what(
                &mut evaluation,
                &x,
                self.inner.rows(),
                self.inner.variables(),
            );
            raised().map(|()| value)
        })?;
        Ok(value)
    }
}

/// Reads origins of joints relative to their parents.
fn origins(
    value: Option<&Bound<'_, PyAny>>,
    model: &kinopt::Model,
) -> PyResult<Vec<(JointId, [f64; 3])>> {
    let entries = items(value, "joint_origins")?.into_iter();
    entries
        .map(|(joint, origin)| {
            let joint = arrays::name(&joint, "a joint of joint_origins")?;
            let what = format!("the origin of {joint}");
            Ok((
                model.joint(&joint).or_raise()?,
                arrays::array(&origin, &what)?,
            ))
        })
        .collect()
}
