//! Methods that are implemented in Python.

use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Calls a function of a Python module with an object and keywords.
pub(crate) fn call<'py>(
    function: &str,
    module: &str,
    object: &Bound<'py, PyAny>,
    keywords: &[(&str, Option<&Bound<'py, PyAny>>)],
) -> PyResult<Bound<'py, PyAny>> {
    let py = object.py();
    let given = PyDict::new(py);
    for (name, value) in keywords {
        if let Some(value) = value {
            given.set_item(name, value)?;
        }
    }
    let function = py.import(module)?.getattr(function)?;
    function.call((object,), Some(&given))
}
