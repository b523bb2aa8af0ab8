//! JSON parsing with the path of the fault in errors.

use serde::de::DeserializeOwned;

use kinopt_kinematics::file::{FileLocation, ReadError};

#[doc(hidden)]
pub fn parse<T: DeserializeOwned>(json: &[u8], name: &str) -> Result<T, ReadError> {
    parse_by(|json| serde_json::from_slice(json), json, name)
}

/// As [`parse`], with a parser function of another crate, so that this crate does not instantiate it again.
#[doc(hidden)]
pub fn parse_by<T>(
    reader: impl FnOnce(&[u8]) -> serde_json::Result<T>,
    json: &[u8],
    name: &str,
) -> Result<T, ReadError> {
    reader(json).map_err(|error| {
        let lines = json.split_inclusive(|byte| *byte == b'\n');
        let line_start: usize = lines
            .take(error.line().saturating_sub(1))
            .map(<[u8]>::len)
            .sum();
        let end = (line_start + error.column()).min(json.len());
        // An error found after a value was read is reported at the comma behind it.
        let read = json[..end].trim_ascii_end();
        let location = match path(read.strip_suffix(b",").unwrap_or(read)) {
            root if root.is_empty() => FileLocation::File,
            path => FileLocation::Json(path),
        };
        ReadError::malformed(name, location, error.to_string())
    })
}

/// An open list or object, with the current index or key.
enum OpenValue {
    List(usize),
    Object(Option<String>),
}

/// Path of the value in or directly after which `beginning` ends. The errors of serde_json have line and column only.
fn path(beginning: &[u8]) -> String {
    let mut open: Vec<OpenValue> = Vec::new();
    // The next string is a key: after a brace, or after a comma in an object.
    let mut key_is_next = false;
    let mut offset = 0;
    while let Some(&byte) = beginning.get(offset) {
        offset += 1;
        match byte {
            b'[' => open.push(OpenValue::List(0)),
            b'{' => {
                open.push(OpenValue::Object(None));
                key_is_next = true;
            }
            b']' | b'}' => {
                open.pop();
                key_is_next = false;
            }
            b',' => match open.last_mut() {
                Some(OpenValue::List(index)) => *index += 1,
                Some(OpenValue::Object(_)) => key_is_next = true,
                None => {}
            },
            b'"' => {
                let length = string_length(&beginning[offset..]);
                if let (true, Some(OpenValue::Object(key))) = (key_is_next, open.last_mut()) {
                    let text = &beginning[offset..offset + length];
                    *key = Some(String::from_utf8_lossy(text).into_owned());
                    key_is_next = false;
                }
                offset += length + 1;
            }
            _ => {}
        }
    }
    open.iter().fold(String::new(), |path, value| match value {
        OpenValue::List(index) => format!("{path}[{index}]"),
        OpenValue::Object(Some(key)) if path.is_empty() => key.clone(),
        OpenValue::Object(Some(key)) => format!("{path}.{key}"),
        OpenValue::Object(None) => path,
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
