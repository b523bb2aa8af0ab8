//! Writing of scenes and posed meshes as `.glb` files.

/// A part of the document without extensions and extras.
macro_rules! plain {
    ($($part:ident)::+ { $($entries:tt)* }) => {
        $($part)::+ { extensions: None, extras: None, $($entries)* }
    };
}

mod animations;
mod buffer;
mod error;
mod keys;
mod meshes;
mod nodes;
mod skins;

use std::io::{Error, ErrorKind};
use std::path::Path;

use glam::Vec3;
use gltf_json as json;
use gltf_json::Index;

pub use error::UnwritableScene;

use self::buffer::Document;
use super::scene::{Scene, SceneMesh};
use crate::animation::{Armature, ArmatureBone, Clip, LocalTransform};
use crate::io::{WriteError, write_file};
use crate::skinning::MorphTargets;
use kinopt_kinematics::skeleton::BoneId;
use kinopt_mesh::mesh::TriangleMesh;

/// Options of writing scenes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct WriteOptions {
    /// Samples per second of curves that glTF cannot represent. These are eased and Bézier curves, squad and Hermite
    /// rotations, Euler angles, and morph weights with different keys. They become linear curves through these samples
    /// and their own keys.
    pub keys_per_second: f32,
    /// Up axis of the scene. If it is not y, the up axis of glTF, an additional root node rotates it to y, so that
    /// viewers show the scene upright. Bones, clips and skins do not change.
    pub up: Vec3,
}

impl Default for WriteOptions {
    /// 30 keys per second, y up.
    fn default() -> Self {
        Self {
            keys_per_second: 30.0,
            up: Vec3::Y,
        }
    }
}

/// The bytes of a `.glb` file of a scene. [Reading](super::from_bytes) them gives an equal scene in single precision
/// and in the order of the bones, with these exceptions:
///
/// - Weights are written in single precision.
/// - Curves that glTF cannot represent are [sampled](WriteOptions::keys_per_second).
/// - A clip that starts before 0 s is shifted to start at 0 s, as glTF has no negative times. A clip longer than its
///   keys gets constant keys of one bone. A clip shorter than its keys gets their span.
/// - A scene whose [up](WriteOptions::up) axis is not y gets an additional root bone.
/// - Events are left out. So are deltas of normals and tangents for a mesh without normals or tangents. Morph targets
///   have their names in the armature.
/// - Normals are written unchanged; glTF requires unit length.
///
/// # Errors
/// An [`UnwritableScene`] that names the mesh, bone or clip.
pub fn to_bytes(scene: &Scene, options: &WriteOptions) -> Result<Vec<u8>, UnwritableScene> {
    let rate = rate(options)?;
    for mesh in &scene.meshes {
        mesh.check(&scene.armature)?;
    }
    let mut document = Document::new();
    document.root.nodes = nodes::from_armature(&scene.armature);
    let bones = (0..scene.armature.bones()).map(BoneId::new);
    let roots = bones.filter(|bone| scene.armature.parent(*bone).is_none());
    let mut roots: Vec<_> = roots.map(|bone| Index::new(bone.index() as u32)).collect();
    if let Some(up_node) = nodes::up_rotation_node(&scene.armature, options.up, &roots)? {
        roots = vec![document.root.push(up_node)];
    }
    if !roots.is_empty() {
        let scene_index = document.root.push(plain!(json::Scene {
            name: None,
            nodes: roots,
        }));
        document.root.scene = Some(scene_index);
    }
    meshes::add(scene, &mut document)?;
    for clip in &scene.clips {
        animations::add(scene, clip, rate, &mut document)?;
    }
    document.finish()
}

/// A document of one clip for appending to the scene's file; node indices are bone indices.
pub(super) struct ClipDocument {
    pub(super) root: json::Root,
    pub(super) bytes: Vec<u8>,
    /// Rest pose of the bones.
    pub(super) rest: Vec<LocalTransform>,
}

pub(super) fn clip_document(
    scene: &Scene,
    clip: &Clip,
    options: &WriteOptions,
) -> Result<ClipDocument, UnwritableScene> {
    let mut document = Document::new();
    animations::add(scene, clip, rate(options)?, &mut document)?;
    let rest = scene.armature.rest();
    let (root, bytes) = document.into_parts();
    Ok(ClipDocument {
        root,
        bytes,
        rest: scene
            .armature
            .bone_ids()
            .map(|bone| rest.local_of(bone))
            .collect(),
    })
}

fn rate(options: &WriteOptions) -> Result<f32, UnwritableScene> {
    let rate = options.keys_per_second;
    match rate.is_finite() && rate > 0.0 {
        true => Ok(rate),
        false => Err(UnwritableScene::BadRate(rate)),
    }
}

/// Writes [`to_bytes`] to a file, whose extension should be `.glb`.
///
/// # Errors
/// A [`WriteError`] that names the file: it cannot be written, or an error of [`to_bytes`].
pub fn write(
    scene: &Scene,
    options: &WriteOptions,
    path: impl AsRef<Path>,
) -> Result<(), WriteError> {
    written(to_bytes(scene, options), path.as_ref())
}

/// The bytes of a `.glb` file of a static mesh, such as a posed one.
///
/// # Errors
/// The mesh has no vertices or no triangles, or the file exceeds 4 GiB.
pub fn mesh_to_bytes(mesh: &TriangleMesh) -> Result<Vec<u8>, UnwritableScene> {
    let document = |error: String| UnwritableScene::Document(error);
    let bone = ArmatureBone {
        name: "mesh".into(),
        parent: None,
        rest: LocalTransform::IDENTITY,
    };
    let armature = Armature::new(vec![bone], Vec::new());
    let scene = Scene {
        armature: armature.map_err(|error| document(error.to_string()))?,
        meshes: vec![SceneMesh {
            name: "mesh".into(),
            bone: BoneId::new(0),
            mesh: mesh.clone(),
            tangents: Vec::new(),
            morph_targets: MorphTargets::none(mesh.positions().len()),
            first_morph_weight: 0,
            skin: None,
        }],
        clips: Vec::new(),
        notes: Vec::new(),
    };
    to_bytes(&scene, &WriteOptions::default())
}

/// Writes [`mesh_to_bytes`] to a file, whose extension should be `.glb`.
///
/// # Errors
/// A [`WriteError`] that names the file: it cannot be written, or an error of [`mesh_to_bytes`].
pub fn write_mesh(mesh: &TriangleMesh, path: impl AsRef<Path>) -> Result<(), WriteError> {
    written(mesh_to_bytes(mesh), path.as_ref())
}

fn written(bytes: Result<Vec<u8>, UnwritableScene>, path: &Path) -> Result<(), WriteError> {
    let refused = |error| WriteError::new(path, Error::new(ErrorKind::InvalidInput, error));
    write_file(path, &bytes.map_err(refused)?)
}
