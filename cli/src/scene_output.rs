//! Lossless output of a scene's file: in a pose, or with an added clip.

use std::path::Path;

use kinopt::animation::{Clip, Pose};
use kinopt::io::gltf::{SceneFile, WriteOptions};
use kinopt::skinning::SkinningMethod;

use crate::failure::Outcome;
use crate::file_access;

/// Writes a scene's file in a pose, with all that it holds.
pub(crate) fn write_posed(
    file: &SceneFile,
    pose: &Pose,
    method: SkinningMethod,
    to: &Path,
) -> Outcome<()> {
    if method != SkinningMethod::LinearBlend {
        return Err(usage!(
            "--out {}: a scene that is written as glTF keeps its skin, which whoever shows it blends linearly; --skinning {} is \
             for .obj and .ply",
            to.display(),
            method.name()
        ));
    }
    let mut posed = file.clone();
    posed.set_rest(pose)?;
    Ok(posed.write(to)?)
}

/// The file that a clip of a scene is added to: the one at a path, which has the same bones, or where there is none a copy of the
/// scene's own.
pub(crate) fn file_to_add_to(own: &SceneFile, into: &Path) -> Outcome<SceneFile> {
    if !into.exists() {
        return Ok(own.clone());
    }
    let file = SceneFile::read_with(into, &file_access::allowed())?;
    match file.scene().armature.names() == own.scene().armature.names() {
        true => Ok(file),
        false => Err(failure!(
            "{}: its bones are not those of the model; `kinopt info` lists either",
            into.display()
        )),
    }
}

/// Writes a file with one clip more, called as given; without that by its own name, or where that is taken by another.
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
        .any(|own| own.name() == clip.name());
    let clip = match given.or(is_taken.then_some(other)) {
        Some(name) => clip.renamed(name),
        None => clip,
    };
    let added = file.add_clip(&clip, &WriteOptions::default());
    added.map_err(|error| failure!("{}: {error}; --clip-name gives another", to.display()))?;
    file.write(to)?;
    Ok(clip)
}
