//! Skins: joints, inverse bind matrices and weights.

use glam::{Affine3A, Mat3A, Vec3A};
use gltf_json::Skin as Entry;

use super::node_transform::affine;
use super::nodes::{label, missing_node};
use super::note::Note;
use super::raw_mesh::{JointWeight, RawMesh};
use super::scene::Skin;
use super::source::GltfSource;
use crate::io::ReadError;
use crate::skinning::{SkinWeights, WeightRepair};
use kinopt_kinematics::skeleton::BoneId;

/// Reads the skin of a mesh (index, name and vertices).
pub(super) fn read(
    source: &GltfSource<'_>,
    index: usize,
    bone_of: &[BoneId],
    mesh: (usize, &str, &RawMesh),
    notes: &mut Vec<Note>,
) -> Result<Skin, ReadError> {
    let entry = source.entry(&source.root.skins, ("skins", index), None)?;
    let user = label("skin", index, entry.name.as_ref());
    let mut joints = Vec::with_capacity(entry.joints.len());
    for (joint_index, joint) in entry.joints.iter().enumerate() {
        let bone = bone_of.get(joint.value()).ok_or_else(|| {
            let path = format!("skins[{index}].joints[{joint_index}]");
            missing_node(source, path, joint.value())
        })?;
        joints.push(*bone);
    }
    if joints.is_empty() {
        let problem = format!("{user}: has no joints");
        return Err(source.fail(format!("skins[{index}].joints"), problem));
    }
    Ok(Skin {
        name: entry.name.clone().unwrap_or_default(),
        joint_from_mesh: read_inverse_bind_matrices(source, entry, (index, &user), notes)?,
        weights: weights(source, mesh, joints.len(), notes)?,
        joints,
    })
}

/// Checks the inverse bind matrices of a skin that no mesh uses.
pub(super) fn check(
    source: &GltfSource<'_>,
    index: usize,
    notes: &mut Vec<Note>,
) -> Result<(), ReadError> {
    let entry = source.root.skins.get(index);
    entry.map_or(Ok(()), |entry| {
        let user = label("skin", index, entry.name.as_ref());
        read_inverse_bind_matrices(source, entry, (index, &user), notes).map(|_| ())
    })
}

/// Inverse bind matrices, one per joint; identities if the file has none.
fn read_inverse_bind_matrices(
    source: &GltfSource<'_>,
    entry: &Entry,
    (index, user): (usize, &str),
    notes: &mut Vec<Note>,
) -> Result<Vec<Affine3A>, ReadError> {
    let joints = entry.joints.len();
    let Some(matrices) = entry.inverse_bind_matrices else {
        return Ok(vec![Affine3A::IDENTITY; joints]);
    };
    let user = format!("{user}, inverse bind matrices");
    let matrices = source.read(matrices, &user, |matrix: [f64; 16]| {
        matrix.map(|number| number as f32)
    })?;
    let path = format!("skins[{index}].inverseBindMatrices");
    if matrices.len() < joints {
        let problem = format!("{user}: {} for {joints} joints", matrices.len());
        return Err(source.fail(path, problem));
    }
    let checked = matrices
        .iter()
        .take(joints)
        .enumerate()
        .map(|(joint, matrix)| {
            let problem =
                |problem| source.fail(path.as_str(), format!("{user}: joint {joint}: {problem}"));
            let (_, repair) = affine(matrix).map_err(problem)?;
            if let Some(repair) = repair {
                notes.push(Note::repaired(format!("{path}[{joint}]"), repair));
            }
            let column =
                |first: usize| Vec3A::new(matrix[first], matrix[first + 1], matrix[first + 2]);
            Ok(Affine3A {
                matrix3: Mat3A::from_cols(column(0), column(4), column(8)),
                translation: column(12),
            })
        });
    checked.collect()
}

fn weights(
    source: &GltfSource<'_>,
    (index, name, raw): (usize, &str, &RawMesh),
    joints: usize,
    notes: &mut Vec<Note>,
) -> Result<SkinWeights, ReadError> {
    let fail = |problem: String| {
        let problem = format!("mesh `{name}`: {problem}");
        source.fail(format!("meshes[{index}]"), problem)
    };
    if !raw.is_skinned {
        let problem = "it has a skin, but not every primitive has JOINTS_0 and WEIGHTS_0";
        return Err(fail(problem.into()));
    }
    let mut joint_weights = raw.joints.clone();
    joint_weights.sort_by_key(|entry| (entry.vertex, entry.joint));
    let given = joint_weights.len();
    joint_weights.dedup_by(|second, first| {
        let is_duplicate = (second.vertex, second.joint) == (first.vertex, first.joint);
        if is_duplicate {
            first.weight += second.weight;
        }
        is_duplicate
    });
    let merged = given - joint_weights.len();
    let unweighted = bind_unweighted(&mut joint_weights, joints);
    let mut builder = SkinWeights::builder(raw.positions.len(), joints);
    for entry in joint_weights {
        let added = builder.add(entry.vertex as usize, entry.joint as usize, entry.weight);
        added.map_err(|error| fail(error.to_string()))?;
    }
    let (weights, repair) = builder
        .build_repaired()
        .map_err(|error| fail(error.to_string()))?;
    if repair != WeightRepair::default() || merged > 0 || unweighted > 0 {
        notes.push(Note::Weights {
            mesh: name.to_owned(),
            repair,
            merged,
            unweighted,
        });
    }
    Ok(weights)
}

/// Gives each vertex whose weights are all 0 the weight 1 at its first joint, as three.js does. Joint 0 is used if the
/// skin has no such joint. `joint_weights` are sorted by vertex. Returns the number of these vertices.
fn bind_unweighted(joint_weights: &mut [JointWeight], joints: usize) -> usize {
    let mut count = 0;
    for vertex_weights in joint_weights.chunk_by_mut(|a, b| a.vertex == b.vertex) {
        let has_weight = vertex_weights.iter().any(|entry| entry.weight != 0.0);
        if let Some(first) = vertex_weights.first_mut().filter(|_| !has_weight) {
            first.weight = 1.0;
            if first.joint as usize >= joints {
                first.joint = 0;
            }
            count += 1;
        }
    }
    count
}
