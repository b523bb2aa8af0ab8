//! Output streams: results on standard output, everything else on standard error.

use std::io::{ErrorKind, Write};
use std::path::Path;

use serde::Serialize;

use crate::failure::{Failure, Outcome};

/// Prints a result: one document on one line if `json`, otherwise text.
pub(crate) fn result<D: Serialize>(
    json: bool,
    document: impl FnOnce() -> D,
    text: impl FnOnce() -> String,
) -> Outcome<()> {
    let text = match json {
        true => serde_json::to_string(&document())? + "\n",
        false => text(),
    };
    let mut out = std::io::stdout().lock();
    let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    written.map_err(|error| match error.kind() {
        ErrorKind::BrokenPipe => Failure::ReaderGone,
        _ => failure!("standard output cannot be written: {error}"),
    })
}

/// Creates an output folder, if missing.
pub(crate) fn make_folder(path: &Path) -> Outcome<()> {
    std::fs::create_dir_all(path)
        .map_err(|error| failure!("{}: cannot be created: {error}", path.display()))
}

/// Writes a whole file.
pub(crate) fn write_file(path: &Path, contents: impl AsRef<[u8]>) -> Outcome<()> {
    Ok(kinopt::io::write_file(path, contents.as_ref())?)
}

/// Prints a message on standard error; a closed stream is ignored.
pub(crate) fn message(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "kinopt: {text}");
}
