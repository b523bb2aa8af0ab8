//! The meshes of the displayed scene, each on its node, and the morph targets of all meshes.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Display;

use super::nodes::{Nodes, free_name, label, node_label};
use super::note::Note;
use super::primitives;
use super::raw_mesh::{JointWeight, RawMesh};
use super::scene::SceneMesh;
use super::source::GltfSource;
use super::{morph_targets, skins};
use crate::io::ReadError;
use crate::skinning::MorphTargets;
use kinopt_mesh::mesh::TriangleMesh;

/// Meshes of the nodes.
#[derive(Default)]
pub(super) struct Meshes {
    pub(super) meshes: Vec<SceneMesh>,
    /// Names of all morph targets.
    pub(super) target_names: Vec<String>,
    /// Weights of all morph targets at rest.
    pub(super) target_weights: Vec<f32>,
    /// Index of the mesh of each node in `meshes`.
    pub(super) index_of_node: BTreeMap<usize, usize>,
}

pub(super) fn read(
    source: &GltfSource<'_>,
    nodes: &Nodes,
    notes: &mut Vec<Note>,
) -> Result<Meshes, ReadError> {
    let mut meshes = Meshes::default();
    let mut raw_meshes: BTreeMap<usize, RawMesh> = BTreeMap::new();
    let (mut used_names, mut left_out, mut used_skins) =
        (BTreeSet::new(), BTreeSet::new(), BTreeSet::new());
    // In the order of the bones, so that a scene keeps its order when it is written and read.
    let mut order: Vec<usize> = (0..source.root.nodes.len()).collect();
    order.sort_by_key(|&node| nodes.bone_of[node]);
    for index in order {
        let node = &source.root.nodes[index];
        let Some(mesh) = node.mesh.map(|mesh| mesh.value()) else {
            continue;
        };
        if !nodes.in_scene[index] {
            let node = node_label(&source.root.nodes, index);
            let what = format!("{node} is in no scene that is shown: its mesh");
            notes.push(Note::left_out(format!("nodes[{index}].mesh"), what));
            continue;
        }
        let raw = match raw_meshes.get(&mesh) {
            Some(raw) => {
                charge_again(source, raw, index)?;
                raw
            }
            None => {
                let raw = primitives::read(source, mesh)?;
                left_out.extend(raw.left_out.iter().cloned());
                for (primitive, what) in &raw.unread {
                    let path = format!("meshes[{mesh}].primitives[{primitive}]");
                    notes.push(Note::left_out(path, what.as_ref()));
                }
                raw_meshes.entry(mesh).or_insert(raw)
            }
        };
        // A mesh without triangles is left out.
        if raw.positions.is_empty() && !raw.unread.is_empty() {
            continue;
        }
        used_skins.extend(node.skin.map(|skin| skin.value()));
        meshes.index_of_node.insert(index, meshes.meshes.len());
        let indices = (index, mesh);
        add(
            source,
            indices,
            raw,
            nodes,
            &mut meshes,
            &mut used_names,
            notes,
        )?;
    }
    for skin in (0..source.root.skins.len()).filter(|skin| !used_skins.contains(skin)) {
        skins::check(source, skin, notes)?;
    }
    if !left_out.is_empty() {
        let names: Vec<String> = left_out.into_iter().collect();
        notes.push(Note::left_out("meshes", names.join(", ")));
    }
    Ok(meshes)
}

/// Charges the memory limit for a mesh that another node has as well.
fn charge_again(source: &GltfSource<'_>, raw: &RawMesh, node: usize) -> Result<(), ReadError> {
    let path = format!("nodes[{node}].mesh");
    source.charge::<[f32; 10]>(raw.positions.len(), &path)?;
    source.charge::<[u32; 3]>(raw.triangles.len(), &path)?;
    source.charge::<JointWeight>(raw.joints.len(), &path)
}

fn add(
    source: &GltfSource<'_>,
    (node_index, mesh_index): (usize, usize),
    raw: &RawMesh,
    nodes: &Nodes,
    meshes: &mut Meshes,
    used_names: &mut BTreeSet<String>,
    notes: &mut Vec<Note>,
) -> Result<(), ReadError> {
    let root = source.root;
    let (node, entry) = (&root.nodes[node_index], &root.meshes[mesh_index]);
    let title = label("mesh", mesh_index, entry.name.as_ref());
    let fail = |problem: &dyn Display| {
        let problem = format!("{title}: {problem}");
        source.fail(format!("meshes[{mesh_index}]"), problem)
    };
    let (positions, normals) = (raw.positions.clone(), raw.normals.clone());
    let mesh = TriangleMesh::new(positions, normals, raw.triangles.clone());
    let mesh = mesh.map_err(|error| fail(&error))?;
    let name = match &entry.name {
        Some(name) if !name.is_empty() => name.clone(),
        _ => format!("mesh/{mesh_index}"),
    };
    let bone = nodes.bone_of[node_index];
    let first_morph_weight = meshes.target_names.len();
    let mut targets = Vec::with_capacity(raw.targets.len());
    let names = morph_targets::names(entry, raw.targets.len());
    for (deltas, plain) in raw.targets.iter().zip(names) {
        // Another mesh, or this one on another node, may have a target of the name.
        let unique = match used_names.contains(&plain) {
            true => {
                let node = &nodes.bones[bone.index()].name;
                free_name(format!("{node}/{plain}"), used_names)
            }
            false => free_name(plain, used_names),
        };
        targets.push(deltas.target(&unique).map_err(|error| fail(&error))?);
        meshes.target_names.push(unique);
    }
    let path = || match node.weights {
        Some(_) => format!("nodes[{node_index}].weights"),
        None => format!("meshes[{mesh_index}].weights"),
    };
    match node.weights.as_ref().or(entry.weights.as_ref()) {
        None => meshes.target_weights.resize(meshes.target_names.len(), 0.0),
        Some(weights) if weights.len() == targets.len() => {
            if weights.iter().any(|weight| !weight.is_finite()) {
                return Err(source.fail(path(), format!("{title}: a weight is not finite")));
            }
            meshes.target_weights.extend_from_slice(weights);
        }
        Some(weights) => {
            let (given, targets) = (weights.len(), targets.len());
            let problem = format!("{title}: {given} weights for {targets} targets");
            return Err(source.fail(path(), problem));
        }
    }
    let vertices = mesh.positions().len();
    let morph_targets = MorphTargets::new(vertices, targets).map_err(|error| fail(&error))?;
    let skin = node.skin.map(|skin| {
        let mesh = (mesh_index, name.as_str(), raw);
        skins::read(source, skin.value(), &nodes.bone_of, mesh, notes)
    });
    let skin = skin.transpose()?;
    if skin.is_none() && raw.is_skinned {
        let what = format!("{title} has joints, but the node has no skin: its weights");
        notes.push(Note::left_out(format!("nodes[{node_index}]"), what));
    }
    meshes.meshes.push(SceneMesh {
        name,
        bone,
        mesh,
        tangents: raw.tangents.clone(),
        morph_targets,
        first_morph_weight,
        skin,
    });
    Ok(())
}
