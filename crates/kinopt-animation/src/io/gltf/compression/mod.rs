//! Compressed geometry, decoded into one additional buffer to which views and accessors then refer.
//!
//! - meshopt (`EXT_meshopt_compression`, `KHR_meshopt_compression`) compresses the bytes of buffer views: vertices,
//!   indices, morph targets and keys.
//! - Draco (`KHR_draco_mesh_compression`) compresses the attributes and indices of primitives. Decoding needs the
//!   feature `draco`. Without it, compressed primitives are left out.

mod decoded;
#[cfg(feature = "draco")]
mod draco;
mod members;
mod meshopt;

use std::borrow::Cow;
use std::collections::BTreeSet;

use gltf_json::Root;
use gltf_json::mesh::Primitive;

use self::decoded::DecodedBuffer;
pub(super) use self::members::CompressedMembers;
use self::members::DracoPrimitive;
use super::document::{DRACO, MESHOPT};
use crate::io::ReadError;

/// The reason why a compressed primitive is left out.
pub(super) const UNDECODED: &str = "a primitive in Draco compression (the feature `draco` of kinopt decodes it; \
    `npx @gltf-transform/cli copy IN.glb OUT.glb` writes a file without it)";

/// Primitives that cannot be decoded, as (mesh, primitive).
pub(super) type Undecoded = BTreeSet<(usize, usize)>;

/// Reads the compressed members of a document; `None` if it uses no compression.
pub(super) fn members(
    root: &Root,
    json: &[u8],
    name: &str,
) -> Result<Option<CompressedMembers>, ReadError> {
    let mut used = root.extensions_used.iter().chain(&root.extensions_required);
    let is_compressed = used.any(|used| used == DRACO || MESHOPT.contains(&used.as_str()));
    let members = is_compressed.then(|| kinopt_mesh::json::parse(json, name));
    members.transpose()
}

/// Decodes compressed views and primitives into an additional buffer. `root` refers to it afterwards.
pub(super) fn decode(
    members: &CompressedMembers,
    root: &mut Root,
    buffers: &mut Vec<Cow<'_, [u8]>>,
    memory_limit: usize,
    name: &str,
) -> Result<Undecoded, ReadError> {
    let mut decoded = DecodedBuffer::new(name, buffers.len(), memory_limit);
    for (index, extension, view) in members.meshopt_views() {
        let path = format!("bufferViews[{index}].extensions.{extension}");
        meshopt::decode(view, (index, &path), root, buffers, &mut decoded)?;
    }
    let mut primitives = Vec::new();
    for ((mesh, primitive), draco) in members.draco_primitives() {
        let entry = root.meshes.get(mesh);
        let entry = entry.and_then(|mesh| mesh.primitives.get(primitive));
        if entry.is_some_and(|entry| needs_decoding(entry, draco, root)) {
            primitives.push(((mesh, primitive), draco));
        }
    }
    #[cfg(feature = "draco")]
    let undecoded =
        draco::decode(&primitives, root, buffers, &mut decoded).map(|()| Undecoded::new())?;
    #[cfg(not(feature = "draco"))]
    let undecoded = primitives.into_iter().map(|(place, _)| place).collect();
    buffers.push(decoded.into_bytes().into());
    Ok(undecoded)
}

/// Returns `true` if a compressed attribute has no uncompressed copy in the file.
fn needs_decoding(primitive: &Primitive, draco: &DracoPrimitive, root: &Root) -> bool {
    let mut compressed = primitive.attributes.iter().filter(|(semantic, _)| {
        let semantic = semantic.to_string();
        draco.attributes.contains_key(&semantic)
    });
    compressed.any(|(_, accessor)| {
        let accessor = root.accessors.get(accessor.value());
        accessor.is_some_and(|accessor| accessor.buffer_view.is_none())
    })
}
