//! Return values of `__reduce__`.

use pyo3::PyTypeInfo;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::OrRaise;

/// Rebuilds by the class itself, called with these arguments.
pub(crate) fn by_class<'py, T: PyTypeInfo>(
    py: Python<'py>,
    arguments: impl IntoPyObject<'py>,
) -> PyResult<Bound<'py, PyAny>> {
    Ok((py.get_type::<T>(), arguments)
        .into_pyobject(py)?
        .into_any())
}

/// Rebuilds by the class's `_rebuild`, called with these arguments.
pub(crate) fn by_rebuild<'py, T: PyTypeInfo>(
    py: Python<'py>,
    arguments: impl IntoPyObject<'py>,
) -> PyResult<Bound<'py, PyAny>> {
    by_method(py.get_type::<T>().as_any(), "_rebuild", arguments)
}

/// Rebuilds by a method of an object that pickles, called with these arguments.
pub(crate) fn by_method<'py>(
    owner: &Bound<'py, PyAny>,
    method: &str,
    arguments: impl IntoPyObject<'py>,
) -> PyResult<Bound<'py, PyAny>> {
    let rebuild = owner.getattr(method)?;
    Ok((rebuild, arguments).into_pyobject(owner.py())?.into_any())
}

/// Rebuilds by the class's `_rebuild`, called with JSON.
pub(crate) fn by_json<'py, T: PyTypeInfo>(
    py: Python<'py>,
    value: &impl Serialize,
) -> PyResult<Bound<'py, PyAny>> {
    by_rebuild::<T>(py, (serde_json::to_string(value).or_raise()?,))
}

/// Reads the JSON of `by_json`.
pub(crate) fn of_json<T: DeserializeOwned>(json: &str) -> PyResult<T> {
    serde_json::from_str(json).or_raise()
}

/// Rebuilds by the class itself, called with a tuple of arguments whose last ones are these keywords.
pub(crate) fn by_arguments<'py, T: PyTypeInfo>(
    py: Python<'py>,
    arguments: impl IntoPyObject<'py, Target = PyTuple, Output = Bound<'py, PyTuple>, Error = PyErr>,
    keywords: &[&str],
) -> PyResult<Bound<'py, PyAny>> {
    let arguments = arguments.into_pyobject(py)?;
    let (options, count) = (PyDict::new(py), arguments.len() - keywords.len());
    for (name, value) in keywords.iter().zip(arguments.iter().skip(count)) {
        options.set_item(name, value)?;
    }
    by_keywords::<T>(py, &arguments.get_slice(0, count), &options)
}

/// Copies of the given keywords, which the caller may change later.
pub(crate) fn kept<'py>(
    py: Python<'py>,
    keywords: &[(&str, Option<&Bound<'py, PyAny>>)],
) -> PyResult<Bound<'py, PyDict>> {
    let (options, copy) = (PyDict::new(py), py.import("copy")?);
    for (name, value) in keywords {
        if let Some(value) = value {
            options.set_item(name, copy.call_method1("deepcopy", (value,))?)?;
        }
    }
    Ok(options)
}

/// Rebuilds by the class itself, called with arguments and keywords.
pub(crate) fn by_keywords<'py, T: PyTypeInfo>(
    py: Python<'py>,
    arguments: &Bound<'py, PyTuple>,
    options: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyAny>> {
    let partial = py.import("functools")?.getattr("partial")?;
    let class = partial.call((py.get_type::<T>(),), Some(options))?;
    Ok((class, arguments).into_pyobject(py)?.into_any())
}
