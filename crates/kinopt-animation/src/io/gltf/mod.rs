//! glTF 2.0 (feature `gltf`): reading and writing characters, their meshes and their clips as `.glb` and `.gltf` files.
//!
//! The parts of a file are read as follows:
//!
//! - **Nodes** are the bones of one [`Armature`], parents before children in any order of the file. A node's matrix is
//!   decomposed into translation, rotation and scale; a matrix with shear is an error.
//! - **Skins** keep their inverse bind matrices: the bind pose may differ from the rest pose. Posing a skin therefore
//!   needs [`Skin::joint_from_mesh`], as in [`ScenePosing`], instead of [`Armature::skinning_transforms`].
//! - **Meshes** are the joined primitives of a glTF mesh, indexed or not. Strips and fans become triangles; points and
//!   lines are left out. Negative weights and weights that do not sum to 1 are repaired, with a [`Note`].
//! - **Morph targets** of all meshes are in one list, that of the armature. Their weights at rest are those of the
//!   file.
//! - **Animations** are [`Clip`]s with step, linear (slerp for rotations) and cubic spline curves.
//!
//! Compressed views (`EXT_meshopt_compression`, `KHR_meshopt_compression`) and quantised attributes are decoded, and
//! with the feature `draco` also `KHR_draco_mesh_compression`. Another required compression is an error. All other
//! extensions, materials, textures, cameras, lights, texture coordinates and colours are left out and listed in
//! [`Scene::notes`], also if the file requires them. A [`SceneFile`] keeps them all and adds clips to the file.
//!
//! ```no_run
//! use kinopt::animation::{Cursor, Playback};
//! use kinopt::io::gltf::{self, ScenePosing};
//! use kinopt::skinning::SkinningMethod;
//!
//! let fox = gltf::read("fox.glb")?;
//! let run = fox.clip("run")?;
//! let mut posing = ScenePosing::new(&fox, SkinningMethod::LinearBlend)?;
//! let (mut pose, mut cursor) = (fox.armature.rest().clone(), Cursor::new());
//! run.sample(0.25, Playback::Loop, &mut cursor, &mut pose)?;
//! let mesh = posing.mesh(&pose)?;
//! gltf::write_mesh(&mesh, "posed.glb")?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod accessor_view;
mod accessors;
mod animations;
mod buffers;
mod compression;
mod document;
mod glb;
mod keys;
mod masses;
mod meshes;
mod morph_targets;
mod node_transform;
mod nodes;
mod note;
mod of_skeleton;
mod omissions;
mod posing;
mod primitives;
mod raw_mesh;
mod scene;
mod scene_file;
mod skins;
mod source;
mod sparse;
mod triangles;
mod write;

pub use note::Note;
pub use posing::ScenePosing;
pub use scene::{Scene, SceneError, SceneMesh, Skin};
pub use scene_file::SceneFile;
pub use write::{UnwritableScene, WriteOptions, mesh_to_bytes, to_bytes, write, write_mesh};

use std::path::Path;

use gltf_json::Root;

use self::source::GltfSource;
use super::{FileAccess, ReadError};
use crate::animation::{Armature, Clip, ClipError};
use kinopt_kinematics::file_access::below_folder;
use kinopt_kinematics::skeleton::BoneId;

/// Reads a `.glb` or `.gltf` file and its buffers, which must be below its folder.
///
/// # Errors
/// A [`ReadError`] that names the file, a path in it such as `animations[1].samplers[0]`, and the node, mesh or
/// animation.
pub fn read(path: impl AsRef<Path>) -> Result<Scene, ReadError> {
    read_with(path, &FileAccess::new())
}

/// Reads a `.glb` or `.gltf` file and its buffers, as far as `access` allows.
///
/// # Errors
/// As [`read`].
pub fn read_with(path: impl AsRef<Path>, access: &FileAccess) -> Result<Scene, ReadError> {
    let path = path.as_ref();
    let allowed = access.of_file(path);
    access.read_with(path, |bytes, name| {
        Ok(parse(bytes, name, |file| allowed.open(file))?.scene)
    })
}

