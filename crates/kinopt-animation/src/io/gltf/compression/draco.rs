//! Primitives in Draco compression.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use draco_gltf::{
    ComponentType as DracoType, DecodeLimits, DracoPrimitiveContract, DracoPrimitiveExtension,
    JsonValue, PackedGeometry,
};
use gltf_json::accessor::{ComponentType, GenericComponentType, Type};
use gltf_json::buffer::View;
use gltf_json::mesh::Mode;
use gltf_json::validation::{Checked, USize64};
use gltf_json::{Accessor, Index, Root};

use super::decoded::{DecodedBuffer, slice};
use super::members::DracoPrimitive;
use crate::io::ReadError;

/// Smallest size of a decoded vertex or triangle, bytes: a bound of their number.
const MIN_ENTRY_BYTES: u64 = 12;

/// Accessors of a decoded primitive, by attribute.
struct DecodedAccessors {
    attributes: BTreeMap<String, Index<Accessor>>,
    indices: Option<Index<Accessor>>,
}

/// Decodes primitives, which then refer to accessors of the decoded values. Primitives with the same compressed bytes
/// share their accessors.
pub(super) fn decode(
    primitives: &[((usize, usize), &DracoPrimitive)],
    root: &mut Root,
    buffers: &[Cow<'_, [u8]>],
    decoded: &mut DecodedBuffer<'_>,
) -> Result<(), ReadError> {
    let mut by_view: BTreeMap<usize, DecodedAccessors> = BTreeMap::new();
    for &((mesh, number), draco) in primitives {
        let path = format!(
            "meshes[{mesh}].primitives[{number}].extensions.{}",
            super::DRACO
        );
        let accessors = match by_view.entry(draco.buffer_view) {
            Entry::Occupied(entry) => entry.into_mut(),
            Entry::Vacant(entry) => {
                let geometry = geometry(draco, root, buffers, decoded, &path)?;
                entry.insert(accessors(&geometry, root, decoded, &path)?)
            }
        };
        let entry = root.meshes.get_mut(mesh);
        let entry = entry.and_then(|mesh| mesh.primitives.get_mut(number));
        if let Some(primitive) = entry {
            for (semantic, accessor) in &mut primitive.attributes {
                if let Some(decoded) = accessors.attributes.get(&semantic.to_string()) {
                    *accessor = *decoded;
                }
            }
            primitive.indices = accessors.indices;
            primitive.mode = Checked::Valid(Mode::Triangles);
        }
    }
    Ok(())
}

fn geometry(
    draco: &DracoPrimitive,
    root: &Root,
    buffers: &[Cow<'_, [u8]>],
    decoded: &DecodedBuffer<'_>,
    path: &str,
) -> Result<PackedGeometry, ReadError> {
    let view = root.buffer_views.get(draco.buffer_view).ok_or_else(|| {
        let (view, views) = (draco.buffer_view, root.buffer_views.len());
        decoded.fail(path, format!("view {view} of {views} does not exist"))
    })?;
    let buffer = buffers.get(view.buffer.value());
    let offset = view.byte_offset.map_or(0, |offset| offset.0);
    let bytes = buffer.and_then(|bytes| slice(bytes, offset, view.byte_length.0));
    let bytes = bytes.ok_or_else(|| {
        let view = draco.buffer_view;
        decoded.fail(path, format!("view {view} exceeds its buffer"))
    })?;
    let attributes = draco.attributes.iter();
    let attributes =
        attributes.map(|(semantic, &id)| (semantic.clone(), JsonValue::from(u64::from(id))));
    let extension = JsonValue::object([
        ("bufferView", JsonValue::from(draco.buffer_view)),
        ("attributes", JsonValue::Object(attributes.collect())),
    ]);
    let remaining = decoded.remaining() as u64;
    let limits = DecodeLimits::default()
        .with_max_decoded_bytes(remaining)
        .with_max_points(remaining / MIN_ENTRY_BYTES)
        .with_max_faces(remaining / MIN_ENTRY_BYTES);
    let contract = DracoPrimitiveContract::new().with_limits(limits);
    let extension = DracoPrimitiveExtension::from_json(&extension);
    let geometry = extension.and_then(|extension| extension.decode(bytes, &contract));
    geometry.map_err(|error| decoded.fail(path, error.to_string()))
}

/// Appends the values of a decoded primitive, with their views and accessors.
fn accessors(
    geometry: &PackedGeometry,
    root: &mut Root,
    decoded: &mut DecodedBuffer<'_>,
    path: &str,
) -> Result<DecodedAccessors, ReadError> {
    let mut attributes = BTreeMap::new();
    for attribute in geometry.attributes() {
        let entries = match attribute.components() {
            1 => Type::Scalar,
            2 => Type::Vec2,
            3 => Type::Vec3,
            _ => Type::Vec4,
        };
        let Some(component) = component(attribute.component_type()) else {
            let semantic = attribute.semantic();
            return Err(decoded.fail(path, format!("{semantic}: unknown type of numbers")));
        };
        let kind = (component, entries, attribute.normalized());
        let added = append(
            attribute.bytes(),
            attribute.count(),
            kind,
            root,
            decoded,
            path,
        )?;
        attributes.insert(attribute.semantic().to_owned(), added);
    }
    let indices = geometry.indices().map(|indices| {
        let component = component(indices.component_type()).unwrap_or(ComponentType::U32);
        let kind = (component, Type::Scalar, false);
        append(indices.bytes(), indices.count(), kind, root, decoded, path)
    });
    Ok(DecodedAccessors {
        attributes,
        indices: indices.transpose()?,
    })
}

fn append(
    bytes: &[u8],
    count: usize,
    (component, entries, normalized): (ComponentType, Type, bool),
    root: &mut Root,
    decoded: &mut DecodedBuffer<'_>,
    path: &str,
) -> Result<Index<Accessor>, ReadError> {
    let offset = decoded.reserve(bytes.len(), path)?;
    decoded.bytes_from(offset).copy_from_slice(bytes);
    let mut view = View {
        buffer: Index::new(0),
        byte_length: USize64(0),
        byte_offset: None,
        byte_stride: None,
        name: None,
        target: None,
        extensions: None,
        extras: None,
    };
    decoded.place(&mut view, offset);
    let view = root.push(view);
    Ok(root.push(Accessor {
        buffer_view: Some(view),
        byte_offset: None,
        count: USize64(count as u64),
        component_type: Checked::Valid(GenericComponentType(component)),
        extensions: None,
        extras: None,
        type_: Checked::Valid(entries),
        min: None,
        max: None,
        name: None,
        normalized,
        sparse: None,
    }))
}

/// The type of numbers of glTF 2.0; `None` for types of later versions.
fn component(draco: DracoType) -> Option<ComponentType> {
    Some(match draco {
        DracoType::I8 => ComponentType::I8,
        DracoType::U8 => ComponentType::U8,
        DracoType::I16 => ComponentType::I16,
        DracoType::U16 => ComponentType::U16,
        DracoType::U32 => ComponentType::U32,
        DracoType::F32 => ComponentType::F32,
        _ => return None,
    })
}
