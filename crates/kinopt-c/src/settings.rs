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
    for name in settings.keys() {
        if !known.contains(&name.as_str()) {
            return Err(UnknownName::new(kind, name, known.iter().copied()).into());
        }
    }
    Ok(settings)
}
