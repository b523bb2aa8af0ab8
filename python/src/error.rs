//! Conversion of the library's errors to exceptions with the library's messages.

use kinopt_bindings::{Classify, ErrorKind};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

/// Exception of `kinopt.errors` for a kind of error.
fn class_name(kind: ErrorKind) -> &'static str {
    match kind {
        ErrorKind::InvalidValue => "InvalidValueError",
        ErrorKind::UnknownName => "UnknownNameError",
        ErrorKind::InvalidFile => "InvalidFileError",
        ErrorKind::File => "FileError",
    }
}

/// Creates an exception of this kind.
pub(crate) fn raise(kind: ErrorKind, message: impl Into<String>) -> PyErr {
    static MODULE: PyOnceLock<Py<PyModule>> = PyOnceLock::new();
    let message = message.into();
    Python::attach(|py| {
        let module = MODULE.get_or_try_init(py, || py.import("kinopt.errors").map(Bound::unbind));
        let class = module.and_then(|module| module.bind(py).getattr(class_name(kind)));
        match class.and_then(|class| class.call1((message,))) {
            Ok(error) => PyErr::from_value(error),
            Err(error) => error,
        }
    })
}

/// Creates an exception for an invalid value.
pub(crate) fn invalid(message: impl Into<String>) -> PyErr {
    raise(ErrorKind::InvalidValue, message)
}

/// Conversion of the library's results to those of Python.
pub(crate) trait OrRaise<T> {
    /// Returns the value, or an exception with the library's message.
    fn or_raise(self) -> PyResult<T>;
}

impl<T, E: Classify> OrRaise<T> for Result<T, E> {
    fn or_raise(self) -> PyResult<T> {
        self.map_err(|error| raise(error.kind(), error.to_string()))
    }
}
