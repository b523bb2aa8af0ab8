//! How far a long computation is.

use pyo3::prelude::*;
use pyo3::types::PyBool;

use crate::error::invalid;

/// Hears how much is done: nothing, a callable of the user's, or a bar.
pub(crate) struct Progress {
    report: Option<Py<PyAny>>,
    total: usize,
}

impl Progress {
    /// Of what the user gave: None, a callable of (done, total), or True for a bar.
    pub(crate) fn new(
        py: Python<'_>,
        given: Option<&Bound<'_, PyAny>>,
        total: usize,
    ) -> PyResult<Self> {
        let report = match given {
            None => None,
            Some(given) if given.cast::<PyBool>().is_ok() => match given.is_truthy()? {
                true => Some(py.import("kinopt.progress")?.call_method0("bar")?.unbind()),
                false => None,
            },
            Some(given) if given.is_callable() => Some(given.clone().unbind()),
            Some(given) => {
                return Err(invalid(format!(
                    "progress must be True or a function of (done, total), not {given}"
                )));
            }
        };
        Ok(Self { report, total })
    }

    /// Says that so many are done. What the callable raises ends the computation.
    pub(crate) fn done(&self, done: usize) -> PyResult<()> {
        match &self.report {
            Some(report) => Python::attach(|py| report.call1(py, (done, self.total)).map(drop)),
            None => Ok(()),
        }
    }
}
