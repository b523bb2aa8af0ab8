//! Primitives of a mesh, joined to one list of vertices and one of triangles.

use std::collections::{BTreeMap, BTreeSet};

use glam::{Vec3, Vec4};
use gltf_json::mesh::{Primitive, Semantic};
use gltf_json::validation::Checked;
use gltf_json::{Accessor, Index};

use super::compression;
use super::morph_targets::{self, Deltas};
use super::nodes::label;
use super::raw_mesh::{JointWeight, RawMesh};
use super::source::GltfSource;
use super::triangles;
use crate::io::ReadError;

/// Attributes and targets of a primitive; primitives with equal keys share their vertices.
type VertexKey = (Vec<(String, usize)>, Vec<[Option<usize>; 3]>);

/// Accessors of a primitive by attribute.
#[derive(Default)]
struct PrimitiveAccessors {
    positions: Option<Index<Accessor>>,
    normals: Option<Index<Accessor>>,
    tangents: Option<Index<Accessor>>,
    joints: BTreeMap<u32, Index<Accessor>>,
    weights: BTreeMap<u32, Index<Accessor>>,
}

/// Number of vertex blocks with each attribute that is kept only if all blocks have it.
#[derive(Default)]
struct AttributeCounts {
    normals: usize,
    tangents: usize,
    joints: usize,
    blocks: usize,
}

pub(super) fn read(source: &GltfSource<'_>, index: usize) -> Result<RawMesh, ReadError> {
    let mesh = source.entry(&source.root.meshes, ("meshes", index), None)?;
    let name = label("mesh", index, mesh.name.as_ref());
    let mut raw = RawMesh::default();
    let mut counts = AttributeCounts::default();
    let mut blocks: BTreeMap<VertexKey, (u32, usize)> = BTreeMap::new();
    let target_count = |primitive: &Primitive| primitive.targets.as_ref().map_or(0, Vec::len);
    let mut with_triangles = Vec::with_capacity(mesh.primitives.len());
    for (number, primitive) in mesh.primitives.iter().enumerate() {
        if source.undecoded.contains(&(index, number)) {
            raw.unread.push((number, compression::UNDECODED.into()));
            continue;
        }
        match triangles::without_triangles(primitive) {
            None => with_triangles.push((number, primitive)),
            Some(mode) => {
                let what = format!("a primitive drawn as {mode:?}");
                raw.unread.push((number, what.into()));
            }
        }
    }
    let targets = with_triangles
        .first()
        .map_or(0, |(_, first)| target_count(first));
    raw.targets = vec![Deltas::default(); targets];
    for (number, primitive) in with_triangles {
        let path = format!("meshes[{index}].primitives[{number}]");
        let user = format!("{name}, primitive {number}");
        if target_count(primitive) != targets {
            let problem = format!(
                "{name}: {} morph targets, but the first primitive has {targets}",
                target_count(primitive)
            );
            return Err(source.fail(format!("{path}.targets"), problem));
        }
        let key = vertex_key(primitive);
        let (first, count) = match blocks.get(&key) {
            Some(block) => *block,
            None => {
                let first = raw.positions.len() as u32;
                let count = vertices(source, primitive, &path, &user, &mut raw, &mut counts)?;
                blocks.insert(key, (first, count));
                (first, count)
            }
        };
        let block = [first as usize, count];
        triangles::append(source, primitive, &path, &user, block, &mut raw)?;
    }
    keep_common_attributes(&counts, &mut raw);
    Ok(raw)
}

fn vertex_key(primitive: &Primitive) -> VertexKey {
    let attributes = primitive.attributes.iter();
    let attributes = attributes.map(|(semantic, index)| (semantic.to_string(), index.value()));
    let targets = primitive.targets.iter().flatten().map(|target| {
        let parts = [&target.positions, &target.normals, &target.tangents];
        parts.map(|index| index.as_ref().map(Index::value))
    });
    (attributes.collect(), targets.collect())
}

