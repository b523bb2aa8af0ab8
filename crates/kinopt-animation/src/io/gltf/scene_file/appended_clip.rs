//! Appending a clip to the document of a file.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gltf_json::validation::USize64;
use gltf_json::{Index, Root};

use super::json_edit::Members;
use super::{Container, set_transform};
use crate::animation::LocalTransform;
use crate::io::gltf::write::{ClipDocument, UnwritableScene};
use kinopt_kinematics::skeleton::BoneId;

/// Appends a document of one clip to another document. `bone_of` is the bone of each node.
pub(super) fn join(
    added: ClipDocument,
    bone_of: &[BoneId],
    document: &mut Members,
    container: &mut Container,
) -> Result<(), UnwritableScene> {
    let ClipDocument {
        mut root,
        bytes,
        rest,
    } = added;
    if root.animations.is_empty() {
        return Ok(());
    }
    let [accessors, views] = ["accessors", "bufferViews"].map(|list| document.list(list));
    let (accessors, views) = (accessors?.len(), views?.len());
    let (buffer, start) = add_bytes(&bytes, document, container)?;
    let mut node_of: Vec<usize> = (0..bone_of.len()).collect();
    node_of.sort_by_key(|&node| bone_of.get(node));
    move_indices(&mut root, [accessors, views, buffer], start, &node_of);
    document.append("accessors", &root.accessors)?;
    document.append("bufferViews", &root.buffer_views)?;
    document.append("animations", &root.animations)?;
    // An animated node may not have a matrix (section 3.11).
    let channels = root
        .animations
        .iter()
        .flat_map(|animation| &animation.channels);
    let moved: std::collections::BTreeSet<usize> = channels
        .map(|channel| channel.target.node.value())
        .collect();
    let rest_of = |node: usize| -> Option<LocalTransform> {
        let bone = bone_of.get(node)?;
        rest.get(bone.index()).copied()
    };
    document.change_each("nodes", |node, members| {
        let has_matrix = moved.contains(&node) && members.get("matrix").is_some();
        match rest_of(node).filter(|_| has_matrix) {
            Some(transform) => set_transform(members, transform).map(|()| true),
            None => Ok(false),
        }
    })?;
    Ok(())
}

/// Appends bytes to a buffer. Returns the index of the buffer and the offset of the bytes.
fn add_bytes(
    bytes: &[u8],
    document: &mut Members,
    container: &mut Container,
) -> Result<(usize, usize), UnwritableScene> {
    let buffers: Vec<Members> =
        serde_json::from_str(document.get("buffers").map_or("[]", |list| list.get()))?;
    // The binary chunk is the first buffer if that has no uri (section 4.4.3.3).
    let first_is_chunk = buffers
        .first()
        .is_none_or(|first| first.get("uri").is_none());
    match container {
        Container::Binary { buffer, .. } if first_is_chunk => {
            let start = buffer.len().next_multiple_of(4);
            buffer.resize(start, 0);
            buffer.extend_from_slice(bytes);
            let length = buffer.len();
            match buffers.is_empty() {
                true => {
                    let mut first = Members::default();
                    first.set("byteLength", &length)?;
                    document.append("buffers", &[first])?;
                }
                false => document.change_each("buffers", |index, members| match index {
                    0 => members.set("byteLength", &length).map(|()| true),
                    _ => Ok(false),
                })?,
            }
            Ok((0, start))
        }
        _ => {
            let mut new_buffer = Members::default();
            new_buffer.set("byteLength", &bytes.len())?;
            new_buffer.set("uri", &data_uri(bytes))?;
            Ok((document.append("buffers", &[new_buffer])?, 0))
        }
    }
}

/// Moves the binary chunk into the text, if the first buffer refers to it.
pub(super) fn move_to_text(chunk: &[u8], document: &mut Members) -> serde_json::Result<()> {
    document.change_each("buffers", |index, members| {
        let is_chunk = index == 0 && members.get("uri").is_none();
        if is_chunk {
            members.set("uri", &data_uri(chunk))?;
        }
        Ok(is_chunk)
    })
}

fn data_uri(bytes: &[u8]) -> String {
    format!(
        "data:application/octet-stream;base64,{}",
        STANDARD.encode(bytes)
    )
}

/// Shifts indices by the given numbers of accessors, views and buffers, and buffer offsets by `start`. Maps bones to
/// nodes.
fn move_indices(
    root: &mut Root,
    [accessors, views, buffer]: [usize; 3],
    start: usize,
    node_of: &[usize],
) {
    fn shift<T>(index: &mut Index<T>, offset: usize) {
        *index = Index::new((index.value() + offset) as u32);
    }
    for animation in &mut root.animations {
        for channel in &mut animation.channels {
            let node = &mut channel.target.node;
            if let Some(&new_index) = node_of.get(node.value()) {
                *node = Index::new(new_index as u32);
            }
        }
        for sampler in &mut animation.samplers {
            shift(&mut sampler.input, accessors);
            shift(&mut sampler.output, accessors);
        }
    }
    for accessor in &mut root.accessors {
        if let Some(view) = &mut accessor.buffer_view {
            shift(view, views);
        }
    }
    for view in &mut root.buffer_views {
        shift(&mut view.buffer, buffer);
        let offset = view.byte_offset.unwrap_or(USize64(0)).0;
        view.byte_offset = Some(USize64(offset + start as u64));
    }
}
