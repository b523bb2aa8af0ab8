//! A file that keeps what it holds while clips are added to it and its bones are posed.

mod appended_clip;
mod external_files;
mod image_type;
mod json_edit;

use std::io::{Error, ErrorKind};
use std::path::Path;

use serde_json::value::RawValue;

use self::json_edit::Members;
use super::glb;
use super::write::{UnwritableScene, WriteOptions, clip_document};
use super::{Parsed, Scene, parse};
use crate::animation::{Armature, Clip, LocalTransform, Pose};
use crate::file_access::{AllowedFiles, below_folder};
use crate::io::json::parse_by;
use crate::io::{FileAccess, FromFile, ReadError, WriteError, write_file};
use crate::skeleton::BoneId;

/// A `.glb` or `.gltf` file as it was read, with the scene in it. Clips are added to it and its nodes posed; everything else, also
/// what nothing here understands (materials, textures, images, texture coordinates, colours, cameras, extras, extensions), stays
/// the text and the bytes that were read.
///
/// ```no_run
/// use kinopt::io::gltf::{SceneFile, WriteOptions};
///
/// let mut fox = SceneFile::read("fox.glb")?;
/// let slow = fox.scene().clip("walk")?.clone().renamed("slow walk");
/// fox.add_clip(&slow, &WriteOptions::default())?;
/// fox.write("fox.glb")?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct SceneFile {
    scene: Scene,
    /// The bone of each node.
    bone_of: Vec<BoneId>,
    document: Members,
    container: Container,
    /// The files that it may name; `None` for a document from memory, which opens no file.
    allowed: Option<AllowedFiles>,
}

/// What the document stands in.
#[derive(Clone, Debug)]
enum Container {
    /// A `.gltf` file: text.
    Text,
    /// A `.glb` file: its binary chunk, and chunks of kinds that glTF does not know.
    Binary {
        buffer: Vec<u8>,
        others: Vec<([u8; 4], Vec<u8>)>,
    },
}

