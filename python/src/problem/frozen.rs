//! Arguments of tasks: validated read-only copies.

use kinopt::spatial::Placement;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

use crate::arrays;
use crate::goal::{PoseBounds, pose_bounds};

/// A read-only copy of `length` numbers (any number of them for None); `what` names it in messages. Raises
/// `InvalidValueError`.
#[pyfunction]
#[pyo3(signature = (value, what, length = None))]
pub(crate) fn numbers<'py>(
    value: &Bound<'py, PyAny>,
    what: &str,
    length: Option<usize>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let numbers = match length {
        Some(length) => arrays::vector_of(value, what, length)?,
        None => arrays::vector(value, what)?,
    };
    let copy = arrays::list(value.py(), &numbers);
    arrays::freeze(&copy)?;
    Ok(copy)
}

/// A read-only copy of a placement, shape (4, 4); `what` names it in messages. Raises `InvalidValueError`.
#[pyfunction]
pub(crate) fn placement<'py>(
    value: &Bound<'py, PyAny>,
    what: &str,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    keep(value.py(), &crate::placement::placement(value, what)?)
}

/// A read-only copy of a placement that is a target under `goal` (a `PoseBounds`, "pose" or "position"; None: the full
/// pose), shape (4, 4); `what` names it in messages. Raises `InvalidValueError`.
#[pyfunction]
pub(crate) fn target<'py>(
    value: &Bound<'py, PyAny>,
    what: &str,
    goal: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let bounds = match goal {
        Some(goal) => pose_bounds(goal, "goal")?,
        None => kinopt::task::PoseBounds::pose(),
    };
    keep(value.py(), &crate::placement::target(value, what, &bounds)?)
}

fn keep<'py>(py: Python<'py>, placement: &Placement<f64>) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let copy = crate::placement::to_array(py, placement)?;
    arrays::freeze(&copy)?;
    Ok(copy)
}

/// Goal bounds of a `PoseBounds`, "pose" or "position". Raises `InvalidValueError` for other values, `UnknownNameError`
/// for other words.
#[pyfunction]
pub(crate) fn goal(value: &Bound<'_, PyAny>) -> PyResult<PoseBounds> {
    Ok(pose_bounds(value, "goal")?.into())
}

/// A read-only copy of axes in columns, shape (3, 3); `what` names it in messages. Raises `InvalidValueError`.
#[pyfunction]
pub(crate) fn rotation<'py>(
    value: &Bound<'py, PyAny>,
    what: &str,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let rows = crate::placement::rotation(value, what)?.transpose();
    let rows = [rows.x, rows.y, rows.z].map(kinopt::spatial::Vector3::to_array);
    let copy = arrays::list(value.py(), rows.as_flattened()).reshape([3, 3])?;
    arrays::freeze(&copy)?;
    Ok(copy)
}
