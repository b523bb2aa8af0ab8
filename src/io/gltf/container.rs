//! The container, GLB or JSON text, and the document in it.

use ::gltf::json::Root;
use serde::Deserialize;

use super::omissions::{Nodeless, parse_with_omissions};
use crate::io::json::parse;
use crate::io::{Place, ReadError};

/// What a GLB file starts with.
const MAGIC: &[u8; 4] = b"glTF";

/// Extensions that change looks only, or that reading copes with anyway: a file may require them.
const HARMLESS: [&str; 7] = [
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "MSFT_texture_",
    "KHR_lights_",
    QUANTIZATION,
    "KHR_xmp",
];
/// The extension that reading applies.
pub(super) const QUANTIZATION: &str = "KHR_mesh_quantization";

/// The JSON and the binary chunk of a file.
pub(super) struct Chunks<'a> {
    pub(super) json: &'a [u8],
    pub(super) binary: Option<&'a [u8]>,
}

/// What is looked at before the rest is parsed.
#[derive(Deserialize)]
struct Heading {
    asset: Asset,
    #[serde(default, rename = "extensionsRequired")]
    required: Vec<String>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Asset {
    version: String,
    min_version: Option<String>,
}

/// Tells GLB from text. Not by [`gltf::Glb::from_slice`], which subtracts with overflow where the
/// announced length is below that of the header, and refuses chunks that readers must skip.
pub(super) fn split<'a>(bytes: &'a [u8], name: &str) -> Result<Chunks<'a>, ReadError> {
    if !bytes.starts_with(MAGIC) {
        return Ok(Chunks {
            json: bytes,
            binary: None,
        });
    }
    let fail = |at: usize, problem: String| ReadError::malformed(name, Place::Byte(at), problem);
    let word = |at: usize| -> Result<u32, ReadError> {
        let word = bytes
            .get(at..at + 4)
            .and_then(|w| <[u8; 4]>::try_from(w).ok());
        word.map(u32::from_le_bytes)
            .ok_or_else(|| fail(at, "the header is cut off".into()))
    };
    let version = word(4)?;
    if version != 2 {
        let problem = format!("is GLB of version {version}; version 2 is read");
        return Err(fail(4, problem));
    }
    let announced = word(8)? as usize;
    let Some(file) = bytes.get(..announced) else {
        let what = "the contents of the GLB file".to_owned();
        let left = bytes.len();
        return Err(ReadError::truncated(
            name,
            Place::Byte(8),
            what,
            announced as u128,
            left,
        ));
    };
    let (mut json, mut binary, mut at) = (None, None, 12);
    // A tail too short for a header of a chunk is padding of a careless writer.
    while at + 8 <= file.len() {
        let (length, kind) = (word(at)? as usize, word(at + 4)?);
        let (start, left) = (at + 8, file.len() - at - 8);
        let Some(chunk) = file.get(start..start.saturating_add(length)) else {
            let (what, length) = ("a chunk".to_owned(), length as u128);
            return Err(ReadError::truncated(
                name,
                Place::Byte(at),
                what,
                length,
                left,
            ));
        };
        match &kind.to_le_bytes() {
            b"JSON" if json.is_none() => json = Some(chunk),
            b"BIN\0" if binary.is_none() => binary = Some(chunk),
            _ => {}
        }
        at = start + length;
    }
    let json = json.ok_or_else(|| fail(12, "there is no JSON chunk".into()))?;
    Ok(Chunks { json, binary })
}

/// The document, once its version is known to be 2 and it requires nothing that is not supported.
pub(super) fn document(json: &[u8], name: &str) -> Result<(Root, Nodeless), ReadError> {
    let heading: Heading = parse(json, name)?;
    let asset = heading.asset;
    let needed = asset.min_version.as_deref().unwrap_or(&asset.version);
    let wrong_minor = asset.min_version.is_some() && needed != "2.0";
    if needed.split('.').next() != Some("2") || wrong_minor {
        let problem = format!("is glTF of version {needed}; version 2.0 is read");
        return Err(ReadError::malformed(
            name,
            Place::Json("asset".into()),
            problem,
        ));
    }
    let harmless = |required: &str| HARMLESS.iter().any(|known| required.starts_with(known));
    for (index, required) in heading.required.iter().enumerate() {
        if !harmless(required) {
            let place = Place::Json(format!("extensionsRequired[{index}]"));
            let known: Vec<String> = HARMLESS.iter().map(|known| known_name(known)).collect();
            let problem = format!(
                "`{required}` is required and not supported; those that may be are {}",
                known.join(", ")
            );
            return Err(ReadError::malformed(name, place, problem));
        }
    }
    parse_with_omissions(json, name)
}

/// As people write a family of extensions.
fn known_name(prefix: &str) -> String {
    match prefix.ends_with('_') {
        true => format!("{prefix}…"),
        false => prefix.to_owned(),
    }
}
