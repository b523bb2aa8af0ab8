//! Nodes as bones: parents before children, each with a unique name.

use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

use gltf_json::Node;

use super::node_transform::{NodeRest, local};
use super::note::Note;
use super::source::GltfSource;
use crate::animation::ArmatureBone;
use crate::io::ReadError;
use kinopt_kinematics::skeleton::BoneId;

/// The bones of a document.
pub(super) struct Nodes {
    pub(super) bones: Vec<ArmatureBone>,
    /// Bone of each node, by node index.
    pub(super) bone_of: Vec<BoneId>,
    /// True for nodes of the displayed scene, by node index.
    pub(super) in_scene: Vec<bool>,
}

/// Name of an object with an optional name, for messages.
pub(super) fn label(kind: &str, index: usize, name: Option<&String>) -> String {
    match name.filter(|name| !name.is_empty()) {
        Some(name) => format!("{kind} `{name}`"),
        None => format!("{kind} {index}"),
    }
}

pub(super) fn node_label(nodes: &[Node], index: usize) -> String {
    label(
        "node",
        index,
        nodes.get(index).and_then(|node| node.name.as_ref()),
    )
}

pub(super) fn read(source: &GltfSource<'_>, notes: &mut Vec<Note>) -> Result<Nodes, ReadError> {
    let nodes = &source.root.nodes;
    let parents = parents(source)?;
    let order = order(source, &parents)?;
    let names = names(source, notes);
    let mut bone_index = vec![0; nodes.len()];
    let mut bones = Vec::with_capacity(nodes.len());
    for (position, &index) in order.iter().enumerate() {
        bone_index[index] = position;
        let rest = local(&nodes[index]).map_err(|(key, problem)| {
            let problem = format!("{}: {problem}", node_label(nodes, index));
            source.fail(format!("nodes[{index}].{key}"), problem)
        })?;
        let NodeRest { rest, repair } = rest;
        if let Some(repair) = repair {
            notes.push(Note::repaired(format!("nodes[{index}].rotation"), repair));
        }
        bones.push(ArmatureBone {
            name: names[index].clone(),
            parent: parents[index].map(|parent| bone_index[parent]),
            rest,
        });
    }
    Ok(Nodes {
        bones,
        bone_of: bone_index.into_iter().map(BoneId::new).collect(),
        in_scene: in_scene(source)?,
    })
}

/// Parent of each node.
fn parents(source: &GltfSource<'_>) -> Result<Vec<Option<usize>>, ReadError> {
    let nodes = &source.root.nodes;
    let mut parents: Vec<Option<usize>> = vec![None; nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        for (child_index, child) in node.children.iter().flatten().enumerate() {
            let path = || format!("nodes[{index}].children[{child_index}]");
            let Some(parent) = parents.get_mut(child.value()) else {
                return Err(missing_node(source, path(), child.value()));
            };
            if let Some(other) = parent.replace(index) {
                let [child, other, second_parent] =
                    [child.value(), other, index].map(|index| node_label(nodes, index));
                let problem = format!("{child} is a child of {other} and of {second_parent}");
                return Err(source.fail(path(), problem));
            }
        }
    }
    Ok(parents)
}

pub(super) fn missing_node(source: &GltfSource<'_>, path: String, node: usize) -> ReadError {
    let problem = match source.root.nodes.len() {
        0 => format!("node {node} does not exist; there are none"),
        nodes => format!("node {node} does not exist; nodes are 0 to {}", nodes - 1),
    };
    source.fail(path, problem)
}

