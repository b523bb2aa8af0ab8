//! Embedding of external files, for a document that is written to another folder.

use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::image_type::media_type;
use super::json_edit::Members;
use super::text;
use crate::io::gltf::buffers::{is_data, path};
use kinopt_kinematics::file_access::AllowedFiles;

pub(super) fn is_same_folder(one: &Path, other: &Path) -> bool {
    let canonical = |folder: &Path| match folder.as_os_str().is_empty() {
        true => Path::new(".").canonicalize().ok(),
        false => folder.canonicalize().ok(),
    };
    one == other
        || canonical(one).is_some_and(|canonical_folder| canonical(other) == Some(canonical_folder))
}

/// Embeds the external buffers and images that are allowed files.
///
/// References to missing files and to URLs stay.
pub(super) fn embed_files(document: &mut Members, allowed: &AllowedFiles) -> Result<(), String> {
    let mut problem = None;
    for list in ["buffers", "images"] {
        let result = document.change_each(list, |index, members| {
            let embedded = text(members, "uri").map_or(Ok(None), |uri| {
                embedded(list, &uri, text(members, "mimeType"), allowed)
            });
            match embedded {
                Ok(Some(data)) => members.set("uri", &data).map(|()| true),
                Ok(None) => Ok(false),
                Err(error) => {
                    problem.get_or_insert(format!("{list}[{index}].uri: {error}"));
                    Ok(false)
                }
            }
        });
        result.map_err(|error| error.to_string())?;
    }
    problem.map_or(Ok(()), Err)
}

/// An external file as a data URI; `None` for references that stay.
fn embedded(
    list: &str,
    uri: &str,
    declared: Option<String>,
    allowed: &AllowedFiles,
) -> Result<Option<String>, String> {
    let Some(file) = path(uri).ok().filter(|_| !is_data(uri)) else {
        return Ok(None);
    };
    let bytes = match allowed.open(&file) {
        Ok(bytes) => bytes,
        Err(error) if error.is_missing() => return Ok(None),
        Err(error) => return Err(error.to_string()),
    };
    let kind = match list {
        "images" => {
            let kind = media_type(&bytes, declared.as_deref());
            kind.map_err(|problem| format!("{file}: {problem}"))?
        }
        _ => "application/octet-stream",
    };
    Ok(Some(format!(
        "data:{kind};base64,{}",
        STANDARD.encode(bytes)
    )))
}
