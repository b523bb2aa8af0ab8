//! Values in their text form, of an option or of a string in a file.

use std::str::FromStr;

use serde::de::{Deserialize, Deserializer, Error};

/// Reads a value from a string.
pub(super) fn text<'de, D, T>(deserializer: D) -> Result<Option<T>, D::Error>
where
    D: Deserializer<'de>,
    T: FromStr<Err = String>,
{
    let text = String::deserialize(deserializer)?;
    text.parse().map(Some).map_err(Error::custom)
}

/// Reads values from a list of strings.
pub(super) fn texts<'de, D, T>(deserializer: D) -> Result<Vec<T>, D::Error>
where
    D: Deserializer<'de>,
    T: FromStr<Err = String>,
{
    let texts = Vec::<String>::deserialize(deserializer)?;
    let parsed = texts.iter().map(|text| text.parse());
    parsed.collect::<Result<_, _>>().map_err(Error::custom)
}

/// Named value of an option: its name, the text before the last `=`, and the text after it.
///
/// # Errors
/// An empty name, or no `=`; the message has the expected `shape`.
pub(super) fn named<'t>(text: &'t str, shape: &str) -> Result<(String, &'t str), String> {
    match text.rsplit_once('=') {
        Some((name, value)) if !name.trim().is_empty() => {
            Ok((name.trim().to_owned(), value.trim()))
        }
        _ => Err(format!("expected {shape}")),
    }
}
