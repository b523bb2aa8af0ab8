//! The JSON document of a file, and checks of its version and extensions.

use gltf_json::Root;
use serde::Deserialize;

use super::omissions::{Nodeless, parse_with_omissions};
use crate::io::{FileLocation, ReadError};
use kinopt_mesh::json::parse;

/// Meshes with attributes of small integers.
const QUANTIZATION: &str = "KHR_mesh_quantization";
/// Draco compression of primitives.
pub(super) const DRACO: &str = "KHR_draco_mesh_compression";
/// meshopt compression of buffer views. Both extensions have the same members.
pub(super) const MESHOPT: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Returns `true` for extensions that the reader applies.
pub(super) fn is_applied(extension: &str) -> bool {
    let is_draco = extension == DRACO && cfg!(feature = "draco");
    extension == QUANTIZATION || is_draco || MESHOPT.contains(&extension)
}

/// Returns `true` for other compressions. Without their decoder, the bytes of a file cannot be read. All other unknown
/// extensions add something to nodes, skins and clips that are readable without them.
fn is_unknown_compression(extension: &str) -> bool {
    let known = [QUANTIZATION, DRACO, MESHOPT[0], MESHOPT[1]];
    extension.contains("compression") && !known.contains(&extension)
}

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

/// Parses a document and checks that its version is 2 and that it requires no unknown compression.
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

/// Returns an error for other versions and for required compressions that are not decoded.
fn check(asset: &Asset, required: &[String], name: &str) -> Result<(), ReadError> {
    let needed = asset.min_version.as_deref().unwrap_or(&asset.version);
    let is_wrong_minor = asset.min_version.is_some() && needed != "2.0";
    if needed.split('.').next() != Some("2") || is_wrong_minor {
        let problem = format!("is glTF of version {needed}; version 2.0 is read");
        let location = FileLocation::Json("asset".into());
        return Err(ReadError::malformed(name, location, problem));
    }
    for (index, required) in required.iter().enumerate() {
        if is_unknown_compression(required) {
            let location = FileLocation::Json(format!("extensionsRequired[{index}]"));
            let [ext, khr] = MESHOPT;
            let problem =
                format!("`{required}` is not decoded; {DRACO}, {ext} and {khr} are decoded");
            return Err(ReadError::malformed(name, location, problem));
        }
    }
    Ok(())
}
