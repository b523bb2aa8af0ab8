//! JSON files, with one-line errors.

use std::path::Path;

use serde_json::Value;

use crate::failure::Outcome;
use crate::file_access;

/// Reads a whole file as one JSON value.
pub(crate) fn read(path: &Path) -> Outcome<Value> {
    let file = path.display();
    let bytes = file_access::allowed().read(path)?;
    if bytes.trim_ascii().is_empty() {
        return Err(failure!("{file}: is empty"));
    }
    serde_json::from_slice(&bytes).map_err(|error| failure!("{file}: is not JSON: {error}"))
}
