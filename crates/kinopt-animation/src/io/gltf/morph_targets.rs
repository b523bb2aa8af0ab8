//! Morph targets: their deltas and names.

use std::collections::BTreeMap;

use glam::Vec3;
use gltf_json::Mesh;
use gltf_json::mesh::MorphTarget as Entry;
use serde::{Deserialize, Serialize};

use super::source::GltfSource;
use crate::io::ReadError;
use crate::skinning::{MorphTarget, SkinningError};

/// A morph target of a mesh with several primitives.
#[derive(Clone, Debug, Default)]
pub(super) struct Deltas {
    /// Deltas of position, normal and tangent by vertex.
    vertices: BTreeMap<u32, [Vec3; 3]>,
    has_normals: bool,
    has_tangents: bool,
}

/// Names of a mesh's targets in its `extras`, a convention of most programs.
#[derive(Default, Deserialize, Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct MeshExtras {
    #[serde(default)]
    pub(super) target_names: Vec<String>,
}

/// Adds a primitive's part of a target. The primitive's vertices start at `first`.
pub(super) fn append(
    source: &GltfSource<'_>,
    target: &Entry,
    [first, count]: [usize; 2],
    user: &str,
    deltas: &mut Deltas,
) -> Result<(), ReadError> {
    let parts = [
        ("POSITION", target.positions),
        ("NORMAL", target.normals),
        ("TANGENT", target.tangents),
    ];
    deltas.has_normals |= target.normals.is_some();
    deltas.has_tangents |= target.tangents.is_some();
    for (attribute, (what, index)) in parts.into_iter().enumerate() {
        let Some(index) = index else {
            continue;
        };
        let user = format!("{user}, {what}");
        let vec3 = |[x, y, z]: [f64; 3]| Vec3::new(x as f32, y as f32, z as f32);
        for (vertex, delta) in source.deltas(index, count, &user, vec3)? {
            let vertex_deltas = deltas.vertices.entry(first as u32 + vertex).or_default();
            if let Some(part) = vertex_deltas.get_mut(attribute) {
                *part = delta;
            }
        }
    }
    Ok(())
}

impl Deltas {
    pub(super) fn target(&self, name: &str) -> Result<MorphTarget, SkinningError> {
        let part = |part: fn(&[Vec3; 3]) -> Vec3| self.vertices.values().map(part).collect();
        let positions = part(|[position, _, _]| *position);
        let normals = match self.has_normals {
            true => part(|[_, normal, _]| *normal),
            false => Vec::new(),
        };
        let tangents = match self.has_tangents {
            true => part(|[_, _, tangent]| *tangent),
            false => Vec::new(),
        };
        let vertices = self.vertices.keys().copied().collect();
        MorphTarget::new(name, vertices, positions, normals, tangents)
    }
}

/// Names of a mesh's targets: from the mesh's `extras`, or numbered.
pub(super) fn names(mesh: &Mesh, targets: usize) -> Vec<String> {
    let extras = mesh.extras.as_ref().map(|extras| extras.get());
    // Extras are free-form: other contents than names are ignored.
    let extras = extras.and_then(|extras| serde_json::from_str::<MeshExtras>(extras).ok());
    let given = extras.unwrap_or_default().target_names;
    (0..targets)
        .map(
            |index| match given.get(index).filter(|name| !name.is_empty()) {
                Some(name) => name.clone(),
                None => format!("target/{index}"),
            },
        )
        .collect()
}
