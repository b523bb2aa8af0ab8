//! Output of `--out` and `--into`: the mesh in the solved pose, or the pose itself in a motion capture or scene file.

use std::path::{Path, PathBuf};

use clap::Args;
use kinopt::animation::Clip;
use kinopt::io::bvh::{self, BvhFormat};
use kinopt::skinning::SkinningMethod;
use kinopt_bindings::problem_file::WeightsChoice;

use crate::animated_armature::extension;
use crate::ball_figure::FigurePosing;
use crate::failure::Outcome;
use crate::help_headings::OUTPUT;
use crate::loaded_model::{Capture, LoadedModel, LoadedScene};
use crate::mesh_output::{MeshFile, Skin};
use crate::scene_output;

/// Output file of a solution.
#[derive(Clone, Debug)]
pub(super) enum OutFile {
    Mesh(MeshFile),
    Capture(PathBuf),
}

/// Files of a solved pose.
#[derive(Args, Debug)]
pub(super) struct OutputFiles {
    /// Write the posed mesh (.obj, .ply, .glb), or a capture's pose (.bvh).
    #[arg(long, value_name = "FILE", value_parser = OutFile::parse, help_heading = OUTPUT)]
    pub(super) out: Option<OutFile>,

    /// Add the pose as a clip to a .glb or .gltf, or to a copy of the model's file.
    #[arg(long, value_name = "FILE", conflicts_with = "out", help_heading = OUTPUT)]
    pub(super) into: Option<PathBuf>,
}

/// Content of the output file, prepared before the search.
pub(super) enum Written<'a> {
    Mesh(&'a MeshFile, Box<Skin<'a>>),
    Capture(&'a Path, &'a Capture, FigurePosing),
    Clip(&'a Path, &'a str, &'a LoadedScene, FigurePosing),
}

/// Clip that `--into` adds to a file.
///
/// # Errors
/// A model that is no scene.
pub(super) fn added<'a>(
    into: &'a Path,
    name: Option<&'a str>,
    loaded: &'a LoadedModel,
) -> Outcome<Written<'a>> {
    let scene = loaded.scene.as_deref();
    let bridge = scene.and_then(|scene| FigurePosing::of(loaded, &scene.file.scene().armature));
    let both = scene.zip(bridge);
    let (scene, bridge) = both.ok_or_else(|| {
        usage!(
            "{}: --into needs a scene; this is a {}",
            loaded.file,
            loaded.kind()
        )
    })?;
    Ok(Written::Clip(into, name.unwrap_or("pose"), scene, bridge))
}

impl OutFile {
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let path = PathBuf::from(text);
        match extension(&path) == "bvh" {
            true => Ok(Self::Capture(path)),
            false => MeshFile::parse(text)
                .map(Self::Mesh)
                .map_err(|problem| format!("{problem}, poses of motion capture as .bvh")),
        }
    }

    /// Content of this file from the model.
    ///
    /// # Errors
    /// A model without a mesh for a mesh file, or a .bvh file for a model that is no motion capture.
    pub(super) fn of<'a>(
        &'a self,
        loaded: &'a LoadedModel,
        weights: Option<WeightsChoice>,
    ) -> Outcome<Written<'a>> {
        let capture = loaded.capture.as_ref();
        let bridge = capture.and_then(|capture| FigurePosing::of(loaded, &capture.armature));
        match (self, capture, bridge) {
            (Self::Mesh(file), ..) => Ok(Written::Mesh(file, Box::new(loaded.skin(weights)?))),
            (Self::Capture(path), Some(capture), Some(bridge)) => {
                Ok(Written::Capture(path, capture, bridge))
            }
            (Self::Capture(_), ..) => Err(usage!(
                "{}: --out FILE.bvh needs motion capture; this is a {}",
                loaded.file,
                loaded.kind()
            )),
        }
    }
}

impl Written<'_> {
    /// Note about computed skin weights, if any.
    pub(super) fn note(&self) -> Option<String> {
        match self {
            Self::Mesh(_, skin) => skin.note(),
            Self::Capture(..) | Self::Clip(..) => None,
        }
    }

    /// Writes the file for a configuration. Returns its path.
    pub(super) fn write(&self, q: &[f64], method: SkinningMethod) -> Outcome<&Path> {
        match self {
            Self::Mesh(file, skin) => {
                skin.write(q, method, file)?;
                Ok(file.path())
            }
            Self::Capture(path, capture, bridge) => {
                let mut pose = capture.armature.rest().clone();
                bridge.pose_of(q, &mut pose)?;
                let format = BvhFormat::of_frame_time(capture.frame_time);
                let format = format.with_channels(&capture.channels);
                bvh::write_poses(&capture.armature, &[pose], format, path)?;
                Ok(path)
            }
            Self::Clip(path, name, scene, bridge) => {
                let pose = scene.pose(bridge, q)?;
                let armature = &scene.file.scene().armature;
                let clip = Clip::through_poses(*name, armature, &[0.0], &[pose])?;
                let file = scene_output::file_to_add_to(&scene.file, path)?;
                scene_output::write_with_clip(file, clip, Some(name), name, path)?;
                Ok(path)
            }
        }
    }
}
