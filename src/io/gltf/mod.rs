//! glTF 2.0 (feature `gltf`): characters, their meshes and their clips, from and to `.glb` and
//! `.gltf` files.
//!
//! What becomes of a file:
//!
//! - **Nodes** are the bones of one [`Armature`], parents before children whatever order the file
//!   has, so that whatever is animated can be. A node's matrix is taken apart into translation,
//!   rotation and scale; one that shears is an error.
//! - **Skins** keep their inverse bind matrices as they are: the pose a mesh was bound in need not
//!   be the rest pose. So posing a skin takes [`Skin::joint_from_mesh`], as [`ScenePosing`] does,
//!   and not [`Armature::skinning_transforms`].
//! - **Meshes** are the primitives of a glTF mesh joined, indexed or not, strips and fans as
//!   triangles; primitives of points and lines are left out. Weights that are negative or do not sum to 1 are put right, which a [`Note`] says.
//! - **Morph targets** are those of all meshes in one list, the armature's; their weights at rest are
//!   the file's.
//! - **Animations** are [`Clip`]s: steps, lines (rotations: slerp) and cubic splines.
//!
//! An extension that a file requires is an error, except for those that change looks only and
//! `KHR_mesh_quantization`. Materials, textures, cameras, lights, texture coordinates and colours are
//! left out; what was is in [`Scene::notes`]. A [`SceneFile`] keeps them all, and clips are added to it.
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
mod document;
mod glb;
mod keys;
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
pub use posing::{PosingError, ScenePosing};
pub use scene::{Scene, SceneError, SceneMesh, Skin};
pub use scene_file::SceneFile;
pub use write::{UnwritableScene, WriteOptions, mesh_to_bytes, to_bytes, write, write_mesh};

use std::path::Path;

use gltf_json::Root;

use self::source::Source;
use super::{FileAccess, FromFile, ReadError};
use crate::animation::{Armature, Clip, ClipNameError};
use crate::file_access::below_folder;
use crate::skeleton::BoneId;

/// Reads a `.glb` or `.gltf` file and its buffers, which must be below its folder.
///
/// # Errors
/// A [`ReadError`] naming the file, a path in it such as `animations[1].samplers[0]`, and the node,
/// mesh or animation.
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

/// Reads a scene from the bytes of a `.glb` or `.gltf` file; `name` is for messages. `open` gets the
/// contents of a buffer by its path relative to the file, if that leads below the file's folder.
///
/// # Errors
/// As [`read`], and whatever `open` fails with.
pub fn from_bytes(
    bytes: &[u8],
    name: &str,
    open: impl FnMut(&str) -> Result<Vec<u8>, ReadError>,
) -> Result<Scene, ReadError> {
    Ok(parse(bytes, name, below_folder(open))?.scene)
}

/// A scene, and which nodes of the file its bones are.
struct Parsed {
    scene: Scene,
    /// The bone of each node.
    bone_of: Vec<BoneId>,
}

fn parse(
    bytes: &[u8],
    name: &str,
    open: impl FnMut(&str) -> FromFile<Vec<u8>>,
) -> FromFile<Parsed> {
    let chunks = glb::split(bytes, name)?;
    let (root, nodeless) = document::document(chunks.json, name)?;
    let buffers = buffers::load(&root, chunks.binary, name, open)?;
    let source = Source::new(name, &root, chunks.json.len(), buffers);
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
    /// Looks a clip up by name, or by the end of its name, as [`Clip::named`] does.
    ///
    /// # Errors
    /// As there.
    pub fn clip(&self, name: &str) -> Result<&Clip, ClipNameError> {
        Clip::named(&self.clips, name)
    }
}

/// The lists of a document that nothing here is for.
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
    let ignored = extensions.filter(|(_, name)| *name != document::QUANTIZATION);
    let extensions = ignored.map(|(index, name)| {
        Note::left_out(
            format!("extensionsUsed[{index}]"),
            format!("extension `{name}`"),
        )
    });
    lists.chain(extensions).collect()
}
