//! Buffer views in meshopt compression.

use std::borrow::Cow;

use draco_gltf::meshopt::{MeshoptFilter, MeshoptMode, decode_buffer_view};
use gltf_json::Root;

use super::decoded::{DecodedBuffer, slice};
use super::members::MeshoptView;
use crate::io::ReadError;

/// Decodes the buffer view `index` of `root`, which then refers to the decoded bytes. `path` is that of the compressed
/// view in the document.
pub(super) fn decode(
    meshopt: &MeshoptView,
    (index, path): (usize, &str),
    root: &mut Root,
    buffers: &[Cow<'_, [u8]>],
    decoded: &mut DecodedBuffer<'_>,
) -> Result<(), ReadError> {
    let Some(view) = root.buffer_views.get_mut(index) else {
        return Ok(());
    };
    let buffer = buffers.get(meshopt.buffer);
    let source = buffer.and_then(|bytes| slice(bytes, meshopt.byte_offset, meshopt.byte_length));
    let Some(source) = source else {
        let (buffer, length) = (meshopt.buffer, meshopt.byte_length);
        let problem = format!(
            "{length} bytes from {} exceed buffer {buffer}",
            meshopt.byte_offset
        );
        return Err(decoded.fail(path, problem));
    };
    let mode = MeshoptMode::from_name(&meshopt.mode);
    let mode = mode.map_err(|error| decoded.fail(path, error.to_string()))?;
    let filter = MeshoptFilter::from_name(meshopt.filter.as_deref().unwrap_or("NONE"));
    let filter = filter.map_err(|error| decoded.fail(path, error.to_string()))?;
    let (count, stride) = (meshopt.count, meshopt.byte_stride);
    let Some(length) = count.checked_mul(stride) else {
        let problem = format!("{count} entries of {stride} bytes are too many");
        return Err(decoded.fail(path, problem));
    };
    let offset = decoded.reserve(length, path)?;
    let bytes = decoded.bytes_from(offset);
    decode_buffer_view(bytes, source, mode, filter, count, stride)
        .map_err(|error| decoded.fail(path, error.to_string()))?;
    decoded.place(view, offset);
    Ok(())
}
