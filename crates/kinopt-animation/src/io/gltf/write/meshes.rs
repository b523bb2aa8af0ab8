//! Writing of meshes, morph targets and skins.

use std::collections::BTreeMap;

use glam::Vec3;
use gltf_json::buffer::Target;
use gltf_json::extras::RawValue;
use gltf_json::mesh::{Mesh, Mode, MorphTarget as Entry, Primitive, Semantic};
use gltf_json::validation::Checked;
use gltf_json::{Accessor, Index, skin};

use super::UnwritableScene;
use super::buffer::Document;
use super::skins::{is_same, sets, skin_entry};
use crate::animation::Armature;
use crate::io::gltf::morph_targets::MeshExtras;
use crate::io::gltf::scene::{Scene, SceneMesh, Skin};

pub(super) fn add(scene: &Scene, document: &mut Document) -> Result<(), UnwritableScene> {
    let mut skins: Vec<(&Skin, Index<skin::Skin>)> = Vec::new();
    for mesh in &scene.meshes {
        let entry = entry(mesh, &scene.armature, document)?;
        let entry = document.root.push(entry);
        let skin = match &mesh.skin {
            None => None,
            Some(skin) => {
                let known = skins.iter().find(|(other, _)| is_same(skin, other));
                Some(match known {
                    Some((_, index)) => *index,
                    None => {
                        let index = skin_entry(skin, document);
                        skins.push((skin, index));
                        index
                    }
                })
            }
        };
        let Some(node) = document.root.nodes.get_mut(mesh.bone.index()) else {
            continue;
        };
        if node.mesh.is_some() {
            let bone = node.name.clone().unwrap_or_default();
            return Err(UnwritableScene::TwoMeshes { bone });
        }
        (node.mesh, node.skin) = (Some(entry), skin);
    }
    Ok(())
}

fn entry(
    mesh: &SceneMesh,
    armature: &Armature,
    document: &mut Document,
) -> Result<Mesh, UnwritableScene> {
    let empty = |what| UnwritableScene::Empty {
        mesh: mesh.name.clone(),
        what,
    };
    let shape = &mesh.mesh;
    if shape.positions().is_empty() {
        return Err(empty("vertices"));
    }
    if shape.triangles().is_empty() {
        return Err(empty("triangles"));
    }
    let vertices = Some(Target::ArrayBuffer);
    let mut attributes = BTreeMap::new();
    let mut attribute = |semantic, accessor: Index<Accessor>| {
        attributes.insert(Checked::Valid(semantic), accessor);
    };
    let positions = bytemuck::cast_slice(shape.positions());
    attribute(
        Semantic::Positions,
        document.numbers::<3>(positions, true, vertices),
    );
    if !shape.normals().is_empty() {
        let normals = bytemuck::cast_slice(shape.normals());
        attribute(
            Semantic::Normals,
            document.numbers::<3>(normals, false, vertices),
        );
    }
    if !mesh.tangents.is_empty() {
        let tangents = bytemuck::cast_slice(&mesh.tangents);
        attribute(
            Semantic::Tangents,
            document.numbers::<4>(tangents, false, vertices),
        );
    }
    if let Some(skin) = &mesh.skin {
        if skin.joints.len() > 1 << 16 {
            let (mesh, joints) = (mesh.name.clone(), skin.joints.len());
            return Err(UnwritableScene::TooManyJoints { mesh, joints });
        }
        for (set, (joints, weights)) in sets(&skin.weights).into_iter().enumerate() {
            attribute(Semantic::Joints(set as u32), document.joints(&joints));
            attribute(
                Semantic::Weights(set as u32),
                document.numbers(&weights, false, vertices),
            );
        }
    }
    let indices = Some(document.triangles(shape.triangles()));
    let targets = mesh.morph_targets.targets();
    let count = shape.positions().len();
    let entries = targets.iter().map(|target| {
        let mut part = |deltas: &[Vec3], bounded| {
            let vertices = target.vertices();
            let is_written = !deltas.is_empty() || bounded;
            is_written
                .then(|| document.deltas(count, vertices, bytemuck::cast_slice(deltas), bounded))
        };
        Entry {
            positions: part(target.position_deltas(), true),
            // Targets may only have attributes of the mesh (section 3.7.2.2).
            normals: match shape.normals() {
                [] => None,
                _ => part(target.normal_deltas(), false),
            },
            tangents: match mesh.tangents.as_slice() {
                [] => None,
                _ => part(target.tangent_deltas(), false),
            },
        }
    });
    let entries: Vec<Entry> = entries.collect();
    let mesh_weights = |target_weights: &[f32]| {
        target_weights
            .get(mesh.morph_weights())
            .unwrap_or(&[])
            .to_vec()
    };
    let weights = mesh_weights(armature.rest().morph_weights());
    Ok(Mesh {
        extensions: None,
        extras: target_names(mesh, armature)?,
        name: Some(mesh.name.clone()),
        primitives: vec![plain!(Primitive {
            attributes,
            indices,
            material: None,
            mode: Checked::Valid(Mode::Triangles),
            targets: (!entries.is_empty()).then_some(entries),
        })],
        weights: (!weights.is_empty()).then_some(weights),
    })
}

fn target_names(
    mesh: &SceneMesh,
    armature: &Armature,
) -> Result<Option<Box<RawValue>>, UnwritableScene> {
    let names = armature.morph_targets().get(mesh.morph_weights());
    let target_names = names.unwrap_or(&[]).to_vec();
    if target_names.is_empty() {
        return Ok(None);
    }
    let raw = serde_json::value::to_raw_value(&MeshExtras { target_names });
    raw.map(Some)
        .map_err(|error| UnwritableScene::Document(error.to_string()))
}
