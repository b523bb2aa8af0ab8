//! Members of a document that describe compression.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::super::document::MESHOPT;

/// Members of a document that describe compression. Others are ignored.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct CompressedMembers {
    #[serde(default)]
    buffers: Vec<Extended<BufferExtensions>>,
    #[serde(default)]
    buffer_views: Vec<Extended<ViewExtensions>>,
    #[serde(default)]
    meshes: Vec<MeshMember>,
}

#[derive(Deserialize)]
struct Extended<E> {
    extensions: Option<E>,
}

#[derive(Deserialize)]
struct BufferExtensions {
    #[serde(rename = "EXT_meshopt_compression")]
    ext: Option<FallbackBuffer>,
    #[serde(rename = "KHR_meshopt_compression")]
    khr: Option<FallbackBuffer>,
}

#[derive(Deserialize)]
struct FallbackBuffer {
    #[serde(default)]
    fallback: bool,
}

#[derive(Deserialize)]
struct ViewExtensions {
    #[serde(rename = "EXT_meshopt_compression")]
    ext: Option<MeshoptView>,
    #[serde(rename = "KHR_meshopt_compression")]
    khr: Option<MeshoptView>,
}

/// Compressed bytes of a buffer view.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct MeshoptView {
    pub(super) buffer: usize,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) byte_length: u64,
    pub(super) byte_stride: usize,
    pub(super) count: usize,
    pub(super) mode: String,
    pub(super) filter: Option<String>,
}

#[derive(Deserialize)]
struct MeshMember {
    #[serde(default)]
    primitives: Vec<Extended<PrimitiveExtensions>>,
}

#[derive(Deserialize)]
struct PrimitiveExtensions {
    #[serde(rename = "KHR_draco_mesh_compression")]
    draco: Option<DracoPrimitive>,
}

/// Compressed attributes and indices of a primitive.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
#[cfg_attr(
    not(feature = "draco"),
    expect(dead_code, reason = "read by the decoder")
)]
pub(super) struct DracoPrimitive {
    pub(super) buffer_view: usize,
    /// Identifier of each attribute in the compressed bytes.
    pub(super) attributes: BTreeMap<String, u32>,
}

impl CompressedMembers {
    /// Reports whether a buffer only reserves the size of decoded bytes. It has no contents of its own.
    pub(crate) fn is_fallback(&self, buffer: usize) -> bool {
        let buffer = self.buffers.get(buffer);
        let extensions = buffer.and_then(|buffer| buffer.extensions.as_ref());
        extensions.is_some_and(|extensions| {
            let mut marks = [&extensions.ext, &extensions.khr].into_iter().flatten();
            marks.any(|mark| mark.fallback)
        })
    }

    /// Compressed buffer views, each with its index and the name of its extension.
    pub(super) fn meshopt_views(&self) -> impl Iterator<Item = (usize, &str, &MeshoptView)> {
        let [ext_name, khr_name] = MESHOPT;
        let views = self.buffer_views.iter().enumerate();
        views.filter_map(move |(index, view)| {
            let extensions = view.extensions.as_ref()?;
            let khr = extensions.khr.as_ref().map(|view| (index, khr_name, view));
            khr.or_else(|| Some((index, ext_name, extensions.ext.as_ref()?)))
        })
    }

    /// Compressed primitives, each with its (mesh, primitive).
    pub(super) fn draco_primitives(
        &self,
    ) -> impl Iterator<Item = ((usize, usize), &DracoPrimitive)> {
        let meshes = self.meshes.iter().enumerate();
        meshes.flat_map(|(mesh_index, mesh)| {
            let primitives = mesh.primitives.iter().enumerate();
            primitives.filter_map(move |(index, primitive)| {
                let draco = primitive.extensions.as_ref()?.draco.as_ref()?;
                Some(((mesh_index, index), draco))
            })
        })
    }
}
