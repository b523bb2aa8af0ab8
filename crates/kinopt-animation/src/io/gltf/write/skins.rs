//! Writing of skins and weights.

use glam::Affine3A;
use gltf_json::{Index, skin};

use super::buffer::Document;
use crate::io::gltf::scene::Skin;
use crate::skinning::{Influence, SkinWeights};

/// Number of influences per attribute set.
const INFLUENCES_PER_SET: usize = 4;

/// Joints and weights of every vertex, four each.
type Set = (
    Vec<[u16; INFLUENCES_PER_SET]>,
    Vec<[f32; INFLUENCES_PER_SET]>,
);

/// Reports whether two meshes may share a skin; weights belong to the meshes.
pub(super) fn is_same(one: &Skin, other: &Skin) -> bool {
    let same_joints = one.joints == other.joints && one.name == other.name;
    same_joints && one.joint_from_mesh == other.joint_from_mesh
}

/// Joints and weights of every vertex in sets of four, by descending weight: some programs read the first set only.
pub(super) fn sets(weights: &SkinWeights) -> Vec<Set> {
    let sets = weights.max_influences().div_ceil(INFLUENCES_PER_SET).max(1);
    let mut sorted: Vec<Vec<Influence>> = weights.iter().map(<[Influence]>::to_vec).collect();
    for influences in &mut sorted {
        influences.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    }
    let set = |set: usize| {
        let influence_at = |influences: &Vec<Influence>, index: usize| {
            let influence = influences.get(INFLUENCES_PER_SET * set + index);
            influence.map_or((0, 0.0), |i| (i.bone as u16, i.weight as f32))
        };
        sorted
            .iter()
            .map(|influences| {
                let set_influences: [(u16, f32); INFLUENCES_PER_SET] =
                    std::array::from_fn(|k| influence_at(influences, k));
                (
                    set_influences.map(|(joint, _)| joint),
                    set_influences.map(|(_, weight)| weight),
                )
            })
            .unzip()
    };
    (0..sets).map(set).collect()
}

pub(super) fn skin_entry(skin: &Skin, document: &mut Document) -> Index<skin::Skin> {
    let matrices: Vec<[f32; 16]> = skin.joint_from_mesh.iter().map(columns).collect();
    let matrices = (!matrices.is_empty()).then(|| document.numbers(&matrices, false, None));
    let joints = skin.joints.iter();
    document.root.push(plain!(skin::Skin {
        inverse_bind_matrices: matrices,
        joints: joints
            .map(|joint| Index::new(joint.index() as u32))
            .collect(),
        name: (!skin.name.is_empty()).then(|| skin.name.clone()),
        skeleton: None,
    }))
}

fn columns(affine: &Affine3A) -> [f32; 16] {
    let (m, t) = (affine.matrix3, affine.translation);
    let columns = [(m.x_axis, 0.0), (m.y_axis, 0.0), (m.z_axis, 0.0), (t, 1.0)];
    let columns = columns.map(|(column, last)| column.extend(last).to_array());
    std::array::from_fn(|k| columns[k / 4][k % 4])
}
