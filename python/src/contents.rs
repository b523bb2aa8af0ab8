//! Contents of files: texts, bytes, and files opened by a function of the caller.

use kinopt::io::{FileLocation, ReadError};
use kinopt_bindings::Classify;
use pyo3::exceptions::{PyFileNotFoundError, PyKeyError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::error::{OrRaise, invalid};

/// Returns the bytes of a text, or bytes unchanged.
pub(crate) fn text_or_bytes(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<u8>> {
    if let Ok(text) = value.extract::<String>() {
        return Ok(text.into_bytes());
    }
    let bytes = value.extract::<Vec<u8>>();
    bytes.map_err(|_| invalid(format!("{what} must be a text or bytes")))
}

/// Parses bytes. `open` reads further files; an exception that it raises has priority over the parse error.
pub(crate) fn parsed<T, E: Classify>(
    open: Option<&Bound<'_, PyAny>>,
    parse: impl FnOnce(&mut dyn FnMut(&str) -> Result<Vec<u8>, ReadError>) -> Result<T, E>,
) -> PyResult<T> {
    let mut raised = None;
    let parsed = parse(&mut |file| opened(open, file, &mut raised));
    match raised {
        Some(error) => Err(error),
        None => parsed.or_raise(),
    }
}

/// Reads a file with `open` and stores an exception in `raised`.
fn opened(
    open: Option<&Bound<'_, PyAny>>,
    file: &str,
    raised: &mut Option<PyErr>,
) -> Result<Vec<u8>, ReadError> {
    let fail = |kind, text: String| ReadError {
        file: file.to_owned(),
        place: FileLocation::File,
        problem: std::io::Error::new(kind, text).into(),
    };
    let missing = |text: &str| fail(std::io::ErrorKind::NotFound, text.to_owned());
    let open = open.ok_or_else(|| missing("no `open` was given"))?;
    let bytes = open
        .call1((file,))
        .and_then(|bytes| match bytes.cast::<PyBytes>() {
            Ok(bytes) => Ok(bytes.as_bytes().to_vec()),
            Err(_) => bytes.extract::<Vec<u8>>(),
        });
    bytes.map_err(|error| {
        let py = open.py();
        if error.is_instance_of::<PyFileNotFoundError>(py) || error.is_instance_of::<PyKeyError>(py)
        {
            return missing("not found");
        }
        let text = error.to_string();
        *raised = Some(error);
        fail(std::io::ErrorKind::Other, text)
    })
}
