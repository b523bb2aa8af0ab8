//! Settings: a JSON object with options by name.

use std::ffi::c_char;
use std::fmt;

use kinopt::model::UnknownName;
use kinopt_bindings::ErrorKind;
use kinopt_bindings::json::JsonError;
use serde::Deserialize;
use serde::de::{Error, MapAccess, Visitor};
use serde_json::{Map, Value};

use crate::error::{Failure, of_json};
use crate::pointer;

/// Options of the library that are arguments of functions here, with a sentence that names them.
type Elsewhere = [(&'static str, &'static str)];

/// Reads settings; null for none. `kind` describes an option in messages, as in "option of an arm".
pub(crate) unsafe fn settings(
    text: *const c_char,
    kind: &'static str,
    known: &[&str],
    elsewhere: &Elsewhere,
) -> Result<Map<String, Value>, Failure> {
    // SAFETY: by the contract of the caller.
    let text = unsafe { pointer::optional_text(text, "settings") }?;
    let Some(text) = text.filter(|text| !text.is_empty()) else {
        return Ok(Map::new());
    };
    let Settings(settings) = serde_json::from_str(text).map_err(|error| {
        let example = known.first().copied().unwrap_or_default();
        Failure::invalid(format!(
            "`settings` is no JSON object such as {{\"{example}\": …}}: {error}"
        ))
    })?;
    let given = |name: &str| settings.contains_key(name);
    if let Some((name, hint)) = elsewhere.iter().find(|(name, _)| given(name)) {
        let message = format!("`{name}` is no setting: {hint}");
        return Err(of_json(JsonError {
            kind: ErrorKind::UnknownName,
            message,
        }));
    }
    check_names(&settings, kind, known).map_err(of_json)?;
    Ok(settings)
}

/// Checks the names of arguments; `kind` describes one in messages. The message lists all names.
pub(crate) fn check_names(
    arguments: &Map<String, Value>,
    kind: &'static str,
    known: &[&str],
) -> Result<(), JsonError> {
    let is_unknown = |name: &&String| !known.contains(&name.as_str());
    let Some(name) = arguments.keys().find(is_unknown) else {
        return Ok(());
    };
    let error = UnknownName::new(kind, name, known.iter().copied());
    let similar = match error.suggestions().first() {
        Some(name) => format!("did you mean `{name}`? "),
        None => String::new(),
    };
    let message = format!(
        "no {kind} named `{name}`; {similar}valid names: {}",
        known.join(", ")
    );
    Err(JsonError {
        kind: ErrorKind::UnknownName,
        message,
    })
}

/// Members of an object, each given once.
struct Settings(Map<String, Value>);

impl<'de> Deserialize<'de> for Settings {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_map(SettingMembers)
    }
}

struct SettingMembers;

impl<'de> Visitor<'de> for SettingMembers {
    type Value = Settings;

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut from: A) -> Result<Settings, A::Error> {
        let mut members = Map::new();
        while let Some(name) = from.next_key::<String>()? {
            let value = from.next_value()?;
            if members.contains_key(&name) {
                return Err(A::Error::custom(format!("`{name}` is given twice")));
            }
            members.insert(name, value);
        }
        Ok(Settings(members))
    }
}
