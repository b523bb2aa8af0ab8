//! Configurations by joint name.

use numpy::PyUntypedArray;
use pyo3::prelude::*;
use pyo3::types::PyMapping;

use crate::arrays::list;
use crate::object::Object;

/// Returns a configuration of a dict by joint name, converted by `read`, as an array; other values as they are.
pub(crate) fn by_position<'py>(
    q: &Bound<'py, PyAny>,
    read: impl FnOnce(&Object) -> PyResult<Vec<f64>>,
) -> PyResult<Bound<'py, PyAny>> {
    let is_named = q.cast::<PyUntypedArray>().is_err() && q.cast::<PyMapping>().is_ok();
    match is_named {
        true => Ok(list(q.py(), &read(&Object::of(q))?).into_any()),
        false => Ok(q.clone()),
    }
}
