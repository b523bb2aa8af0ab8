//! Editing of glTF files: adding clips and changing the rest pose, with everything else kept.

mod appended_clip;
mod external_files;
mod humanoid;
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
use crate::io::{FileAccess, ReadError, WriteError, write_file};
use kinopt_kinematics::file_access::{AllowedFiles, below_folder};
use kinopt_kinematics::skeleton::BoneId;
use kinopt_mesh::json::parse_by;

/// A `.glb` or `.gltf` file with its scene. It adds clips to the file and changes the rest pose of its nodes.
///
/// All other contents keep their original text and bytes. This includes contents that the reader ignores: materials,
/// textures, images, texture coordinates, colours, cameras, extras and extensions.
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
    /// Bone of each node.
    bone_of: Vec<BoneId>,
    document: Members,
    container: Container,
    /// Files that the document may refer to; `None` for a document from memory, which opens no file.
    allowed: Option<AllowedFiles>,
}

/// Container of the document.
#[derive(Clone, Debug)]
enum Container {
    /// A `.gltf` file.
    Text,
    /// A `.glb` file: its binary chunk, and chunks of types outside glTF.
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

    /// Reads a `.glb` or `.gltf` file and its buffers, as far as `access` allows. `access` also applies to images that
    /// [`write`](Self::write) opens.
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

    /// Reads the bytes of a `.glb` or `.gltf` file. `name` is the file name for messages. `open` returns the contents
    /// of a buffer for its path relative to the file, which is below the file's folder. [`write`](Self::write) then
    /// opens no external files.
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
        open: impl FnMut(&str) -> Result<Vec<u8>, ReadError>,
    ) -> Result<Self, ReadError> {
        let Parsed { scene, bone_of } = parse(bytes, name, open)?;
        let chunks = glb::split(bytes, name)?;
        let document = parse_by(|json| serde_json::from_slice(json), chunks.json, name)?;
        let owned_chunk = |(kind, bytes): ([u8; 4], &[u8])| (kind, bytes.to_vec());
        let container = match glb::is_glb(bytes) {
            false => Container::Text,
            true => Container::Binary {
                buffer: chunks.binary.unwrap_or(&[]).to_vec(),
                others: chunks.others.into_iter().map(owned_chunk).collect(),
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

    /// The scene of the file, including added clips.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Appends a clip to the file. Its keys are appended to the binary chunk of a `.glb`, or stored in an additional
    /// buffer within the text of a `.gltf`.
    ///
    /// # Errors
    /// A clip of another armature, a name that another clip of the file has, or a curve with too many keys. The file
    /// does not change then.
    pub fn add_clip(&mut self, clip: &Clip, options: &WriteOptions) -> Result<(), UnwritableScene> {
        let has_name = self
            .scene
            .clips
            .iter()
            .any(|existing| existing.name() == clip.name());
        if has_name {
            return Err(UnwritableScene::ClipNameTaken {
                clip: clip.name().to_owned(),
                clips: self
                    .scene
                    .clips
                    .iter()
                    .map(|existing| existing.name().to_owned())
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

    /// Sets the rest pose of the nodes, and the rest weights of morph targets on the nodes of the meshes.
    ///
    /// Keyed values of clips do not change. Bones without keys follow the new rest pose.
    ///
    /// # Errors
    /// A pose of another armature. The file does not change then.
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

    /// The bytes of the file: GLB if a `.glb` was read, else the text of a `.gltf`. References to external files stay.
    ///
    /// # Errors
    /// The file exceeds 4 GiB, the limit of GLB.
    pub fn to_bytes(&self) -> Result<Vec<u8>, UnwritableScene> {
        bytes_of(&self.document, &self.container)
    }

    /// Writes a `.glb`, `.gltf` or `.vrm` file; VRM files are GLB files. In another folder than the original, images and buffers with relative paths are
    /// embedded. References to missing files stay, and so do all references of a document from memory.
    ///
    /// # Errors
    /// A [`WriteError`] that names the file. The file cannot be written, or has another extension. An external file is
    /// outside the allowed folders or cannot be read. The first bytes of an image do not match its type.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), WriteError> {
        let path = path.as_ref();
        let fail =
            |problem: String| WriteError::new(path, Error::new(ErrorKind::InvalidInput, problem));
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        let (mut document, mut container) = (self.document.clone(), self.container.clone());
        match (extension.to_str(), &container) {
            (Some("glb" | "vrm"), Container::Binary { .. }) | (Some("gltf"), Container::Text) => {}
            (Some("glb" | "vrm"), Container::Text) => {
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
            _ => return Err(fail("scenes are written as .glb, .gltf or .vrm".into())),
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        if let Some(allowed) = &self.allowed {
            if !external_files::is_same_folder(folder, allowed.folder()) {
                external_files::embed_files(&mut document, allowed).map_err(&fail)?;
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

/// Writes a node's new rest transform if it changed; returns whether it did.
fn pose_node(
    members: &mut Members,
    bone: BoneId,
    [old, new]: [&Armature; 2],
) -> serde_json::Result<bool> {
    let [before, after] = [old, new].map(|armature| armature.rest().local_of(bone));
    let moved = before != after;
    if moved {
        set_transform(members, after)?;
    }
    Ok(moved)
}

/// Sets translation, rotation and scale of a node and removes its matrix.
fn set_transform(members: &mut Members, transform: LocalTransform) -> serde_json::Result<()> {
    members.remove("matrix");
    members.set("translation", &transform.translation.to_array())?;
    members.set("rotation", &transform.rotation.to_array())?;
    members.set("scale", &transform.scale.to_array())
}

/// The value of a member that is a string; `None` otherwise.
fn text(members: &Members, key: &str) -> Option<String> {
    let value: &RawValue = members.get(key)?;
    serde_json::from_str(value.get()).ok()
}
