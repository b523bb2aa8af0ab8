//! Derivatives of solutions with respect to problem parameters.

use std::sync::{Arc, Mutex};

use kinopt::ik::{DerivativeWorkspace, Differentiability, SolutionDerivative as Derivative};
use kinopt::problem::{ParameterVector, Targets};
use kinopt::spatial::Vector3;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::{CompiledProblem, Problem, raised};
use crate::arrays::{self, items};
use crate::error::{OrRaise, invalid};
use crate::has_model::model_of;
use crate::pickling;

/// The derivative of the solution `q` (shape (nq,), a configuration of the problem's model) with respect to the
/// targets, weights and link lengths of a problem. It uses the implicit function theorem with the active limits.
///
/// `targets` are those of the solve, as in `Solver.solve`. Check `differentiability` first: only if it is "unique" is
/// the solution a smooth function of the parameters. Velocities are those of `Model.integrate`, shape (dof,). A pose
/// target has six numbers: along and about its own axes, metres then radians. A position has three, a posture one for
/// each joint and three for each ball.
///
/// Raises `InvalidValueError` and `UnknownNameError` as `Solver.solve` does for its start and targets.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct SolutionDerivative {
    /// The problem at the time of the solve.
    problem: Py<Problem>,
    compiled: Arc<CompiledProblem>,
    model: Arc<kinopt::Model>,
    q: Vec<f64>,
    python_targets: Option<Py<PyAny>>,
    targets: Targets,
    differentiability: Differentiability,
    /// Factored system, shared by all products.
    workspace: Mutex<DerivativeWorkspace>,
}

impl SolutionDerivative {
    /// Calls a function with the derivative, which is factored at the first call.
    fn with<T: Send>(
        &self,
        py: Python<'_>,
        what: impl FnOnce(&mut Derivative<'_>) -> PyResult<T> + Send,
    ) -> PyResult<T> {
        let instance = self.compiled.instance(&self.targets)?;
        py.detach(|| {
            // A residual of the caller interrupted the factorisation, so it starts again.
            let mut workspace = self.workspace.lock().unwrap_or_else(|poisoned| {
                let mut workspace = poisoned.into_inner();
                *workspace = DerivativeWorkspace::default();
                workspace
            });
            let derivative = match Derivative::resume(instance, &mut workspace) {
                Some(derivative) => derivative,
                None => Derivative::new(instance, &self.q, &mut workspace).or_raise()?,
            };
            let mut derivative = derivative.with_joint_origins(&self.model).or_raise()?;
            let value = what(&mut derivative);
            raised().and(value)
        })
    }

    /// Key of a task in dicts: its name, or its index if several tasks have that name.
    fn key<'py>(&self, py: Python<'py>, task: usize) -> PyResult<Bound<'py, PyAny>> {
        let problem = &self.compiled.inner;
        let name = problem.task_name(task).unwrap_or_default();
        let same = (0..problem.tasks()).filter(|&other| problem.task_name(other) == Some(name));
        Ok(match same.count() {
            1 => name.into_pyobject(py)?.into_any(),
            _ => task.into_pyobject(py)?.into_any(),
        })
    }
}

#[pymethods]
impl SolutionDerivative {
    #[new]
    #[pyo3(signature = (problem, q, targets = None))]
    pub(super) fn new(
        problem: &Bound<'_, Problem>,
        q: &Bound<'_, PyAny>,
        targets: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let py = problem.py();
        let compiled = problem.get().compiled()?;
        let q = arrays::vector_of(q, "q", compiled.inner.configuration_len())?.to_vec();
        let moves = compiled.moves(targets)?;
        let python_targets = match targets {
            Some(targets) => {
                let copy = py.import("copy")?.call_method1("deepcopy", (targets,))?;
                Some(copy.unbind())
            }
            None => None,
        };
        let mut derivative = Self {
            model: model_of(problem.get().model.bind(py))?,
            problem: Py::new(py, problem.get().as_it_is(py))?,
            compiled: compiled.clone(),
            q,
            python_targets,
            targets: compiled.targets_with(moves.iter().map(|(_, aim)| aim))?,
            differentiability: Differentiability::Unique,
            workspace: Mutex::default(),
        };
        derivative.differentiability =
            derivative.with(py, |inner| Ok(inner.differentiability().clone()))?;
        Ok(derivative)
    }

