//! Rigs: a JSON file of bones with a PLY mesh and a DMAT table of skin weights.
//!
//! - `model.file`, `weights.file`: paths relative to the JSON file; both optional. A missing weights file is a
//!   [note](RigNote), as bones and keyframes do not need it.
//! - `bones`: parents before children. A bone has `parent_id` (−1 for a root), `weight_id` (column of the weights
//!   table, −1 for none), `length`, and `rest_T` (rows of a 4×4 matrix: canonical bone → model). Limits `xzx_min` and
//!   `xzx_max` are optional, in degrees; absent or ±1e10 means unbounded.
//! - `fk_animation`, optional: `[{bone_id, keys: [{t, xzx}]}]`, in seconds and degrees.
//! - `ik_constraints`: the bones whose tips are pinned, as an array or one number; the last bone by default. A repeated
//!   bone counts once.
//!
//! kinopt extends the format twice; other programs ignore these keys:
//!
//! - A bone may have a `name`: a non-empty, unique string without slashes (`NAME/tip` is the frame at its tip). By
//!   default bones are `bone/0`, `bone/1`, … by index.
//! - A track of `fk_animation` may have an `interpolation`: `linear`, `catmull-rom` (the default) or
//!   `kochanek-bartels`. Keys of the last may have a `tcb`: `[tension, continuity, bias]`, zeros by default.
//!
//! Other keys are ignored. A tail may be away from its parent's tip: `rest_T` is used unchanged, and the offset rotates
//! with the parent. Degrees occur in the file only; the library uses radians.

mod check;
mod columns;
mod degrees;
mod interpolation;
mod json;
mod masses;
mod names;
mod note;
mod posing;
mod write;

pub use note::RigNote;
pub use posing::RigPosing;

use std::path::Path;

use super::{FileAccess, FileLocation, ReadError, dmat, ply};
use crate::animation::EulerClip;
use crate::skinning::SkinWeights;
use kinopt_kinematics::file_access::below_folder;
use kinopt_kinematics::skeleton::{BoneId, Skeleton};
use kinopt_mesh::mesh::TriangleMesh;

/// A skeleton with its mesh, keyframes and pinned tips.
#[derive(Clone, Debug)]
pub struct Rig {
    /// The skeleton, in the rig's unit.
    pub skeleton: Skeleton,
    /// The mesh at rest.
    pub mesh: Option<TriangleMesh>,
    /// Skin weights: a row per vertex of the mesh, a column per bone of the skeleton.
    pub weights: Option<SkinWeights>,
    /// Keyframes; empty if the file has none.
    pub clip: EulerClip,
    /// Bones whose tips are pinned.
    pub constrained: Vec<BoneId>,
    /// Notes of the reader; ignored by the writer.
    pub notes: Vec<RigNote>,
}

impl Rig {
    /// Reads a rig and the files that it refers to, which must be below its folder.
    ///
    /// # Errors
    /// A [`ReadError`] that names the file and a path in it such as `bones[3].rest_T`.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        Self::read_with(path, &FileAccess::new())
    }

    /// Reads a rig and the files that it refers to, as far as `access` allows.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn read_with(path: impl AsRef<Path>, access: &FileAccess) -> Result<Self, ReadError> {
        let path = path.as_ref();
        let allowed = access.of_file(path);
        access.read_with(path, |json, name| {
            Self::parse_any(json, name, |file| allowed.open(file))
        })
    }

    /// Reads a rig from the bytes of its JSON file. `name` is the file name for messages. `open` returns the contents
    /// of `model.file` and `weights.file`, which are below the JSON file's folder.
    ///
    /// # Errors
    /// As [`read`](Self::read), and the errors of `open`.
    pub fn parse(
        json: &[u8],
        name: &str,
        open: impl FnMut(&str) -> Result<Vec<u8>, ReadError>,
    ) -> Result<Self, ReadError> {
        Self::parse_any(json, name, below_folder(open))
    }

    /// As [`parse`](Self::parse), but `open` also gets references outside the folder.
    fn parse_any(
        json: &[u8],
        name: &str,
        mut open: impl FnMut(&str) -> Result<Vec<u8>, ReadError>,
    ) -> Result<Self, ReadError> {
        let file: json::RigFile = kinopt_mesh::json::parse(json, name)?;
        let skeleton = check::skeleton(&file, name)?;
        let clip = check::clip(&file, &skeleton, name)?;
        let constrained = check::constrained(&file, &skeleton, name)?;

        let referred =
            |path: &str, error| ReadError::referred(name, FileLocation::Json(path.into()), error);
        let mut mesh = None;
        if let Some(part) = &file.model {
            let parse = |bytes: Vec<u8>| ply::from_bytes(&bytes, &part.file);
            let read = open(&part.file)
                .and_then(|bytes| parse(bytes).map_err(ReadError::without_contents));
            mesh = Some(read.map_err(|error| referred("model.file", error))?);
        }
        let (mut weights, mut notes) = (None, Vec::new());
        if let Some(part) = &file.weights {
            match open(&part.file) {
                Err(error) if error.is_missing() => {
                    let file = part.file.clone();
                    notes.push(RigNote::NoWeightsFile { file });
                }
                bytes => {
                    let parse = |bytes: Vec<u8>| dmat::from_bytes(&bytes, &part.file);
                    let read =
                        bytes.and_then(|bytes| parse(bytes).map_err(ReadError::without_contents));
                    let table = read.map_err(|error| referred("weights.file", error))?;
                    weights = Some(columns::weights(&file, &table, mesh.as_ref(), name)?);
                }
            }
        }
        Ok(Self {
            skeleton,
            mesh,
            weights,
            clip,
            constrained,
            notes,
        })
    }
}
