//! Files that a document names: taken into it where it goes to another folder.

use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::json_edit::Members;
use super::text;
use crate::io::gltf::LENGTH_LIMIT;
use crate::io::gltf::buffers::{is_data, path};
use crate::io::read_bytes;

/// What files of images are, by the end of their names.
const IMAGES: [(&str, &str); 5] = [
    ("png", "image/png"),
    ("jpg", "image/jpeg"),
    ("jpeg", "image/jpeg"),
    ("webp", "image/webp"),
    ("ktx2", "image/ktx2"),
];

pub(super) fn is_same_folder(one: &Path, other: &Path) -> bool {
    let here = |folder: &Path| match folder.as_os_str().is_empty() {
        true => Path::new(".").canonicalize().ok(),
        false => folder.canonicalize().ok(),
    };
    one == other || here(one).is_some_and(|own| here(other) == Some(own))
}

/// Puts the buffers and images that are files of a folder into the document.
pub(super) fn take_in(document: &mut Members, folder: &Path) -> Result<(), String> {
    let mut problem = None;
    for list in ["buffers", "images"] {
        let taken = document.change_each(list, |index, members| {
            let Some(uri) = text(members, "uri").filter(|uri| !is_data(uri)) else {
                return Ok(false);
            };
            // What is elsewhere stays there.
            let Ok(file) = path(&uri) else {
                return Ok(false);
            };
            match read_bytes(&folder.join(&file), LENGTH_LIMIT) {
                Ok(bytes) => {
                    let data = format!(
                        "data:{};base64,{}",
                        kind(list, &file),
                        STANDARD.encode(bytes)
                    );
                    members.set("uri", &data).map(|()| true)
                }
                // It was not there before either: its name is all there is to keep.
                Err(error) if error.is_missing() => Ok(false),
                Err(error) => {
                    problem = Some(format!("{list}[{index}].uri: {error}"));
                    Ok(false)
                }
            }
        });
        taken.map_err(|error| error.to_string())?;
    }
    problem.map_or(Ok(()), Err)
}

/// The media type of a file.
fn kind(list: &str, file: &str) -> &'static str {
    let ending = file.rsplit('.').next().unwrap_or("").to_ascii_lowercase();
    let known = IMAGES
        .iter()
        .find(|(own, _)| list == "images" && *own == ending);
    known.map_or("application/octet-stream", |(_, kind)| kind)
}
