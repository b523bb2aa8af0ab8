//! Held parts of a skeleton: a parameter map and posture tasks.

use kinopt::ik;
use kinopt::model::check_configuration;
use kinopt::skeleton::{Holds, Skeleton};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::OrRaise;

/// A `kinopt.ParameterMap` of `model` for held parts: see `Holds::parameters`.
pub(crate) fn hold_parameters<'py>(
    py: Python<'py>,
    model: &Bound<'py, PyAny>,
    holds: &Holds,
    skeleton: &Skeleton,
    q: &[f64],
) -> PyResult<Bound<'py, PyAny>> {
    let (lock, narrow) = (PyDict::new(py), PyDict::new(py));
    let names = skeleton.model().joints();
    check_configuration(skeleton.model(), q).or_raise()?;
    for (joint, limits) in holds.ranges(skeleton, q) {
        let name = &names[joint.index()].name;
        match limits.is_locked() {
            true => lock.set_item(name, limits.lower)?,
            false => narrow.set_item(name, (limits.lower, limits.upper))?,
        }
    }
    let keywords = PyDict::new(py);
    keywords.set_item("lock", lock)?;
    keywords.set_item("narrow", narrow)?;
    let class = py.import("kinopt")?.getattr("ParameterMap")?;
    class.call((model,), Some(&keywords))
}

/// Posture tasks of `kinopt.tasks` for held parts: see `hold_postures` of the library.
pub(crate) fn hold_postures<'py>(
    py: Python<'py>,
    holds: &Holds,
    skeleton: &Skeleton,
    q: &[f64],
) -> PyResult<Vec<Bound<'py, PyAny>>> {
    let class = py.import("kinopt.tasks")?.getattr("Posture")?;
    let names = skeleton.model().joints();
    let tasks = ik::hold_postures(holds, skeleton, q).or_raise()?;
    let tasks = tasks.iter().map(|task| {
        let reference = PyDict::new(py);
        for (joint, value) in task.residual.values() {
            reference.set_item(&names[joint.index()].name, value)?;
        }
        let keywords = PyDict::new(py);
        keywords.set_item("name", task.name.as_deref())?;
        keywords.set_item("scale", task.factor)?;
        class.call((reference,), Some(&keywords))
    });
    tasks.collect()
}