/// Appends the vertices of a primitive and returns their number.
fn vertices(
    source: &GltfSource<'_>,
    primitive: &Primitive,
    path: &str,
    user: &str,
    raw: &mut RawMesh,
    counts: &mut AttributeCounts,
) -> Result<usize, ReadError> {
    let attributes = attributes(primitive, &mut raw.left_out);
    let attribute_user = |what: &str| format!("{user}, {what}");
    let Some(positions) = attributes.positions else {
        let path = format!("{path}.attributes");
        return Err(source.fail(path, format!("{user}: has no POSITION")));
    };
    let count = source.count(positions, &attribute_user("POSITION"))?;
    let first = raw.positions.len();
    let end = first.checked_add(count);
    if end.is_none_or(|end| u32::try_from(end).is_err()) {
        let problem = format!("{user}: has more vertices than can be counted");
        return Err(source.fail(path, problem));
    }
    let check_count =
        |index: Index<Accessor>, what: &str| match source.count(index, &attribute_user(what))? {
            given if given == count => Ok(attribute_user(what)),
            given => {
                let problem = format!("{user}: {given} entries for {count} vertices");
                Err(source.fail(format!("{path}.attributes.{what}"), problem))
            }
        };
    let vec3 = |[x, y, z]: [f64; 3]| Vec3::new(x as f32, y as f32, z as f32);
    raw.positions
        .extend(source.read(positions, &attribute_user("POSITION"), vec3)?);
    counts.blocks += 1;
    if let Some(normals) = attributes.normals {
        let user = check_count(normals, "NORMAL")?;
        raw.normals.extend(source.read(normals, &user, vec3)?);
        counts.normals += 1;
    }
    if let Some(tangents) = attributes.tangents {
        let user = check_count(tangents, "TANGENT")?;
        let vec4 = |v: [f64; 4]| Vec4::from_array(v.map(|number| number as f32));
        let read = source.read(tangents, &user, vec4)?;
        if let Some(vertex) = read.iter().position(|tangent| !tangent.is_finite()) {
            let problem = format!("{user}: vertex {vertex}: the tangent is not finite");
            return Err(source.fail(format!("{path}.attributes.TANGENT"), problem));
        }
        raw.tangents.extend(read);
        counts.tangents += 1;
    }
    if !attributes.joints.keys().eq(attributes.weights.keys()) {
        let problem = format!("{user}: there must be as many JOINTS_n as WEIGHTS_n");
        return Err(source.fail(format!("{path}.attributes"), problem));
    }
    counts.joints += usize::from(!attributes.joints.is_empty());
    for (set, joints) in &attributes.joints {
        let user = check_count(*joints, &format!("JOINTS_{set}"))?;
        let joints: Vec<[u32; 4]> = source.read_indices(*joints, &user)?;
        let Some(weights) = attributes.weights.get(set) else {
            continue;
        };
        let user = check_count(*weights, &format!("WEIGHTS_{set}"))?;
        let weights = source.read(*weights, &user, |weights: [f64; 4]| weights)?;
        source.charge::<JointWeight>(4 * count, path)?;
        for (vertex, (joints, weights)) in (first as u32..).zip(joints.iter().zip(&weights)) {
            // A joint with weight 0 may have any index. A vertex without weights keeps its first joint.
            let unweighted = *set == 0 && weights.iter().all(|weight| *weight == 0.0);
            let used = joints
                .iter()
                .zip(weights)
                .enumerate()
                .filter(|(slot, (_, weight))| **weight != 0.0 || (unweighted && *slot == 0))
                .map(|(_, used)| used);
            raw.joints.extend(used.map(|(&joint, &weight)| JointWeight {
                vertex,
                joint,
                weight,
            }));
        }
    }
    for (number, target) in primitive.targets.iter().flatten().enumerate() {
        let user = format!("{user}, morph target {number}");
        if let Some(deltas) = raw.targets.get_mut(number) {
            morph_targets::append(source, target, [first, count], &user, deltas)?;
        }
    }
    Ok(count)
}

fn attributes(primitive: &Primitive, left_out: &mut BTreeSet<String>) -> PrimitiveAccessors {
    let mut attributes = PrimitiveAccessors::default();
    for (semantic, &index) in &primitive.attributes {
        match semantic {
            Checked::Valid(Semantic::Positions) => attributes.positions = Some(index),
            Checked::Valid(Semantic::Normals) => attributes.normals = Some(index),
            Checked::Valid(Semantic::Tangents) => attributes.tangents = Some(index),
            Checked::Valid(Semantic::Joints(set)) => {
                attributes.joints.insert(*set, index);
            }
            Checked::Valid(Semantic::Weights(set)) => {
                attributes.weights.insert(*set, index);
            }
            other => {
                left_out.insert(other.to_string());
            }
        }
    }
    attributes
}

/// Removes normals and tangents that only some primitives have.
fn keep_common_attributes(counts: &AttributeCounts, raw: &mut RawMesh) {
    let mut keep_if_common = |what: &str, count: usize, exists: bool| {
        let is_common = count == counts.blocks;
        if !is_common && exists {
            let left_out = format!("{what}, as not every primitive has it");
            raw.left_out.insert(left_out);
        }
        is_common
    };
    if !keep_if_common("NORMAL", counts.normals, !raw.normals.is_empty()) {
        raw.normals.clear();
    }
    if !keep_if_common("TANGENT", counts.tangents, !raw.tangents.is_empty()) {
        raw.tangents.clear();
    }
    raw.is_skinned = counts.blocks > 0 && counts.joints == counts.blocks;
}
