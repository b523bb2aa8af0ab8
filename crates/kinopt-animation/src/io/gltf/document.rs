//! The JSON document of a file, and checks of its version and extensions.

use gltf_json::Root;
use serde::Deserialize;

use super::omissions::{Nodeless, parse_with_omissions};
use crate::io::{FileLocation, ReadError};
use kinopt_mesh::json::parse;

/// Prefixes of extensions that a file may require: they affect appearance only, or the reader supports them.
const SUPPORTED_EXTENSIONS: [&str; 7] = [
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "MSFT_texture_",
    "KHR_lights_",
    QUANTIZATION,
    "KHR_xmp",
];
/// The extension that the reader applies.
pub(super) const QUANTIZATION: &str = "KHR_mesh_quantization";

/// The part of a document that is read if parsing the whole fails.
#[derive(Deserialize)]
struct DocumentHeader {
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

/// Parses a document and checks that its version is 2 and that it requires no unsupported extension.
pub(super) fn document(json: &[u8], name: &str) -> Result<(Root, Nodeless), ReadError> {
    if let Ok(root) = Root::from_slice(json) {
        let asset = Asset {
            version: root.asset.version.clone(),
            min_version: root.asset.min_version.clone(),
        };
        check(&asset, &root.extensions_required, name)?;
        return Ok((root, Nodeless::new()));
    }
    // A document of another version may differ in structure, so its version is checked first.
    let object = json.trim_ascii_start().starts_with(b"{");
    let header: Result<DocumentHeader, _> = match object {
        true => parse(json, name),
        false => Err(ReadError::of_file(
            name,
            "it begins with no JSON object, as a .gltf does, nor with `glTF` and a chunk that does, as a .glb",
        )),
    };
    let header = header.map_err(|error| {
        let problem = format!("not a glTF file: {}", error.problem);
        ReadError::malformed(name, error.place, problem)
    })?;
    check(&header.asset, &header.required, name)?;
    parse_with_omissions(json, name)
}

/// Returns an error for other versions and for unsupported required extensions.
fn check(asset: &Asset, required: &[String], name: &str) -> Result<(), ReadError> {
    let needed = asset.min_version.as_deref().unwrap_or(&asset.version);
    let is_wrong_minor = asset.min_version.is_some() && needed != "2.0";
    if needed.split('.').next() != Some("2") || is_wrong_minor {
        let problem = format!("is glTF of version {needed}; version 2.0 is read");
        let location = FileLocation::Json("asset".into());
        return Err(ReadError::malformed(name, location, problem));
    }
    let is_supported = |required: &str| {
        SUPPORTED_EXTENSIONS
            .iter()
            .any(|known| required.starts_with(known))
    };
    for (index, required) in required.iter().enumerate() {
        if !is_supported(required) {
            let location = FileLocation::Json(format!("extensionsRequired[{index}]"));
            let known: Vec<String> = SUPPORTED_EXTENSIONS
                .iter()
                .map(|known| known_name(known))
                .collect();
            let problem = format!(
                "`{required}` is required and not supported; those that may be are {}",
                known.join(", ")
            );
            return Err(ReadError::malformed(name, location, problem));
        }
    }
    Ok(())
}

/// Readable name of a family of extensions.
fn known_name(prefix: &str) -> String {
    match prefix.ends_with('_') {
        true => format!("{prefix}…"),
        false => prefix.to_owned(),
    }
}
