//! Free, locked and coupled joints.

use std::sync::Arc;

use kinopt::model::{JointId, Limits, ParameterMapBuilder};
use kinopt_bindings::parameters;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arrays::{self, items};
use crate::error::{OrRaise, invalid};
use crate::has_model::model_of;
use crate::object::Object;
use crate::pickling;
use crate::robot::Robot;

/// The map from solver variables x to configurations q: free, locked, coupled and narrowed joints.
///
/// A robot's mimic joints follow its file. Arguments are by joint name. `lock={"finger": 0.04}` locks joints at values
/// (radians or metres; of a ball joint a quaternion w, x, y, z). `couple={"left": ("right", ratio, offset)}` makes a
/// mimic joint (ratio * source + offset). `narrow={"elbow": (lower, upper)}` intersects a joint's limits with these.
/// `only=["a", "b"]` frees only these joints. The other free joints are then locked at their values in `at` (shape
/// (nq,); default the neutral configuration), clamped into their limits.
///
/// Raises `UnknownNameError` for unknown joints, and `InvalidValueError` for a joint that is fixed, locked outside its
/// limits, coupled to itself, or has an empty range.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct ParameterMap {
    pub(crate) inner: kinopt::model::ParameterMap,
    model: Arc<kinopt::Model>,
    /// Robot or model of the map.
    python_model: Py<PyAny>,
    options: Py<PyDict>,
}

#[pymethods]
impl ParameterMap {
    #[new]
    #[pyo3(signature = (model, *, lock = None, only = None, at = None, narrow = None, couple = None))]
    fn new(
        model: &Bound<'_, PyAny>,
        lock: Option<&Bound<'_, PyAny>>,
        only: Option<Vec<String>>,
        at: Option<&Bound<'_, PyAny>>,
        narrow: Option<&Bound<'_, PyAny>>,
        couple: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let py = model.py();
        let inner_model = model_of(model)?;
        let joint = |name: &Bound<'_, PyAny>| -> PyResult<JointId> {
            let name = arrays::name(name, "a joint of a parameter map")?;
            inner_model.joint(&name).or_raise()
        };
        let mut builder = parameters_of(model, &inner_model);
        let mut locked = Vec::new();
        for (name, value) in items(lock, "lock")? {
            let name = arrays::name(&name, "a joint of a parameter map")?;
            locked.push((name, Object::of(&value)));
        }
        let what = |name: &str| format!("the locked value of {name}");
        builder = parameters::lock(builder, &inner_model, locked, what)?;
        for (name, follows) in items(couple, "couple")? {
            let (master, ratio, offset): (String, f64, f64) = follows.extract().map_err(|_| {
                invalid("couple must be a dict of (name of the source joint, ratio, offset)")
            })?;
            let master = inner_model.joint(&master).or_raise()?;
            builder = builder.with_coupled(joint(&name)?, master, ratio, offset);
        }
        for (name, limits) in items(narrow, "narrow")? {
            builder = builder.with_narrowed(joint(&name)?, self::limits(&limits, "narrow")?);
        }
        let at_numbers = at.map(|at| Ok::<_, PyErr>(arrays::vector(at, "at")?.to_vec()));
        let at_numbers = ("at", at_numbers.transpose()?);
        builder = parameters::only::<Object>(builder, &inner_model, only.as_deref(), at_numbers)?;
        let inner = builder.build().or_raise()?;
        let keywords = [
            ("lock", lock),
            ("couple", couple),
            ("narrow", narrow),
            ("at", at),
        ];
        let options = pickling::kept(py, &keywords)?;
        if let Some(only) = only {
            options.set_item("only", only)?;
        }
        Ok(Self {
            inner,
            model: inner_model,
            python_model: model.clone().unbind(),
            options: options.unbind(),
        })
    }

    /// Number of solver variables.
    #[getter]
    fn variables(&self) -> usize {
        self.inner.variables()
    }

    /// Name of the joint that each variable moves directly.
    #[getter]
    fn variable_names(&self) -> Vec<&str> {
        let moving = self.model.moving_joints();
        let leaders = self.inner.leaders().iter();
        leaders
            .map(|&leader| self.model.joints()[moving[leader].index()].name.as_str())
            .collect()
    }

    /// Lower bounds of the variables, shape (variables,), including those from mimic joints.
    #[getter]
    fn lower<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::list(py, self.inner.lower())
    }

    /// Upper bounds of the variables, shape (variables,), including those from mimic joints.
    #[getter]
    fn upper<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::list(py, self.inner.upper())
    }

    /// The configuration, shape (nq,), of variables x, shape (variables,): finite numbers.
    ///
    /// Raises `InvalidValueError` for another length and for numbers that are not finite.
    fn expand<'py>(
        &self,
        py: Python<'py>,
        x: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let x = arrays::vector(x, "x")?;
        let mut q = vec![0.0; self.inner.sources().len()];
        self.inner.expand_within_limits(&x, &mut q).or_raise()?;
        Ok(arrays::list(py, &q))
    }

    /// The variables, shape (variables,), of a configuration, shape (nq,), clamped into their bounds. Values of locked
    /// and mimic joints are ignored.
    ///
    /// Raises `InvalidValueError` for another length and for numbers that are not finite.
    fn reduce<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let q = arrays::vector(q, "q")?;
        let mut x = vec![0.0; self.inner.variables()];
        self.inner.reduce(&q, &mut x).or_raise()?;
        Ok(arrays::list(py, &x))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let arguments = PyTuple::new(py, [&self.python_model])?;
        pickling::by_keywords::<Self>(py, &arguments, self.options.bind(py))
    }

    fn __repr__(&self) -> String {
        let (variables, dof) = (self.inner.variables(), self.inner.sources().len());
        format!("ParameterMap({variables} variables of {dof} degrees of freedom)")
    }
}

/// Starts a map with all joints free, except a robot's mimic joints.
pub(crate) fn parameters_of<'a>(
    python_model: &'a Bound<'_, PyAny>,
    model: &'a kinopt::Model,
) -> ParameterMapBuilder<'a> {
    match python_model.cast::<Robot>() {
        Ok(robot) => robot.get().inner.parameters(),
        Err(_) => kinopt::model::ParameterMap::builder(model),
    }
}

/// Reads a pair (lower, upper).
pub(crate) fn limits(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Limits> {
    let (lower, upper): (f64, f64) = value
        .extract()
        .map_err(|_| invalid(format!("{what} must be a dict of pairs (lower, upper)")))?;
    Ok(Limits::new(lower, upper))
}
