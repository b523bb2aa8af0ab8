//! Writing of rigs: the JSON file, the mesh and the weights.

use std::io::{Error, ErrorKind};
use std::path::Path;

use nalgebra::DMatrix;
use serde::Serialize;

use super::Rig;
use super::json::{BoneEntry, KeyEntry, PartFile, TrackEntry};
use super::names;
use super::{degrees, interpolation};
use crate::dmat::{self, DmatEncoding};
use crate::io::{WriteError, write_files};
use crate::model::Limits;
use crate::ply::{self, PlyEncoding};
use crate::skeleton::Bone;
use crate::skinning::SkinWeights;

impl Rig {
    /// Writes the rig to `path`. The mesh and the weights go to the same folder and name with the extensions `ply` and
    /// `dmat` (both binary). All files are complete before the first is replaced.
    ///
    /// Reading the files gives exactly the same rig, except for angles that no number of degrees converts to; these are
    /// off by rounding.
    ///
    /// # Errors
    /// A [`WriteError`] that names the file: it cannot be written, or `path` ends in `.ply` or `.dmat` or is not
    /// Unicode. Also a bone name that the format does not allow (see the [module](super)), or weights for a different
    /// number of vertices or bones.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), WriteError> {
        let path = path.as_ref();
        let invalid_input = |problem: &str| {
            let problem = Error::new(ErrorKind::InvalidInput, problem);
            Err(WriteError::new(path, problem))
        };
        let (mesh_path, weights_path) = (path.with_extension("ply"), path.with_extension("dmat"));
        if path == mesh_path || path == weights_path {
            return invalid_input("a rig file may not end in .ply or .dmat");
        }
        if let Some(weights) = &self.weights {
            let bones = self.skeleton.bones().len();
            let vertices = self.mesh.as_ref().map(|mesh| mesh.positions().len());
            if weights.bone_count() != bones
                || vertices.is_some_and(|n| n != weights.vertex_count())
            {
                return invalid_input("its weights are for another number of vertices or bones");
            }
        }
        for (index, bone) in self.skeleton.bones().iter().enumerate() {
            if let Some(problem) = names::problem(&bone.name, index) {
                return invalid_input(&format!("bone {index}: {problem}"));
            }
        }
        let file_name = |path: &Path| Some(path.file_name()?.to_str()?.to_owned());
        let (Some(mesh_name), Some(weights_name)) =
            (file_name(&mesh_path), file_name(&weights_path))
        else {
            return invalid_input("its name is not Unicode");
        };
        let json = self.to_json(&mesh_name, &weights_name);
        let mesh =
            (self.mesh.as_ref()).map(|mesh| ply::to_bytes(mesh, PlyEncoding::BinaryLittleEndian));
        let weights = (self.weights.as_ref())
            .map(|weights| dmat::to_bytes(&columns(weights).1, DmatEncoding::Binary));
        let mesh = mesh.as_deref().map(|bytes| (mesh_path.as_path(), bytes));
        let weights = weights
            .as_deref()
            .map(|bytes| (weights_path.as_path(), bytes));
        // The JSON comes last, as it refers to the others.
        let files = mesh.into_iter().chain(weights);
        let files: Vec<_> = files.chain([(path, json.as_bytes())]).collect();
        write_files(&files)
    }

    /// The rig as JSON, one line per bone or track. A mesh and weights are referred to by the given names.
    /// [`Rig::weights_table`] is the table for `weights_file`.
    #[must_use]
    pub fn to_json(&self, model_file: &str, weights_file: &str) -> String {
        let ids = match &self.weights {
            Some(weights) => columns(weights).0,
            None => vec![-1; self.skeleton.bones().len()],
        };
        let bones = self.skeleton.bones().iter().zip(ids).enumerate();
        let bones = bones.map(|(index, (bone, id))| line(&bone_entry(index, bone, id)));
        let tracks = self.clip.tracks().iter().map(|track| {
            let mut entry = TrackEntry {
                bone_id: track.bone.index() as i64,
                interpolation: None,
                keys: track.keys.iter().map(key_entry).collect(),
            };
            interpolation::write(self.clip.interpolation(track.bone), &mut entry);
            line(&entry)
        });
        let part = |key: &str, file: &str| {
            let file = file.to_owned();
            format!("\"{key}\":{},\n", line(&PartFile { file }))
        };
        let model = self.mesh.as_ref().map(|_| part("model", model_file));
        let weights = self.weights.as_ref().map(|_| part("weights", weights_file));
        let constrained: Vec<usize> = self.constrained.iter().map(|bone| bone.index()).collect();
        format!(
            "{{\n{}{}\"ik_constraints\":{},\n\"fk_animation\":[{}],\n\"bones\":[{}]\n}}\n",
            model.unwrap_or_default(),
            weights.unwrap_or_default(),
            line(&constrained),
            tracks.collect::<Vec<_>>().join(",\n"),
            bones.collect::<Vec<_>>().join(",\n"),
        )
    }

    /// The weights table for [`to_json`](Self::to_json): a row per vertex, a column for each bone with weights.
    #[must_use]
    pub fn weights_table(&self) -> Option<DMatrix<f64>> {
        self.weights.as_ref().map(|weights| columns(weights).1)
    }
}

/// The column of each bone (−1 for a bone without weights), and the table of these columns.
fn columns(weights: &SkinWeights) -> (Vec<i64>, DMatrix<f64>) {
    let mut ids = vec![-1; weights.bone_count()];
    for influence in weights.iter().flatten() {
        if let Some(id) = ids.get_mut(influence.bone as usize) {
            *id = 0;
        }
    }
    let mut weighted_bones = Vec::new();
    for (bone, id) in ids.iter_mut().enumerate().filter(|(_, id)| **id == 0) {
        *id = weighted_bones.len() as i64;
        weighted_bones.push(bone);
    }
    (ids, weights.to_table().select_columns(&weighted_bones))
}

/// Serialises a value to one line. Strings, numbers and arrays of them always serialise.
fn line(value: &impl Serialize) -> String {
    serde_json::to_string(value).unwrap_or_default()
}

fn bone_entry(index: usize, bone: &Bone, weight_id: i64) -> BoneEntry {
    let rest = &bone.model_from_rest;
    let (r, t) = (rest.rotation, rest.translation);
    let end = |end: fn(&Limits) -> f64| {
        let limits = bone.limits.iter();
        Some(
            limits
                .map(|limits| degrees::from_limit(end(limits)))
                .collect(),
        )
    };
    BoneEntry {
        name: (bone.name != names::default_name(index)).then(|| bone.name.clone()),
        parent_id: bone.parent.map_or(-1, |parent| parent.index() as i64),
        weight_id,
        length: bone.length,
        xzx_min: end(|limits| limits.lower),
        xzx_max: end(|limits| limits.upper),
        rest: vec![
            vec![r.x.x, r.y.x, r.z.x, t.x],
            vec![r.x.y, r.y.y, r.z.y, t.y],
            vec![r.x.z, r.y.z, r.z.z, t.z],
            vec![0.0, 0.0, 0.0, 1.0],
        ],
    }
}

fn key_entry(key: &crate::animation::EulerKey) -> KeyEntry {
    KeyEntry {
        t: key.time,
        xzx: key.angles.map(degrees::from_radians).to_vec(),
        tcb: None,
    }
}