/// Reads a scene from the bytes of a `.glb` or `.gltf` file. `name` is the file name for messages. `open` returns the
/// contents of a buffer for its path relative to the file, which is below the file's folder.
///
/// # Errors
/// As [`read`], and the errors of `open`.
pub fn from_bytes(
    bytes: &[u8],
    name: &str,
    open: impl FnMut(&str) -> Result<Vec<u8>, ReadError>,
) -> Result<Scene, ReadError> {
    Ok(parse(bytes, name, below_folder(open))?.scene)
}

/// A scene, and the relation of its bones to the nodes of the file.
struct Parsed {
    scene: Scene,
    /// The bone of each node.
    bone_of: Vec<BoneId>,
}

fn parse(
    bytes: &[u8],
    name: &str,
    open: impl FnMut(&str) -> Result<Vec<u8>, ReadError>,
) -> Result<Parsed, ReadError> {
    let chunks = glb::split(bytes, name)?;
    let (mut root, nodeless) = document::document(chunks.json, name)?;
    let compressed = compression::members(&root, chunks.json, name)?;
    let mut buffers = buffers::load(&root, chunks.binary, compressed.as_ref(), name, open)?;
    let memory_limit = source::memory_limit(chunks.json.len(), &buffers);
    let undecoded = match &compressed {
        Some(members) => compression::decode(members, &mut root, &mut buffers, memory_limit, name)?,
        None => compression::Undecoded::new(),
    };
    let source = GltfSource::new(name, &root, buffers, undecoded, memory_limit);
    let mut notes = left_out(&root);
    let nodes = nodes::read(&source, &mut notes)?;
    let mut meshes = meshes::read(&source, &nodes, &mut notes)?;
    let names = std::mem::take(&mut meshes.target_names);
    let armature = Armature::new(nodes.bones.clone(), names)
        .map_err(|error| source.fail("nodes", error.to_string()))?
        .with_rest_morph_weights(&meshes.target_weights)
        .map_err(|error| source.fail("meshes", error.to_string()))?;
    let clips = animations::read(&source, &nodeless, &nodes, &meshes, &armature, &mut notes)?;
    let mut scene = Scene {
        armature,
        meshes: meshes.meshes,
        clips,
        notes,
    };
    if scene.meshes.iter().any(|mesh| mesh.skin.is_some()) {
        let scaled = scene.armature.scale_notes_of(scene.turning_bones());
        scene.notes.extend(scaled.into_iter().map(Note::Scaled));
    }
    Ok(Parsed {
        scene,
        bone_of: nodes.bone_of,
    })
}

impl Scene {
    /// Looks up a clip by name, or by the end of its name: see [`Clip::named`].
    ///
    /// # Errors
    /// As [`Clip::named`].
    pub fn clip(&self, name: &str) -> Result<&Clip, ClipError> {
        Clip::named(&self.clips, name)
    }
}

/// Notes on the lists and extensions that the reader ignores.
fn left_out(root: &Root) -> Vec<Note> {
    let lists = [
        ("cameras", root.cameras.len()),
        ("images", root.images.len()),
        ("materials", root.materials.len()),
        ("textures", root.textures.len()),
    ];
    let filled = lists.into_iter().filter(|(_, count)| *count > 0);
    let lists = filled.map(|(what, count)| Note::left_out(what, format!("{count} {what}")));
    let extensions = root.extensions_used.iter().enumerate();
    let ignored = extensions.filter(|(_, name)| !document::is_applied(name));
    let extensions = ignored.map(|(index, name)| {
        Note::left_out(
            format!("extensionsUsed[{index}]"),
            format!("extension `{name}`"),
        )
    });
    lists.chain(extensions).collect()
}