    /// Differentiability: "unique"; "shortest_of_many", if the solution is not isolated and the derivative is the
    /// shortest change; or the reason why no derivative exists: "on_limit", "at_kink", "singular", "not_stationary",
    /// "not_finite".
    #[getter]
    fn differentiability(&self) -> &'static str {
        self.differentiability.name()
    }

    /// True if the solution is a smooth function of the parameters here.
    #[getter]
    fn is_unique(&self) -> bool {
        self.differentiability.is_unique()
    }

    /// Sentence about `differentiability`.
    fn explain(&self) -> String {
        self.differentiability.to_string()
    }

    /// Derivative with respect to the target of a task (a name, or an index), shape (dof, numbers of the target).
    ///
    /// Raises `UnknownNameError` and `InvalidValueError` for an unknown task.
    fn by_target<'py>(&self, task: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let py = task.py();
        let task = self.compiled.task(task)?;
        let matrix = self.with(py, |derivative| derivative.by_target(task).or_raise())?;
        let (rows, columns) = matrix.shape();
        let numbers = matrix.transpose();
        arrays::list(py, numbers.as_slice()).reshape([rows, columns])
    }

    /// Velocity of the solution, shape (dof,), for rates of the parameters. The rates are those of `targets`, a dict by
    /// task; of `weights`, shape (rows of `Solution.rows`,); of `joint_origins`, a dict by joint of three numbers,
    /// metres in the parent's axes. Parameters that are not given are constant.
    ///
    /// Raises `UnknownNameError` for unknown tasks and joints, and `InvalidValueError` for other shapes.
    #[pyo3(signature = (targets = None, *, weights = None, joint_origins = None))]
    fn velocity<'py>(
        &self,
        py: Python<'py>,
        targets: Option<&Bound<'py, PyAny>>,
        weights: Option<&Bound<'py, PyAny>>,
        joint_origins: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let problem = &self.compiled;
        let mut rates = ParameterVector::new(&problem.inner);
        for (task, value) in problem.targets_by_task(targets)? {
            let name = problem.inner.task_name(task).unwrap_or_default();
            let values = rates.target_mut(task);
            let what = format!("the target's rate of {name}");
            values.copy_from_slice(&arrays::vector_of(&value, &what, values.len())?);
        }
        if let Some(weights) = weights {
            let values = rates.weights_mut();
            values.copy_from_slice(&arrays::vector_of(weights, "weights", values.len())?);
        }
        let joint_origins = items(joint_origins, "joint_origins")?;
        if !joint_origins.is_empty() {
            rates = rates.with_joint_origins(self.model.joints().len());
        }
        for (joint, value) in joint_origins {
            let name = arrays::name(&joint, "a joint of joint_origins")?;
            let joint = self.model.joint(&name).or_raise()?;
            let rate = arrays::array(&value, &format!("the rate of {name}"))?;
            rates.joint_origins_mut()[joint.index()] = Vector3::from(rate);
        }
        let v = self.with(py, |derivative| {
            let mut v = vec![0.0; derivative.degrees_of_freedom()];
            derivative.velocity(&rates, &mut v).or_raise()?;
            Ok(v)
        })?;
        Ok(arrays::list(py, &v))
    }

    /// Gradient of a scalar with respect to all parameters, from its slope with respect to the solution, by one reverse
    /// product.
    ///
    /// `slope` is with respect to the velocity, shape (dof,); `by_q` with respect to the numbers of q, shape (nq,),
    /// including quaternions w, x, y, z. The result is a dict: "targets" by task, "weights" of shape (rows of
    /// `Solution.rows`,), and "joint_origins" by joint, shape (3,) each, per metre in the parent's axes.
    ///
    /// Raises `InvalidValueError` for other shapes, and unless exactly one of the two is given.
    #[pyo3(signature = (slope = None, *, by_q = None))]
    fn gradient<'py>(
        &self,
        py: Python<'py>,
        slope: Option<&Bound<'py, PyAny>>,
        by_q: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (slope, is_by_q) = match (slope, by_q) {
            (Some(slope), None) => (arrays::vector(slope, "slope")?.to_vec(), false),
            (None, Some(by_q)) => (
                arrays::vector_of(by_q, "by_q", self.q.len())?.to_vec(),
                true,
            ),
            _ => return Err(invalid("either slope or by_q must be given")),
        };
        let gradient = self.with(py, |derivative| {
            let slope = match is_by_q {
                true => derivative.slope_by_velocity(&self.q, &slope).or_raise()?,
                false => slope,
            };
            let mut gradient = derivative.parameters();
            derivative.gradient(&slope, &mut gradient).or_raise()?;
            Ok(gradient)
        })?;
        let by_task = PyDict::new(py);
        for task in 0..self.compiled.inner.tasks() {
            let slopes = gradient.target(task);
            if !slopes.is_empty() {
                by_task.set_item(self.key(py, task)?, arrays::list(py, slopes))?;
            }
        }
        let by_joint = PyDict::new(py);
        let origins = self.model.joints().iter().zip(gradient.joint_origins());
        for (joint, origin) in origins {
            by_joint.set_item(&joint.name, arrays::list(py, &origin.to_array()))?;
        }
        let all = PyDict::new(py);
        all.set_item("targets", by_task)?;
        all.set_item("weights", arrays::list(py, gradient.weights()))?;
        all.set_item("joint_origins", by_joint)?;
        Ok(all)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let targets = self.python_targets.as_ref().map(|targets| targets.bind(py));
        let arguments = (self.problem.bind(py), arrays::list(py, &self.q), targets);
        pickling::by_class::<Self>(py, arguments)
    }

    fn __repr__(&self) -> String {
        format!("SolutionDerivative({})", self.differentiability.name())
    }
}
