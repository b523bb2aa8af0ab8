//! The document of a file, once it is known that it can be read.

use gltf_json::Root;
use serde::Deserialize;

use super::omissions::{Nodeless, parse_with_omissions};
use crate::io::json::parse;
use crate::io::{FromFile, Place, ReadError};

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

/// What is looked at where the whole cannot be parsed.
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

/// The document, once its version is known to be 2 and it requires nothing that is not supported.
pub(super) fn document(json: &[u8], name: &str) -> FromFile<(Root, Nodeless)> {
    if let Ok(root) = Root::from_slice(json) {
        let asset = Asset {
            version: root.asset.version.clone(),
            min_version: root.asset.min_version.clone(),
        };
        check(&asset, &root.extensions_required, name)?;
        return Ok((root, Nodeless::new()));
    }
    // What another version may have in other shapes shows in the version.
    let object = json.trim_ascii_start().starts_with(b"{");
    let heading: Result<Heading, _> = match object {
        true => parse(json, name),
        false => Err(ReadError::of_file(
            name,
            "it begins with no JSON object, as a .gltf does, nor with `glTF` and a chunk that does, as a .glb",
        )),
    };
    let heading = heading.map_err(|error| {
        let problem = format!("not a glTF file: {}", error.problem);
        ReadError::malformed(name, error.place, problem)
    })?;
    check(&heading.asset, &heading.required, name)?;
    parse_with_omissions(json, name)
}

/// Refuses other versions, and what a file requires and nothing here can do.
fn check(asset: &Asset, required: &[String], name: &str) -> FromFile<()> {
    let needed = asset.min_version.as_deref().unwrap_or(&asset.version);
    let wrong_minor = asset.min_version.is_some() && needed != "2.0";
    if needed.split('.').next() != Some("2") || wrong_minor {
        let problem = format!("is glTF of version {needed}; version 2.0 is read");
        let place = Place::Json("asset".into());
        return Err(ReadError::malformed(name, place, problem));
    }
    let harmless = |required: &str| HARMLESS.iter().any(|known| required.starts_with(known));
    for (index, required) in required.iter().enumerate() {
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
    Ok(())
}

/// As people write a family of extensions.
fn known_name(prefix: &str) -> String {
    match prefix.ends_with('_') {
        true => format!("{prefix}…"),
        false => prefix.to_owned(),
    }
}
