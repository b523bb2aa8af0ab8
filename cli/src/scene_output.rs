//! Lossless output of a scene's file: in a pose, or with an added clip.

use std::path::Path;

use kinopt::animation::{Clip, Pose};
use kinopt::io::gltf::{SceneFile, WriteOptions};
use kinopt::skinning::SkinningMethod;

use crate::failure::Outcome;
use crate::file_access;

/// Writes a scene's file in a pose, with all of its content.
pub(crate) fn write_posed(
    file: &SceneFile,
    pose: &Pose,
    method: SkinningMethod,
    to: &Path,
) -> Outcome<()> {
    if method != SkinningMethod::LinearBlend {
        return Err(usage!(
            "--out {}: a scene written as glTF keeps its skin, which viewers blend linearly; --skinning {} is \
             for .obj and .ply",
            to.display(),
            method.name()
        ));
    }
    let mut posed = file.clone();
    posed.set_rest(pose)?;
    Ok(posed.write(to)?)
}

/// File to which a scene's clip is added: the file at a path, with the same bones, or a copy of the scene's own file.
pub(crate) fn file_to_add_to(own: &SceneFile, into: &Path) -> Outcome<SceneFile> {
    if !into.exists() {
        return Ok(own.clone());
    }
    let file = SceneFile::read_with(into, &file_access::allowed())?;
    match file.scene().armature.names() == own.scene().armature.names() {
        true => Ok(file),
        false => Err(failure!(
            "{}: its bones differ from those of the model; `kinopt info` lists both",
            into.display()
        )),
    }
}

/// Writes a file with one more clip, named `given`, or its own name, or `other` if that name exists.
pub(crate) fn write_with_clip(
    mut file: SceneFile,
    clip: Clip,
    given: Option<&str>,
    other: &str,
    to: &Path,
) -> Outcome<Clip> {
    let is_taken = file
        .scene()
        .clips
        .iter()
        .any(|existing| existing.name() == clip.name());
    let clip = match given.or(is_taken.then_some(other)) {
        Some(name) => clip.renamed(name),
        None => clip,
    };
    let added = file.add_clip(&clip, &WriteOptions::default());
    added.map_err(|error| failure!("{}: {error}; --clip-name sets another name", to.display()))?;
    file.write(to)?;
    Ok(clip)
}