impl SceneFile {
    /// Reads a `.glb` or `.gltf` file and its buffers, which must be below its folder.
    ///
    /// # Errors
    /// As [`read`](super::read).
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        Self::read_with(path, &FileAccess::new())
    }

    /// Reads a `.glb` or `.gltf` file and its buffers, as far as `access` allows. [`write`](Self::write) opens images by it too.
    ///
    /// # Errors
    /// As [`read`](super::read).
    pub fn read_with(path: impl AsRef<Path>, access: &FileAccess) -> Result<Self, ReadError> {
        let path = path.as_ref();
        let allowed = access.of_file(path);
        let mut read = access.read_with(path, |bytes, name| {
            Self::parsed(bytes, name, |file| allowed.open(file))
        })?;
        read.allowed = Some(allowed);
        Ok(read)
    }

    /// Reads the bytes of a `.glb` or `.gltf` file; `name` is for messages. `open` gets the contents of a buffer by its path relative
    /// to the file, if that leads below the file's folder. [`write`](Self::write) opens no file then.
    ///
    /// # Errors
    /// As [`from_bytes`](super::from_bytes).
    pub fn from_bytes(
        bytes: &[u8],
        name: &str,
        open: impl FnMut(&str) -> Result<Vec<u8>, ReadError>,
    ) -> Result<Self, ReadError> {
        Self::parsed(bytes, name, below_folder(open))
    }

    fn parsed(
        bytes: &[u8],
        name: &str,
        open: impl FnMut(&str) -> FromFile<Vec<u8>>,
    ) -> FromFile<Self> {
        let Parsed { scene, bone_of } = parse(bytes, name, open)?;
        let chunks = glb::split(bytes, name)?;
        let document = parse_by(|json| serde_json::from_slice(json), chunks.json, name)?;
        let own = |(kind, bytes): ([u8; 4], &[u8])| (kind, bytes.to_vec());
        let container = match glb::is_glb(bytes) {
            false => Container::Text,
            true => Container::Binary {
                buffer: chunks.binary.unwrap_or(&[]).to_vec(),
                others: chunks.others.into_iter().map(own).collect(),
            },
        };
        Ok(Self {
            scene,
            bone_of,
            document,
            container,
            allowed: None,
        })
    }

    getters! {
        /// What in it can be posed, with the clips that were added.
        pub fn scene(&self) -> &Scene = &self.scene;
    }

    /// Adds a clip behind those that are there. Its keys go behind the file's binary chunk, or in a `.gltf` into a buffer of their own
    /// within the text.
    ///
    /// # Errors
    /// A clip of another armature, a name that one of the file's clips has, a curve of too many keys; the file stays as it is.
    pub fn add_clip(&mut self, clip: &Clip, options: &WriteOptions) -> Result<(), UnwritableScene> {
        let is_there = self.scene.clips.iter().any(|own| own.name() == clip.name());
        if is_there {
            return Err(UnwritableScene::ClipNameTaken {
                clip: clip.name().to_owned(),
                clips: self
                    .scene
                    .clips
                    .iter()
                    .map(|own| own.name().to_owned())
                    .collect(),
            });
        }
        let added = clip_document(&self.scene, clip, options)?;
        let (mut document, mut container) = (self.document.clone(), self.container.clone());
        appended_clip::join(added, &self.bone_of, &mut document, &mut container)?;
        (self.document, self.container) = (document, container);
        self.scene.clips.push(clip.clone());
        Ok(())
    }

    /// Makes a pose the one that the nodes have where no clip moves them, and the weights of morph targets those of the meshes'
    /// nodes. Clips say what they said; what of a clip stood at rest stands in this pose now.
    ///
    /// # Errors
    /// A pose of another armature; the file stays as it is.
    pub fn set_rest(&mut self, pose: &Pose) -> Result<(), UnwritableScene> {
        let old = &self.scene.armature;
        let posed = old.clone().at_rest_in(pose)?;
        let clips = self
            .scene
            .clips
            .iter()
            .map(|clip| clip.at_rest_in(old, &posed));
        let clips = clips.collect::<Result<Vec<Clip>, _>>()?;
        let mut document = self.document.clone();
        let weights_of = |bone: BoneId, armature: &Armature| {
            let mesh = self.scene.meshes.iter().find(|mesh| mesh.bone == bone)?;
            let weights = armature.rest().morph_weights();
            weights.get(mesh.morph_weights()).map(<[f32]>::to_vec)
        };
        document.change_each("nodes", |node, members| {
            let Some(&bone) = self.bone_of.get(node) else {
                return Ok(false);
            };
            let moved = pose_node(members, bone, [old, &posed])?;
            let [before, after] = [old, &posed].map(|armature| weights_of(bone, armature));
            let morphed = before != after;
            if morphed {
                members.set("weights", &after)?;
            }
            Ok(moved || morphed)
        })?;
        self.document = document;
        self.scene.armature = posed;
        self.scene.clips = clips;
        Ok(())
    }

    /// The file's bytes: `.glb` where a `.glb` was read, else the text of a `.gltf`. Other files that it names are still named.
    ///
    /// # Errors
    /// It takes 4 GiB, which GLB cannot have.
    pub fn to_bytes(&self) -> Result<Vec<u8>, UnwritableScene> {
        bytes_of(&self.document, &self.container)
    }

    /// Writes it to a `.glb` or `.gltf` file. In another folder than it was read from, the images and buffers that it names by
    /// relative paths are put into it. One that does not exist stays named, and all of a document from memory.
    ///
    /// # Errors
    /// A [`WriteError`] naming the file. The file cannot be written, or its name ends otherwise. A named file is outside of the
    /// allowed folders, or cannot be read. An image does not begin as files of its type do.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), WriteError> {
        let path = path.as_ref();
        let fail =
            |problem: String| WriteError::new(path, Error::new(ErrorKind::InvalidInput, problem));
        let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
        let (mut document, mut container) = (self.document.clone(), self.container.clone());
        match (ending.to_str(), &container) {
            (Some("glb"), Container::Binary { .. }) | (Some("gltf"), Container::Text) => {}
            (Some("glb"), Container::Text) => {
                container = Container::Binary {
                    buffer: Vec::new(),
                    others: Vec::new(),
                };
            }
            (Some("gltf"), Container::Binary { buffer, .. }) => {
                let moved = appended_clip::move_to_text(buffer, &mut document);
                moved.map_err(|error| fail(error.to_string()))?;
                container = Container::Text;
            }
            _ => return Err(fail("scenes are written as .glb or .gltf".into())),
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        if let Some(allowed) = &self.allowed {
            if !external_files::is_same_folder(folder, allowed.folder()) {
                external_files::take_in(&mut document, allowed).map_err(&fail)?;
            }
        }
        let bytes = bytes_of(&document, &container).map_err(|error| fail(error.to_string()))?;
        write_file(path, &bytes)
    }
}

fn bytes_of(document: &Members, container: &Container) -> Result<Vec<u8>, UnwritableScene> {
    let json = serde_json::to_vec(document)?;
    match container {
        Container::Text => Ok(json),
        Container::Binary { buffer, others } => {
            let bytes = json.len() + buffer.len();
            glb::join(&json, buffer, others).ok_or(UnwritableScene::TooLong { bytes })
        }
    }
}

/// Gives a node the place that its bone has at rest now, where that is another; says whether it did.
fn pose_node(
    members: &mut Members,
    bone: BoneId,
    [old, new]: [&Armature; 2],
) -> serde_json::Result<bool> {
    let [before, after] = [old, new].map(|armature| armature.rest().local_of(bone));
    let moved = before != after;
    if moved {
        place(members, after)?;
    }
    Ok(moved)
}

/// Says where a node is by translation, rotation and scale, and no longer by a matrix.
fn place(members: &mut Members, at: LocalTransform) -> serde_json::Result<()> {
    members.remove("matrix");
    members.set("translation", &at.translation.to_array())?;
    members.set("rotation", &at.rotation.to_array())?;
    members.set("scale", &at.scale.to_array())
}

/// The text of a member that is a string; `None` where it is none.
fn text(members: &Members, key: &str) -> Option<String> {
    let value: &RawValue = members.get(key)?;
    serde_json::from_str(value.get()).ok()
}
