//! Settings: a JSON object with options by name.

use std::ffi::c_char;

use kinopt::model::UnknownName;
use serde_json::{Map, Value};

use crate::error::Failure;
use crate::pointer;

/// Reads settings; null for none. `kind` describes an option in messages, as in "option of an arm".
pub(crate) unsafe fn settings(
    text: *const c_char,
    kind: &'static str,
    known: &[&str],
) -> Result<Map<String, Value>, Failure> {
    // SAFETY: by the contract of the caller.
    let text = unsafe { pointer::optional_text(text, "settings") }?;
    let Some(text) = text.filter(|text| !text.is_empty()) else {
        return Ok(Map::new());
    };
    let Value::Object(settings) = serde_json::from_str(text)? else {
        return Err(Failure::invalid(format!(
            "settings are a JSON object such as {{\"{}\": …}}, not {text}",
            known.first().copied().unwrap_or_default()
        )));
    };
    check_names(&settings, kind, known)?;
    Ok(settings)
}

/// Checks the names of arguments; `kind` describes one in messages.
pub(crate) fn check_names(
    arguments: &Map<String, Value>,
    kind: &'static str,
    known: &[&str],
) -> Result<(), UnknownName> {
    match arguments
        .keys()
        .find(|name| !known.contains(&name.as_str()))
    {
        Some(name) => Err(UnknownName::new(kind, name, known.iter().copied())),
        None => Ok(()),
    }
}
