//! Triangles of a primitive: indexed or not, with strips and fans split.

use gltf_json::mesh::{Mode, Primitive};
use gltf_json::validation::Checked;

use super::raw_mesh::RawMesh;
use super::source::GltfSource;
use crate::io::ReadError;

/// The mode of a primitive of points or lines; `None` for triangles and unknown modes.
pub(super) fn without_triangles(primitive: &Primitive) -> Option<Mode> {
    match primitive.mode {
        Checked::Valid(Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) => None,
        Checked::Valid(mode) => Some(mode),
        Checked::Invalid => None,
    }
}

/// Appends the triangles of a primitive whose `count` vertices start at `first`.
pub(super) fn append(
    source: &GltfSource<'_>,
    primitive: &Primitive,
    path: &str,
    user: &str,
    [first, count]: [usize; 2],
    raw: &mut RawMesh,
) -> Result<(), ReadError> {
    let mode = match primitive.mode {
        Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) => mode,
        _ => {
            let problem = format!("{user}: is drawn in an unknown mode");
            return Err(source.fail(format!("{path}.mode"), problem));
        }
    };
    let indices: Vec<u32> = match primitive.indices {
        Some(indices) => {
            let user = format!("{user}, indices");
            let read: Vec<[u32; 1]> = source.read_indices(indices, &user)?;
            read.into_iter().flatten().collect()
        }
        None => {
            source.charge::<u32>(count, path)?;
            (0..count as u32).collect()
        }
    };
    if let Some(index) = indices.iter().find(|&&index| index as usize >= count) {
        let problem = format!("{user}: index {index} is out of range; there are {count} vertices");
        return Err(source.fail(format!("{path}.indices"), problem));
    }
    if mode == Mode::Triangles && !indices.len().is_multiple_of(3) {
        let problem = format!("{user}: {} corners make no triangles", indices.len());
        return Err(source.fail(format!("{path}.indices"), problem));
    }
    source.charge::<[u32; 3]>(indices.len(), path)?;
    let offset = |triangle: [u32; 3]| triangle.map(|index| index + first as u32);
    let corners = |window: &[u32]| <[u32; 3]>::try_from(window).unwrap_or_default();
    match mode {
        Mode::Triangles => {
            raw.triangles
                .extend(indices.chunks_exact(3).map(corners).map(offset));
        }
        // Section 3.7.2.1. Degenerate triangles only stitch strips together.
        Mode::TriangleStrip => {
            let windows = indices.windows(3).map(corners).enumerate();
            let oriented = windows.map(|(number, [a, b, c])| match number % 2 {
                0 => [a, b, c],
                _ => [a, c, b],
            });
            let nondegenerate = oriented.filter(|[a, b, c]| a != b && b != c && c != a);
            raw.triangles.extend(nondegenerate.map(offset));
        }
        _ => {
            let hub = indices.first().copied().unwrap_or(0);
            let rim = indices.get(1..).unwrap_or(&[]).windows(2);
            let fan = rim.filter_map(|pair| Some([*pair.first()?, *pair.last()?, hub]));
            raw.triangles.extend(fan.map(offset));
        }
    }
    Ok(())
}
