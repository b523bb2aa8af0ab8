//! Animations of figures: .bvh and .glb.

use std::path::Path;

use kinopt::animation::Armature;
use kinopt::io::bvh::{self, BvhChannel, BvhFormat};
use kinopt::io::gltf::{self, Scene, SceneError, SceneFile, UnwritableScene, WriteOptions};
use kinopt::io::{FormatError, WriteError};
use kinopt::mesh::TriangleMesh;
use kinopt::motion::retarget::{FigureTarget, RetargetError, UpAxis};
use kinopt::skeleton::Skeleton;
use kinopt::skinning::{SkinWeights, SkinningError};
use kinopt::spatial::{Placement, Vector3};

use super::TrajectoryFormat;
use crate::{Classify, ErrorKind};

/// Number of influences per vertex that all glTF readers support.
const INFLUENCES: usize = 4;

/// File of a figure, whose content its animations have.
#[derive(Clone, Copy, Debug)]
pub enum FigureFile<'a> {
    /// A glTF file with all its content.
    SceneFile(&'a SceneFile),
    /// A glTF scene without materials.
    Scene(&'a Scene),
    /// A motion capture: its bones with their channels, and a skeleton of the bones.
    Capture {
        /// The bones.
        armature: &'a Armature,
        /// Channels of each bone.
        channels: &'a [Vec<BvhChannel>],
        /// The same bones as a skeleton.
        skeleton: &'a Skeleton,
    },
    /// A skeleton, with its skin if it has one.
    Skeleton {
        /// The bones.
        skeleton: &'a Skeleton,
        /// The mesh with the skin weights.
        skin: Option<(&'a TriangleMesh, &'a SkinWeights)>,
    },
}

/// An animation that could not be written.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
#[non_exhaustive]
pub enum FigureFileError {
    /// Configurations of another figure.
    Figure(#[from] RetargetError),
    /// Bones or poses outside the range of BVH.
    Format(#[from] FormatError),
    /// A scene that glTF cannot represent.
    Scene(#[from] SceneError),
    /// A clip that glTF cannot represent.
    Clip(#[from] UnwritableScene),
    /// Invalid skin weights.
    Skinning(#[from] SkinningError),
    /// A file that cannot be written.
    Write(#[from] WriteError),
}

impl Classify for FigureFileError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Figure(error) => error.kind(),
            Self::Format(error) => error.kind(),
            Self::Scene(error) => error.kind(),
            Self::Clip(error) => error.kind(),
            Self::Skinning(error) => error.kind(),
            Self::Write(error) => error.kind(),
        }
    }
}

/// Writes the motion of a figure as .bvh, or as .glb with the content of the figure's file. `q` has one configuration
/// after another, at `frame_rate` samples per second. `name` names the clip of a .glb file. The file appears once it is
/// complete.
///
/// # Errors
/// [`FigureFileError`], for example for configurations of another figure.
pub fn write_figure(
    figure: &FigureTarget,
    file: FigureFile<'_>,
    (q, frame_rate): (&[f64], f64),
    name: &str,
    (format, path): (TrajectoryFormat, &Path),
) -> Result<(), FigureFileError> {
    match format {
        TrajectoryFormat::Bvh => write_bvh(figure, file, (q, frame_rate), path),
        _ => write_glb(figure, file, (q, frame_rate), name, path),
    }
}

fn write_bvh(
    figure: &FigureTarget,
    file: FigureFile<'_>,
    (q, frame_rate): (&[f64], f64),
    path: &Path,
) -> Result<(), FigureFileError> {
    let write = |figure: &FigureTarget, armature: &Armature, format: BvhFormat<'_>| {
        let poses = figure.poses(armature, armature.rest(), q)?;
        Ok(bvh::write_poses(armature, &poses, format, path)?)
    };
    let format = BvhFormat::from(frame_rate);
    match file {
        FigureFile::SceneFile(file) => write(figure, &file.scene().armature, format),
        FigureFile::Scene(scene) => write(figure, &scene.armature, format),
        FigureFile::Capture {
            armature, channels, ..
        } => write(figure, armature, format.with_channels(channels)),
        // With y up, as readers of BVH files expect.
        FigureFile::Skeleton { skeleton, .. } => {
            let y_from_z = UpAxis::Y.turned_to_z().transpose();
            let turn = Placement::new(y_from_z * figure.up().turned_to_z(), Vector3::zero());
            let upright = skeleton.placed(turn).map_err(RetargetError::from)?;
            let figure = FigureTarget::new(&upright, UpAxis::Y)?;
            write(&figure, &Armature::of_skeleton(&upright), format)
        }
    }
}

fn write_glb(
    figure: &FigureTarget,
    file: FigureFile<'_>,
    (q, frame_rate): (&[f64], f64),
    name: &str,
    path: &Path,
) -> Result<(), FigureFileError> {
    let mut scene = match file {
        FigureFile::SceneFile(file) => {
            let scene = file.scene();
            let clip = figure.clip(name, &scene.armature, q, frame_rate)?;
            let is_taken = scene.clips.iter().any(|known| known.name() == name);
            let clip = match is_taken {
                true => clip.renamed(format!("{name} retargeted")),
                false => clip,
            };
            let mut file = file.clone();
            file.add_clip(&clip, &WriteOptions::default())?;
            return Ok(file.write(path)?);
        }
        FigureFile::Scene(scene) => scene.clone(),
        FigureFile::Capture { skeleton, .. } => Scene::of_skeleton(skeleton, None)?,
        FigureFile::Skeleton { skeleton, skin } => match skin {
            Some((mesh, weights)) => {
                let (weights, _) = weights.pruned(INFLUENCES)?;
                Scene::of_skeleton(skeleton, Some((mesh, &weights)))?
            }
            None => Scene::of_skeleton(skeleton, None)?,
        },
    };
    let clip = figure.clip(name, &scene.armature, q, frame_rate)?;
    scene.clips.push(clip);
    let mut options = WriteOptions::default();
    options.up = figure.up().into();
    Ok(gltf::write(&scene, &options, path)?)
}
