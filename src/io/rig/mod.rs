//! Rigs: a JSON file of bones that names a PLY mesh and a DMAT table of skin weights.
//!
//! - `model.file`, `weights.file`: relative to the JSON file; each may be absent. Weights that are named
//!   but do not exist are a [note](RigNote): bones and keyframes do not need them.
//! - `bones`: parents before children. A bone has `parent_id` (−1 for a root), `weight_id` (its
//!   column in the weights' table, −1 for none), `length`, `rest_T` (4×4 rows: canonical bone →
//!   model) and optionally `xzx_min` and `xzx_max` in degrees; absent or ±1e10 means unbounded.
//! - `fk_animation`, optional: `[{bone_id, keys: [{t, xzx}]}]`, seconds and degrees.
//! - `ik_constraints`: the bones whose tips are pinned: an array, one number, or absent for the
//!   last bone. A bone named twice counts once.
//!
//! Two things are extensions of ours; programs that do not know them skip the keys.
//!
//! - A bone may have a `name`, a string that is not empty, unique and free of slashes (`NAME/tip` is
//!   the frame at its tip). A bone without one is called `bone/0`, `bone/1`, … after its place in
//!   the list.
//! - A track of `fk_animation` may have an `interpolation`: `linear`, `catmull-rom` (as without one) or
//!   `kochanek-bartels`, whose keys may have a `tcb`: `[tension, continuity, bias]`, zeros without
//!   it.
//!
//! Other keys are ignored. A tail need not be on its parent's tip: `rest_T` is taken as it is, and
//! the offset between them turns with the parent.
//!
//! Degrees exist only here: everything that comes out is in radians.

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
pub use posing::{RigPosing, RigPosingError};

use std::path::Path;

use super::{FileAccess, Place, ReadError, dmat, ply};
use crate::animation::EulerClip;
use crate::file_access::below_folder;
use crate::mesh::TriangleMesh;
use crate::skeleton::{BoneId, Skeleton};
use crate::skinning::SkinWeights;

/// A skeleton with the mesh it moves, its keyframes and its pinned tips.
#[derive(Clone, Debug)]
pub struct Rig {
    /// The bones, in the rig's own unit.
    pub skeleton: Skeleton,
    /// The mesh at rest.
    pub mesh: Option<TriangleMesh>,
    /// A row for each vertex of the mesh, a column for each bone of the skeleton.
    pub weights: Option<SkinWeights>,
    /// The keyframes; empty when the file has none.
    pub clip: EulerClip,
    /// The bones whose tips are pinned.
    pub constrained: Vec<BoneId>,
    /// What reading did without; not looked at by writing.
    pub notes: Vec<RigNote>,
}

impl Rig {
    /// Reads a rig and the files it names, which must be below its folder.
    ///
    /// # Errors
    /// A [`ReadError`] naming the file and a path in it such as `bones[3].rest_T`.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        Self::read_with(path, &FileAccess::new())
    }

    /// Reads a rig and the files it names, as far as `access` allows.
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

    /// Reads a rig from the bytes of its JSON file; `name` is for messages. `open` gets the
    /// contents of `model.file` and `weights.file`, if those lead below the JSON file's folder.
    ///
    /// # Errors
    /// As [`read`](Self::read), and whatever `open` fails with.
    pub fn parse(
        json: &[u8],
        name: &str,
        open: impl FnMut(&str) -> Result<Vec<u8>, ReadError>,
    ) -> Result<Self, ReadError> {
        Self::parse_any(json, name, below_folder(open))
    }

    /// As [`parse`](Self::parse), with any reference given to `open`.
    fn parse_any(
        json: &[u8],
        name: &str,
        mut open: impl FnMut(&str) -> Result<Vec<u8>, ReadError>,
    ) -> Result<Self, ReadError> {
        let file: json::RigFile = super::json::parse(json, name)?;
        let skeleton = check::skeleton(&file, name)?;
        let clip = check::clip(&file, &skeleton, name)?;
        let constrained = check::constrained(&file, &skeleton, name)?;

        let referred =
            |place: &str, error| ReadError::referred(name, Place::Json(place.into()), error);
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
