//! JSON into any type, with the path of what is wrong.

use serde::de::DeserializeOwned;

use super::{Place, ReadError};

pub(super) fn parse<T: DeserializeOwned>(json: &[u8], name: &str) -> Result<T, ReadError> {
    let mut parser = serde_json::Deserializer::from_slice(json);
    let file = serde_path_to_error::deserialize(&mut parser);
    let file = file.map_err(|error| wrong(&error, name))?;
    parser
        .end()
        .map_err(|error| ReadError::malformed(name, Place::File, error.to_string()))?;
    Ok(file)
}

/// As [`parse`], of JSON that was read already.
#[cfg(feature = "gltf")]
pub(super) fn parse_value<T: DeserializeOwned>(
    json: serde_json::Value,
    name: &str,
) -> Result<T, ReadError> {
    serde_path_to_error::deserialize(json).map_err(|error| wrong(&error, name))
}

fn wrong(error: &serde_path_to_error::Error<serde_json::Error>, name: &str) -> ReadError {
    let place = match error.path().to_string() {
        root if root == "." => Place::File,
        path => Place::Json(path),
    };
    ReadError::malformed(name, place, error.inner().to_string())
}
