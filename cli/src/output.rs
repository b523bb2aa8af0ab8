//! What is printed, and where: results on standard output, everything else on standard error.

use std::io::{ErrorKind, Write};

use serde::Serialize;

use crate::failure::{Failure, Outcome};

/// Prints a result as one JSON document on one line.
pub(crate) fn json(document: &impl Serialize) -> Outcome<()> {
    let mut text = serde_json::to_string(document)?;
    text.push('\n');
    result(&text)
}

/// Prints a result for people.
pub(crate) fn result(text: &str) -> Outcome<()> {
    let mut out = std::io::stdout().lock();
    let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    written.map_err(|error| match error.kind() {
        ErrorKind::BrokenPipe => Failure::ReaderGone,
        _ => Failure::new(format!("standard output cannot be written: {error}")),
    })
}

/// Tells people something on standard error; a closed one leaves nobody to tell.
pub(crate) fn message(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "kinopt: {text}");
}
