//! How far a long computation is.

use pyo3::prelude::*;
use pyo3::types::PyBool;

/// Hears how much is done: nothing, a callable of the user's, or a bar.
pub(crate) struct Progress<'py> {
    report: Option<Bound<'py, PyAny>>,
    total: usize,
}

impl<'py> Progress<'py> {
    /// Of what the user gave: None, a callable of (done, total), or True for a bar.
    pub(crate) fn new(
        py: Python<'py>,
        given: Option<&Bound<'py, PyAny>>,
        total: usize,
    ) -> PyResult<Self> {
        let report = match given {
            None => None,
            Some(given) if given.cast::<PyBool>().is_ok() => match given.is_truthy()? {
                true => Some(py.import("kinopt.progress")?.call_method0("bar")?),
                false => None,
            },
            Some(given) => Some(given.clone()),
        };
        Ok(Self { report, total })
    }

    /// Says that so many are done. What the callable raises ends the computation.
    pub(crate) fn done(&self, done: usize) -> PyResult<()> {
        if let Some(report) = &self.report {
            report.call1((done, self.total))?;
        }
        Ok(())
    }
}
