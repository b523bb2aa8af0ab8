//! What `--out` writes: the mesh in the pose found, or of motion capture the pose itself.

use std::path::{Path, PathBuf};

use kinopt::io::bvh;
use kinopt::skinning::SkinningMethod;

use crate::animated_armature::extension;
use crate::ball_figure::PoseBridge;
use crate::failure::Outcome;
use crate::loaded_model::{Capture, LoadedModel};
use crate::mesh_output::{MeshFile, Skin};
use crate::weights_choice::WeightsChoice;

/// A file for what was found.
#[derive(Clone, Debug)]
pub(super) enum OutFile {
    Mesh(MeshFile),
    Capture(PathBuf),
}

/// What goes into the file, made ready before the search.
pub(super) enum Written<'a> {
    Mesh(&'a MeshFile, Box<Skin<'a>>),
    Capture(&'a Path, &'a Capture, PoseBridge),
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

    /// What the model has for this file.
    ///
    /// # Errors
    /// A model without a mesh, or that is no motion capture.
    pub(super) fn of<'a>(
        &'a self,
        loaded: &'a LoadedModel,
        weights: Option<WeightsChoice>,
    ) -> Outcome<Written<'a>> {
        let capture = loaded.capture.as_ref();
        let bridge = capture.and_then(|own| PoseBridge::of(loaded, &own.armature));
        match (self, capture, bridge) {
            (Self::Mesh(file), ..) => Ok(Written::Mesh(file, Box::new(loaded.skin(weights)?))),
            (Self::Capture(path), Some(capture), Some(bridge)) => {
                Ok(Written::Capture(path, capture, bridge))
            }
            (Self::Capture(_), ..) => Err(usage!(
                "{}: a .bvh is written of motion capture; this is a {}",
                loaded.file,
                loaded.kind()
            )),
        }
    }
}

impl Written<'_> {
    /// What was made up, if anything.
    pub(super) fn note(&self) -> Option<String> {
        match self {
            Self::Mesh(_, skin) => skin.note(),
            Self::Capture(..) => None,
        }
    }

    /// Writes it for a configuration; where.
    pub(super) fn write(&self, q: &[f64], method: SkinningMethod) -> Outcome<&Path> {
        match self {
            Self::Mesh(file, skin) => {
                file.write(&skin.posed(q, method)?)?;
                Ok(file.path())
            }
            Self::Capture(path, capture, bridge) => {
                let mut pose = capture.armature.rest().clone();
                bridge.pose_of(q, &mut pose);
                let rate = 1.0 / capture.frame_time;
                bvh::write_poses(&capture.armature, &[pose], rate, path)?;
                Ok(path)
            }
        }
    }
}
