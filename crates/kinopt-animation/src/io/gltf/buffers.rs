//! Bytes of a document's buffers: binary chunk, data URIs and external files.

use std::borrow::Cow;

use base64::Engine;
use base64::alphabet;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use gltf_json::Root;

use super::compression::CompressedMembers;
use crate::io::{FileLocation, ReadError};

/// Some writers omit the padding.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// The bytes of every buffer, at least as long as announced. `open` returns the contents of an external file. Fallback
/// buffers of `compressed` views are empty.
pub(super) fn load<'a>(
    root: &Root,
    binary: Option<&'a [u8]>,
    compressed: Option<&CompressedMembers>,
    name: &str,
    mut open: impl FnMut(&str) -> Result<Vec<u8>, ReadError>,
) -> Result<Vec<Cow<'a, [u8]>>, ReadError> {
    let buffers = root.buffers.iter().enumerate().map(|(index, buffer)| {
        let location = |key: &str| FileLocation::Json(format!("buffers[{index}].{key}"));
        let malformed = |problem: String| ReadError::malformed(name, location("uri"), problem);
        if compressed.is_some_and(|compressed| compressed.is_fallback(index)) {
            return Ok(Cow::Borrowed(&[][..]));
        }
        let bytes: Cow<'a, [u8]> = match (&buffer.uri, binary) {
            (None, Some(binary)) if index == 0 => binary.into(),
            (None, _) => {
                let problem = "the buffer has neither a URI nor a binary chunk";
                return Err(malformed(problem.into()));
            }
            (Some(uri), _) => match data(uri) {
                Some(data) => data.map_err(malformed)?.into(),
                None => {
                    let opened = open(&path(uri).map_err(malformed)?);
                    let referred = |error| ReadError::referred(name, location("uri"), error);
                    opened.map_err(referred)?.into()
                }
            },
        };
        let announced = buffer.byte_length.0;
        if announced > bytes.len() as u64 {
            let (what, location) = ("the buffer's bytes".to_owned(), location("byteLength"));
            let (needed, available) = (u128::from(announced), bytes.len());
            return Err(ReadError::truncated(
                name, location, what, needed, available,
            ));
        }
        Ok(bytes)
    });
    buffers.collect()
}

const DATA_PREFIX: &str = "data:";

/// Reports whether a URI contains its data.
pub(super) fn is_data(uri: &str) -> bool {
    uri.starts_with(DATA_PREFIX)
}

/// The decoded data of a data URI; `None` for other URIs.
fn data(uri: &str) -> Option<Result<Vec<u8>, String>> {
    let (heading, data) = match uri.strip_prefix(DATA_PREFIX)?.split_once(',') {
        Some(parts) => parts,
        None => return Some(Err("the data URI has no comma before its data".into())),
    };
    if !heading.ends_with(";base64") {
        return Some(Err("the data URI is not in base64".into()));
    }
    let decoded = BASE64.decode(data);
    Some(decoded.map_err(|error| format!("the data URI is not in base64: {error}")))
}

/// Reports whether a URI begins with a scheme or a drive letter: `https:`, `file:`, `C:`.
fn has_scheme(uri: &str) -> bool {
    let Some((scheme, _)) = uri.split_once(':') else {
        return false;
    };
    let allowed = |c: char| c.is_ascii_alphanumeric() || matches!(c, '+' | '-' | '.');
    scheme.starts_with(|c: char| c.is_ascii_alphabetic()) && scheme.chars().all(allowed)
}

/// A relative URI as a file path, with `%20` and the like decoded.
pub(super) fn path(uri: &str) -> Result<String, String> {
    if has_scheme(uri) {
        return Err(format!(
            "`{uri}` is not a relative URI; only files next to this file are read"
        ));
    }
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, after @ ..] = rest {
        let code = after.get(..2).filter(|_| *first == b'%');
        let code = code.and_then(|code| std::str::from_utf8(code).ok());
        match code.and_then(|code| u8::from_str_radix(code, 16).ok()) {
            Some(byte) => {
                bytes.push(byte);
                rest = after.get(2..).unwrap_or(&[]);
            }
            None => {
                bytes.push(*first);
                rest = after;
            }
        }
    }
    String::from_utf8(bytes).map_err(|_| format!("`{uri}` is not Unicode"))
}
