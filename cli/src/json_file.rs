//! JSON out of files, with a reason in one line where there is none.

use std::path::Path;

use serde_json::Value;

use crate::failure::{Failure, Outcome};

/// The longest file that is read, in bytes: a million targets and starts with all their digits.
const LENGTH_LIMIT: u64 = 1 << 28;

/// Reads a whole file as one JSON value.
pub(crate) fn read(path: &Path) -> Outcome<Value> {
    let fail = |problem: String| Failure::new(format!("{}: {problem}", path.display()));
    let unreadable = |error: std::io::Error| fail(format!("cannot be read: {error}"));
    let metadata = std::fs::metadata(path).map_err(unreadable)?;
    if !metadata.is_file() || metadata.len() > LENGTH_LIMIT {
        return Err(fail(format!(
            "is not a regular file of at most {LENGTH_LIMIT} bytes"
        )));
    }
    let bytes = std::fs::read(path).map_err(unreadable)?;
    if bytes.trim_ascii().is_empty() {
        return Err(fail("is empty".to_owned()));
    }
    serde_json::from_slice(&bytes).map_err(|error| fail(format!("is not JSON: {error}")))
}
