//! Writing scenes and posed meshes as `.glb` files.

mod animations;
mod buffer;
mod keys;
mod meshes;

use std::io::{Error, ErrorKind};
use std::path::Path;

use ::gltf::json;
use ::gltf::json::Index;

use self::buffer::Document;
use super::scene::{Scene, SceneError, SceneMesh};
use crate::animation::{Armature, ArmatureBone, LocalTransform, SizeMismatch};
use crate::io::{WriteError, write_bytes};
use crate::mesh::TriangleMesh;
use crate::skeleton::BoneId;
use crate::skinning::MorphTargets;

/// How scenes are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WriteOptions {
    /// How many keys a second stand for a curve that glTF does not have: eased and Bézier curves,
    /// squad, Hermite rotations, Euler angles, and morph weights that are not keyed together. They
    /// become lines through these and the curve's own keys.
    pub keys_per_second: f32,
}

impl Default for WriteOptions {
    /// 30 keys a second.
    fn default() -> Self {
        Self {
            keys_per_second: 30.0,
        }
    }
}

/// Why a scene cannot be written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum UnwritableScene {
    /// The parts of a mesh do not go together.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A clip of another armature.
    #[error("clip `{clip}`: {problem}")]
    Clip {
        /// The clip.
        clip: String,
        /// How it differs.
        problem: SizeMismatch,
    },
    /// A mesh without vertices or triangles, which glTF does not have.
    #[error("mesh `{mesh}`: there are no {what}")]
    Empty {
        /// The mesh.
        mesh: String,
        /// Vertices or triangles.
        what: &'static str,
    },
    /// Two meshes hang on one bone, which glTF does not have.
    #[error("bone `{bone}` has two meshes; join them, or give one a bone of its own")]
    TwoMeshes {
        /// The bone.
        bone: String,
    },
    /// More joints than vertices can tell apart.
    #[error("mesh `{mesh}`: {joints} joints, where there are numbers for 65536")]
    TooManyJoints {
        /// The mesh.
        mesh: String,
        /// How many joints it has.
        joints: usize,
    },
    /// A number of keys a second that is none.
    #[error("{0} keys a second; it must be a finite number above 0")]
    BadRate(f32),
    /// A curve so long that it would take more keys than anyone wants.
    #[error("a curve would take {samples} keys; ask for fewer a second")]
    TooManySamples {
        /// How many.
        samples: f64,
    },
    /// GLB counts bytes with 32 bits.
    #[error("the file would take {bytes} bytes, beyond the 4 GiB that GLB can have")]
    TooLong {
        /// How many.
        bytes: usize,
    },
    /// The document cannot be put into words.
    #[error("{0}")]
    Document(String),
}

/// The bytes of a `.glb` file of a scene. [Reading](super::from_bytes) them gives the scene again to
/// the bit of single precision, in the order of the bones, with these exceptions:
///
/// - Weights are written in single precision.
/// - Curves that glTF does not have are [sampled](WriteOptions::keys_per_second).
/// - A clip that starts before 0 s is moved there, as glTF has no times before it. One that lasts
///   beyond its keys does so by a bone that keeps its place; one that is shorter than its keys
///   gets their span.
/// - Events are left out, and morph targets are called as in the armature.
///
/// # Errors
/// An [`UnwritableScene`] naming the mesh, bone or clip.
pub fn to_bytes(scene: &Scene, options: &WriteOptions) -> Result<Vec<u8>, UnwritableScene> {
    let rate = options.keys_per_second;
    if !(rate.is_finite() && rate > 0.0) {
        return Err(UnwritableScene::BadRate(rate));
    }
    for mesh in &scene.meshes {
        mesh.check(&scene.armature)?;
    }
    let mut document = Document::new();
    document.root.nodes = meshes::nodes(&scene.armature);
    let bones = (0..scene.armature.bones()).map(BoneId::new);
    let roots = bones.filter(|bone| scene.armature.parent(*bone).is_none());
    let roots: Vec<_> = roots.map(|bone| Index::new(bone.index() as u32)).collect();
    if !roots.is_empty() {
        let shown = document.root.push(json::Scene {
            extensions: None,
            extras: None,
            name: None,
            nodes: roots,
        });
        document.root.scene = Some(shown);
    }
    meshes::add(scene, &mut document)?;
    for clip in &scene.clips {
        animations::add(scene, clip, rate, &mut document)?;
    }
    document.finish()
}

/// Writes [`to_bytes`] to a file, which should end in `.glb`.
///
/// # Errors
/// A [`WriteError`] naming the file: it cannot be written, or as [`to_bytes`].
pub fn write(
    scene: &Scene,
    options: &WriteOptions,
    path: impl AsRef<Path>,
) -> Result<(), WriteError> {
    written(to_bytes(scene, options), path.as_ref())
}

/// The bytes of a `.glb` file of a mesh that does not move, such as a posed one.
///
/// # Errors
/// The mesh has no vertices or no triangles, or takes 4 GiB.
pub fn mesh_to_bytes(mesh: &TriangleMesh) -> Result<Vec<u8>, UnwritableScene> {
    let document = |error: String| UnwritableScene::Document(error);
    let bone = ArmatureBone {
        name: "mesh".into(),
        parent: None,
        rest: LocalTransform::IDENTITY,
    };
    let armature = Armature::new(vec![bone], Vec::new());
    let targets = MorphTargets::new(mesh.positions().len(), Vec::new());
    let scene = Scene {
        armature: armature.map_err(|error| document(error.to_string()))?,
        meshes: vec![SceneMesh {
            name: "mesh".into(),
            bone: BoneId::new(0),
            mesh: mesh.clone(),
            tangents: Vec::new(),
            morph_targets: targets.map_err(|error| document(error.to_string()))?,
            first_morph_weight: 0,
            skin: None,
        }],
        clips: Vec::new(),
        notes: Vec::new(),
    };
    to_bytes(&scene, &WriteOptions::default())
}

/// Writes [`mesh_to_bytes`] to a file, which should end in `.glb`.
///
/// # Errors
/// A [`WriteError`] naming the file: it cannot be written, or as [`mesh_to_bytes`].
pub fn write_mesh(mesh: &TriangleMesh, path: impl AsRef<Path>) -> Result<(), WriteError> {
    written(mesh_to_bytes(mesh), path.as_ref())
}

fn written(bytes: Result<Vec<u8>, UnwritableScene>, path: &Path) -> Result<(), WriteError> {
    let bytes = bytes.map_err(|error| WriteError {
        file: path.display().to_string(),
        problem: Error::new(ErrorKind::InvalidInput, error),
    })?;
    write_bytes(path, &bytes)
}
