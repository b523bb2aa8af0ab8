//! JSON parsing with the path of the fault in errors.

use serde::de::DeserializeOwned;

use super::{Place, ReadError};

pub(crate) fn parse<T: DeserializeOwned>(json: &[u8], name: &str) -> Result<T, ReadError> {
    parse_by(|json| serde_json::from_slice(json), json, name)
}

/// As [`parse`], with a parser function of another crate, so that this crate does not instantiate it again.
pub(super) fn parse_by<T>(
    reader: impl FnOnce(&[u8]) -> serde_json::Result<T>,
    json: &[u8],
    name: &str,
) -> Result<T, ReadError> {
    reader(json).map_err(|error| {
        let lines = json.split_inclusive(|byte| *byte == b'\n');
        let before: usize = lines
            .take(error.line().saturating_sub(1))
            .map(<[u8]>::len)
            .sum();
        let end = (before + error.column()).min(json.len());
        // An error found after a value was read is reported at the comma behind it.
        let read = json[..end].trim_ascii_end();
        let place = match path(read.strip_suffix(b",").unwrap_or(read)) {
            root if root.is_empty() => Place::File,
            path => Place::Json(path),
        };
        ReadError::malformed(name, place, error.to_string())
    })
}

/// An open list or object, with the current index or key.
enum Open {
    List(usize),
    Object(Option<String>),
}

/// Path of the value in or directly after which `beginning` ends. The errors of serde_json have line and column only.
fn path(beginning: &[u8]) -> String {
    let mut open: Vec<Open> = Vec::new();
    // The next string is a key: after a brace, or after a comma in an object.
    let mut key_is_next = false;
    let mut at = 0;
    while let Some(&byte) = beginning.get(at) {
        at += 1;
        match byte {
            b'[' => open.push(Open::List(0)),
            b'{' => {
                open.push(Open::Object(None));
                key_is_next = true;
            }
            b']' | b'}' => {
                open.pop();
                key_is_next = false;
            }
            b',' => match open.last_mut() {
                Some(Open::List(index)) => *index += 1,
                Some(Open::Object(_)) => key_is_next = true,
                None => {}
            },
            b'"' => {
                let length = string_length(&beginning[at..]);
                if let (true, Some(Open::Object(key))) = (key_is_next, open.last_mut()) {
                    let text = &beginning[at..at + length];
                    *key = Some(String::from_utf8_lossy(text).into_owned());
                    key_is_next = false;
                }
                at += length + 1;
            }
            _ => {}
        }
    }
    open.iter().fold(String::new(), |path, place| match place {
        Open::List(index) => format!("{path}[{index}]"),
        Open::Object(Some(key)) if path.is_empty() => key.clone(),
        Open::Object(Some(key)) => format!("{path}.{key}"),
        Open::Object(None) => path,
    })
}

/// Length of a string up to its closing quotation mark, or to the end of the text.
fn string_length(text: &[u8]) -> usize {
    let mut escaped = false;
    let end = text.iter().position(|byte| {
        let closes = *byte == b'"' && !escaped;
        escaped = *byte == b'\\' && !escaped;
        closes
    });
    end.unwrap_or(text.len())
}