/// Node indices with parents before children; the file's order if it satisfies this.
fn order(source: &GltfSource<'_>, parents: &[Option<usize>]) -> Result<Vec<usize>, ReadError> {
    let nodes = &source.root.nodes;
    let roots = (0..nodes.len()).filter(|&index| parents[index].is_none());
    let mut ready: BinaryHeap<Reverse<usize>> = roots.map(Reverse).collect();
    let mut order = Vec::with_capacity(nodes.len());
    let mut done = vec![false; nodes.len()];
    while let Some(Reverse(index)) = ready.pop() {
        order.push(index);
        done[index] = true;
        let children = nodes[index].children.iter().flatten();
        ready.extend(children.map(|child| Reverse(child.value())));
    }
    match done.iter().position(|done| !done) {
        None => Ok(order),
        Some(index) => {
            let problem = format!("{} is below itself", node_label(nodes, index));
            Err(source.fail(format!("nodes[{index}].children"), problem))
        }
    }
}

/// Unique names of the nodes. Of several nodes with one name a joint keeps it, or else an animated node, or else the
/// first.
fn names(source: &GltfSource<'_>, notes: &mut Vec<Note>) -> Vec<String> {
    let nodes = &source.root.nodes;
    let given = |node: &Node| node.name.clone().filter(|name| !name.is_empty());
    let mut used_names: BTreeSet<String> = BTreeSet::new();
    let mut order: Vec<usize> = (0..nodes.len()).collect();
    let ranks = ranks(source);
    order.sort_by_key(|&index| Reverse(ranks[index]));
    let mut kept_names = vec![None; nodes.len()];
    for index in order {
        kept_names[index] = given(&nodes[index]).filter(|name| used_names.insert(name.clone()));
    }
    let named = kept_names.into_iter().zip(nodes).enumerate();
    named
        .map(|(index, (kept_name, node))| {
            kept_name.unwrap_or_else(|| {
                let stem = given(node).unwrap_or_else(|| "node".into());
                let name = free_name(format!("{stem}/{index}"), &mut used_names);
                notes.push(Note::Named {
                    node: index,
                    name: name.clone(),
                });
                name
            })
        })
        .collect()
}

/// Priority for keeping a repeated name, ascending.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Rank {
    Other,
    Animated,
    Joint,
}

fn ranks(source: &GltfSource<'_>) -> Vec<Rank> {
    let mut ranks = vec![Rank::Other; source.root.nodes.len()];
    let mut raise = |node: usize, to: Rank| {
        if let Some(rank) = ranks.get_mut(node) {
            *rank = to.max(*rank);
        }
    };
    for channel in source
        .root
        .animations
        .iter()
        .flat_map(|animation| &animation.channels)
    {
        raise(channel.target.node.value(), Rank::Animated);
    }
    for joint in source.root.skins.iter().flat_map(|skin| &skin.joints) {
        raise(joint.value(), Rank::Joint);
    }
    ranks
}

/// Appends marks to a name until it is unused, and reserves it.
pub(super) fn free_name(mut name: String, used_names: &mut BTreeSet<String>) -> String {
    while !used_names.insert(name.clone()) {
        name.push('\'');
    }
    name
}

/// The nodes of the displayed scene: the scene that the file names, or else the first, or else all nodes.
fn in_scene(source: &GltfSource<'_>) -> Result<Vec<bool>, ReadError> {
    let (nodes, scenes) = (&source.root.nodes, &source.root.scenes);
    let scene_index = source.root.scene.map_or(0, |scene| scene.value());
    let Some(scene) = scenes.get(scene_index) else {
        if source.root.scene.is_some() {
            let problem = format!(
                "scene {scene_index} does not exist; there are {}",
                scenes.len()
            );
            return Err(source.fail("scene", problem));
        }
        return Ok(vec![true; nodes.len()]);
    };
    let mut seen = vec![false; nodes.len()];
    let mut stack = Vec::new();
    for (root_index, root) in scene.nodes.iter().enumerate() {
        if root.value() >= nodes.len() {
            let path = format!("scenes[{scene_index}].nodes[{root_index}]");
            return Err(missing_node(source, path, root.value()));
        }
        stack.push(root.value());
    }
    while let Some(index) = stack.pop() {
        if !std::mem::replace(&mut seen[index], true) {
            let children = nodes[index].children.iter().flatten();
            stack.extend(children.map(|child| child.value()));
        }
    }
    Ok(seen)
}
