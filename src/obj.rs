//! Wavefront OBJ meshes (writing only).

use std::fmt::Write;
use std::path::Path;

use crate::file::WriteError;
use crate::file_replacement::write_file;
use crate::mesh::TriangleMesh;

/// The mesh as OBJ text: `v`, `vn` if there are normals, and `f` with indices from 1. Numbers have as many digits as an
/// exact round trip of `f32` needs.
#[must_use]
pub fn to_text(mesh: &TriangleMesh) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    for p in mesh.positions() {
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for n in mesh.normals() {
        let _ = writeln!(text, "vn {} {} {}", n.x, n.y, n.z);
    }
    let with_normals = !mesh.normals().is_empty();
    for triangle in mesh.triangles() {
        // u64, because the largest u32 index plus one overflows u32.
        let [a, b, c] = triangle.map(|index| u64::from(index) + 1);
        let _ = if with_normals {
            writeln!(text, "f {a}//{a} {b}//{b} {c}//{c}")
        } else {
            writeln!(text, "f {a} {b} {c}")
        };
    }
    text
}

/// Writes [`to_text`] to a file.
///
/// # Errors
/// A [`WriteError`] that names the file.
pub fn write(mesh: &TriangleMesh, path: impl AsRef<Path>) -> Result<(), WriteError> {
    write_file(path.as_ref(), to_text(mesh).as_bytes())
}
