//! Strided numbers in a buffer view, with checked offsets.

use gltf_json::Index;
use gltf_json::accessor::ComponentType;
use gltf_json::buffer::View;

use super::source::GltfSource;
use crate::io::{FileLocation, ReadError};

/// A strided sequence of entries in a buffer.
pub(super) struct AccessorView<'a> {
    bytes: &'a [u8],
    stride: usize,
    component: ComponentType,
    pub(super) normalized: bool,
}

impl GltfSource<'_> {
    /// A view of `count` entries of `N` numbers each.
    pub(super) fn accessor_view<const N: usize>(
        &self,
        view: Index<View>,
        offset: u64,
        count: usize,
        component: ComponentType,
        path: &str,
        user: &str,
    ) -> Result<AccessorView<'_>, ReadError> {
        let views = &self.root.buffer_views;
        let buffer_view = views.get(view.value()).ok_or_else(|| {
            let (view, views) = (view.value(), views.len());
            self.fail(
                path,
                format!("{user}: view {view} of {views} does not exist"),
            )
        })?;
        let key_path = |key: &str| format!("bufferViews[{}].{key}", view.value());
        let buffer = self
            .buffers
            .get(buffer_view.buffer.value())
            .ok_or_else(|| {
                let (buffer, buffers) = (buffer_view.buffer.value(), self.buffers.len());
                let problem = format!("{user}: buffer {buffer} of {buffers} does not exist");
                self.fail(key_path("buffer"), problem)
            })?;
        let start = buffer_view.byte_offset.map_or(0, |offset| offset.0);
        let view_bytes =
            slice(buffer, start, u128::from(buffer_view.byte_length.0)).ok_or_else(|| {
                let needed = u128::from(start) + u128::from(buffer_view.byte_length.0);
                let what = format!("{user}: the view's bytes");
                let location = FileLocation::Json(key_path("byteLength"));
                ReadError::truncated(self.name, location, what, needed, buffer.len())
            })?;
        let size = N * component.size();
        let stride = buffer_view.byte_stride.map_or(size, |stride| stride.0);
        if stride < size {
            let problem = format!("{user}: {stride} is less than the {size} bytes of an entry");
            return Err(self.fail(key_path("byteStride"), problem));
        }
        let needed = (count as u128 - 1) * stride as u128 + size as u128;
        let bytes = slice(view_bytes, offset, needed).ok_or_else(|| {
            let what = format!("{user}: {count} entries from byte {offset} of the view");
            let location = FileLocation::Json(path.into());
            ReadError::truncated(self.name, location, what, needed, view_bytes.len())
        })?;
        Ok(AccessorView {
            bytes,
            stride,
            component,
            normalized: false,
        })
    }
}

fn slice(bytes: &[u8], start: u64, length: u128) -> Option<&[u8]> {
    let end = usize::try_from(u128::from(start).checked_add(length)?).ok()?;
    bytes.get(usize::try_from(start).ok()?..end)
}

impl AccessorView<'_> {
    pub(super) fn entry<const N: usize>(&self, index: usize) -> [f64; N] {
        let size = self.component.size();
        std::array::from_fn(|component| {
            let start = index * self.stride + component * size;
            let bytes = self.bytes.get(start..start + size).unwrap_or(&[0; 4]);
            self.number(bytes)
        })
    }

    fn number(&self, bytes: &[u8]) -> f64 {
        let [a, b, c, d] = std::array::from_fn(|byte| bytes.get(byte).copied().unwrap_or(0));
        let (short, word) = ([a, b], [a, b, c, d]);
        let (number, max) = match self.component {
            ComponentType::I8 => (f64::from(a as i8), 127.0),
            ComponentType::U8 => (f64::from(a), 255.0),
            ComponentType::I16 => (f64::from(i16::from_le_bytes(short)), 32767.0),
            ComponentType::U16 => (f64::from(u16::from_le_bytes(short)), 65535.0),
            ComponentType::U32 => (f64::from(u32::from_le_bytes(word)), f64::from(u32::MAX)),
            ComponentType::F32 => return f64::from(f32::from_le_bytes(word)),
        };
        match self.normalized {
            // Section 3.6.2.2: the lowest signed integer is −1 as well.
            true => (number / max).max(-1.0),
            false => number,
        }
    }
}
