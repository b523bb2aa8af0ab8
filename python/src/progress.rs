//! Progress reports of long computations.

use pyo3::prelude::*;
use pyo3::types::PyBool;

use crate::error::invalid;

/// Receiver of progress: none, a callable of the user, or a progress bar.
pub(crate) struct Progress {
    report: Option<Py<PyAny>>,
    total: usize,
}

impl Progress {
    /// Reads None, a callable of (done, total), or True for a progress bar.
    pub(crate) fn new(
        py: Python<'_>,
        progress: Option<&Bound<'_, PyAny>>,
        total: usize,
    ) -> PyResult<Self> {
        let report = match progress {
            None => None,
            Some(progress) if progress.cast::<PyBool>().is_ok() => match progress.is_truthy()? {
                true => Some(py.import("kinopt.progress")?.call_method0("bar")?.unbind()),
                false => None,
            },
            Some(progress) if progress.is_callable() => Some(progress.clone().unbind()),
            Some(progress) => {
                return Err(invalid(format!(
                    "progress must be True or a function of (done, total), not {progress}"
                )));
            }
        };
        Ok(Self { report, total })
    }

    /// Reports that `done` items are finished. An exception of the callable ends the computation.
    pub(crate) fn done(&self, done: usize) -> PyResult<()> {
        match &self.report {
            Some(report) => Python::attach(|py| report.call1(py, (done, self.total)).map(drop)),
            None => Ok(()),
        }
    }
}
