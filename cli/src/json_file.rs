//! JSON out of files, with a reason in one line where there is none.

use std::path::Path;

use serde_json::Value;

use crate::failure::Outcome;

/// The longest file that is read, in bytes: a million targets and starts with all their digits.
const LENGTH_LIMIT: u64 = 1 << 28;

/// Reads a whole file as one JSON value.
pub(crate) fn read(path: &Path) -> Outcome<Value> {
    let file = path.display();
    let unreadable = |error: std::io::Error| failure!("{file}: cannot be read: {error}");
    let metadata = std::fs::metadata(path).map_err(unreadable)?;
    if !metadata.is_file() || metadata.len() > LENGTH_LIMIT {
        return Err(failure!(
            "{file}: is not a regular file of at most {LENGTH_LIMIT} bytes"
        ));
    }
    let bytes = std::fs::read(path).map_err(unreadable)?;
    if bytes.trim_ascii().is_empty() {
        return Err(failure!("{file}: is empty"));
    }
    serde_json::from_slice(&bytes).map_err(|error| failure!("{file}: is not JSON: {error}"))
}
