//! Output of the mesh in a pose.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use clap::builder::PossibleValue;
use kinopt::io::gltf::{Scene, ScenePosing};
use kinopt::io::ply::PlyEncoding;
use kinopt::io::{gltf, obj, ply};
use kinopt::mesh::TriangleMesh;
use kinopt::skeleton::{BallSkeleton, Skeleton};
use kinopt::skinning::{MeshWeights, SkinWeights, SkinningMethod, single_precision_transform};
use kinopt_bindings::problem_file::WeightsChoice;

use crate::animated_armature::extension;
use crate::ball_figure::FigurePosing;
use crate::failure::{Failure, Outcome};
use crate::loaded_model::{LoadedModel, LoadedScene};
use crate::output;
use crate::scene_output::write_posed;

/// Path and format of `--out`.
#[derive(Clone, Debug)]
pub(crate) struct MeshFile {
    path: PathBuf,
    format: MeshFormat,
}

/// Format of mesh files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum MeshFormat {
    /// Wavefront OBJ, text.
    Obj,
    /// Stanford PLY, little-endian binary.
    Ply,
    /// glTF 2.0, binary.
    Glb,
}

impl MeshFormat {
    /// Format of a path's extension.
    pub(crate) fn of(path: &Path) -> Option<Self> {
        Self::from_str(&extension(path), false).ok()
    }
}

impl MeshFile {
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let path = PathBuf::from(text);
        let format = MeshFormat::of(&path).ok_or("meshes are written as .obj, .ply or .glb")?;
        Ok(Self { path, format })
    }

    /// File in a folder, with the extension of its format.
    pub(crate) fn within(folder: &Path, stem: &str, format: MeshFormat) -> Self {
        let extension = format.to_possible_value();
        let extension = extension.as_ref().map_or("", PossibleValue::get_name);
        let path = folder.join(format!("{stem}.{extension}"));
        Self { path, format }
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn write(&self, mesh: &TriangleMesh) -> Outcome<()> {
        match self.format {
            MeshFormat::Obj => obj::write(mesh, &self.path)?,
            MeshFormat::Ply => ply::write(mesh, PlyEncoding::BinaryLittleEndian, &self.path)?,
            MeshFormat::Glb => gltf::write_mesh(mesh, &self.path)?,
        }
        Ok(())
    }
}

/// Mesh of a skeleton or a scene.
#[derive(Clone, Debug)]
pub(crate) enum Skin<'a> {
    Rig {
        skeleton: &'a Skeleton,
        /// The same bones on ball joints, if selected.
        balls: Option<&'a BallSkeleton>,
        mesh: &'a TriangleMesh,
        weights: Box<SkinWeights>,
        /// The weights in the layout for posing.
        mesh_weights: Box<MeshWeights>,
        /// Note about computed weights, if any.
        note: Option<String>,
    },
    Scene {
        scene: &'a LoadedScene,
        bridge: FigurePosing,
    },
}

impl LoadedModel {
    /// Mesh of the model with its skin weights. Weights are computed if the rig has none or `choice` is given; a note
    /// says so.
    pub(crate) fn skin(&self, choice: Option<WeightsChoice>) -> Outcome<Skin<'_>> {
        let (file, kind) = (&self.file, self.kind());
        let lacks = || lacks_mesh(file, kind);
        let rig = self.rig.as_ref().ok_or_else(lacks)?;
        if let Some(scene) = self.scene.as_deref() {
            let meshes = with_meshes(Some(scene.file.scene()), (file, kind), choice)?;
            let bridge = FigurePosing::of(self, &meshes.armature).ok_or_else(lacks)?;
            return Ok(Skin::Scene { scene, bridge });
        }
        let mesh = rig.mesh.as_ref().ok_or_else(lacks)?;
        let (weights, note) = match (&rig.weights, choice) {
            (Some(weights), None) => (weights.clone(), None),
            (given, choice) => {
                let choice = choice.unwrap_or_default();
                let weights = choice.weights(mesh, &rig.skeleton).map_err(|error| {
                    failure!("{file}: skin weights cannot be computed: {error}")
                })?;
                let why = match given {
                    Some(_) => "the skin weights of the file are ignored",
                    None => "there are no skin weights",
                };
                let note = format!("{why}: each vertex follows {}", choice.rule());
                output::message(&format!("{file}: {note}"));
                (weights, Some(note))
            }
        };
        Ok(Skin::Rig {
            skeleton: &rig.skeleton,
            balls: self.balls.as_deref(),
            mesh,
            mesh_weights: Box::new(weights.clone().into()),
            weights: Box::new(weights),
            note,
        })
    }
}

/// Scene with meshes and their own weights.
pub(crate) fn with_meshes<'s>(
    scene: Option<&'s Scene>,
    (file, kind): (&str, &str),
    choice: Option<WeightsChoice>,
) -> Outcome<&'s Scene> {
    if choice.is_some() {
        let problem = format!("{file}: --skin-weights is for rigs; a {kind} has its own");
        return Err(Failure::usage(problem));
    }
    let scene = scene.filter(|scene| !scene.meshes.is_empty());
    scene.ok_or_else(|| lacks_mesh(file, kind))
}

fn lacks_mesh(file: &str, kind: &str) -> Failure {
    failure!("{file}: --out needs a mesh, and the {kind} has none")
}

impl Skin<'_> {
    /// Note about computed weights, if any.
    pub(crate) fn note(&self) -> Option<String> {
        match self {
            Self::Rig { note, .. } => note.clone(),
            Self::Scene { .. } => None,
        }
    }

    /// Mesh in a configuration: angles of bones in radians, or quaternions of ball joints.
    pub(crate) fn posed(&self, q: &[f64], method: SkinningMethod) -> Outcome<TriangleMesh> {
        match self {
            Self::Rig {
                skeleton,
                balls,
                mesh,
                mesh_weights,
                ..
            } => {
                let pose = match balls {
                    Some(balls) => balls.pose(q)?,
                    None => skeleton.pose(q)?,
                };
                let transforms = pose.skinning_transforms(skeleton);
                let transforms = transforms.map(|t| single_precision_transform(&t));
                let transforms: Vec<_> = transforms.collect();
                Ok(mesh_weights.mesh(method, mesh, &transforms)?)
            }
            Self::Scene { scene, bridge } => {
                let pose = scene.pose(bridge, q)?;
                Ok(ScenePosing::new(scene.file.scene(), method)?.mesh(&pose)?)
            }
        }
    }

    /// Writes the mesh in a configuration. A scene written as glTF keeps all content of its file.
    pub(crate) fn write(&self, q: &[f64], method: SkinningMethod, to: &MeshFile) -> Outcome<()> {
        match self {
            Self::Scene { scene, bridge } if to.format == MeshFormat::Glb => {
                let pose = scene.pose(bridge, q)?;
                write_posed(&scene.file, &pose, method, to.path())
            }
            _ => to.write(&self.posed(q, method)?),
        }
    }
}
