//! Methods of Python: an instance of a class in `kinopt.methods`, or a name.

use kinopt::model::UnknownName;
use kinopt_bindings::method::{METHODS, SolverMethod};
use kinopt_bindings::option::solver::SolverOptions;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{OrRaise, invalid};
use crate::object::{Fields, Options};

/// Reads a method with its limits.
pub(super) fn method(value: &Bound<'_, PyAny>, limits: &SolverOptions) -> PyResult<SolverMethod> {
    if let Ok(name) = value.extract::<String>() {
        if !METHODS.contains(&name.as_str()) {
            Err(UnknownName::new("method", &name, METHODS)).or_raise()?;
        }
        let settings = PyDict::new(value.py());
        let method = SolverMethod::of(&name, &Options(&settings), limits)?;
        return method.ok_or_else(|| invalid(format!("{name} is no method")));
    }
    let kind = value.getattr_opt("_kind")?;
    let kind = kind.map(|kind| kind.extract::<String>()).transpose()?;
    let method = kind.map(|kind| SolverMethod::of(&kind, &Fields(value), limits));
    match method.transpose()?.flatten() {
        Some(method) => Ok(method),
        None => Err(invalid(format!(
            "method must be one of kinopt.methods or its name, not {}",
            value.repr()?
        ))),
    }
}
