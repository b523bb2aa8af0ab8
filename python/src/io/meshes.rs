//! Meshes: PLY, OBJ and GLB.

use std::path::PathBuf;

use kinopt::io::ply::PlyEncoding;
use kinopt::io::{gltf, obj, ply};
use kinopt::model::UnknownName;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::error::OrRaise;
use crate::mesh::TriangleMesh;

fn encoding(name: &str) -> PyResult<PlyEncoding> {
    let names = [
        ("text", PlyEncoding::Ascii),
        ("binary", PlyEncoding::BinaryLittleEndian),
        ("binary_big_endian", PlyEncoding::BinaryBigEndian),
    ];
    let entry = names.iter().find(|(word, _)| *word == name);
    entry
        .map(|(_, encoding)| *encoding)
        .ok_or_else(|| UnknownName::new("encoding", name, names.map(|(word, _)| word)))
        .or_raise()
}

/// Reads a PLY file: a `TriangleMesh`; polygons become triangle fans.
///
/// Raises `FileError` if it cannot be opened, `InvalidFileError` with the position in it.
#[pyfunction]
pub(crate) fn ply_read(py: Python<'_>, path: PathBuf) -> PyResult<TriangleMesh> {
    let mesh = py.detach(|| ply::read(&path));
    mesh.or_raise().map(TriangleMesh::from)
}

/// Reads the bytes of a PLY file; `name` is its name in messages.
///
/// Raises `InvalidFileError` with the position in them.
#[pyfunction]
#[pyo3(signature = (data, name = "mesh.ply"))]
pub(crate) fn ply_from_bytes(data: &[u8], name: &str) -> PyResult<TriangleMesh> {
    ply::from_bytes(data, name)
        .or_raise()
        .map(TriangleMesh::from)
}

/// The bytes of a PLY file; `encoding` is "binary", "binary_big_endian" or "text".
///
/// Raises `UnknownNameError` for another encoding.
#[pyfunction]
#[pyo3(name = "ply_to_bytes", signature = (mesh, encoding = "binary"))]
pub(crate) fn ply_to_bytes<'py>(
    mesh: &Bound<'py, TriangleMesh>,
    encoding: &str,
) -> PyResult<Bound<'py, PyBytes>> {
    let encoding = self::encoding(encoding)?;
    Ok(PyBytes::new(
        mesh.py(),
        &ply::to_bytes(&mesh.get().inner, encoding),
    ))
}

/// Writes a PLY file; `encoding` is "binary", "binary_big_endian" or "text".
///
/// Raises `FileError`.
#[pyfunction]
#[pyo3(signature = (mesh, path, encoding = "binary"))]
pub(crate) fn ply_write(
    mesh: &Bound<'_, TriangleMesh>,
    path: PathBuf,
    encoding: &str,
) -> PyResult<()> {
    let (encoding, inner) = (self::encoding(encoding)?, &mesh.get().inner);
    mesh.py()
        .detach(|| ply::write(inner, encoding, &path))
        .or_raise()
}

/// A mesh as the text of a Wavefront OBJ file.
#[pyfunction]
pub(crate) fn obj_to_text(mesh: &Bound<'_, TriangleMesh>) -> String {
    obj::to_text(&mesh.get().inner)
}

/// Writes a Wavefront OBJ file.
///
/// Raises `FileError`.
#[pyfunction]
pub(crate) fn obj_write(mesh: &Bound<'_, TriangleMesh>, path: PathBuf) -> PyResult<()> {
    let inner = &mesh.get().inner;
    mesh.py().detach(|| obj::write(inner, &path)).or_raise()
}

/// The bytes of a .glb file of a static mesh, such as a posed one.
///
/// Raises `InvalidValueError` for a mesh without vertices or triangles.
#[pyfunction]
pub(crate) fn gltf_mesh_to_bytes<'py>(
    mesh: &Bound<'py, TriangleMesh>,
) -> PyResult<Bound<'py, PyBytes>> {
    let bytes = gltf::mesh_to_bytes(&mesh.get().inner).or_raise()?;
    Ok(PyBytes::new(mesh.py(), &bytes))
}

/// Writes a static mesh to a file, which should end in .glb.
///
/// Raises `FileError`, `InvalidValueError` for a mesh without vertices or triangles.
#[pyfunction]
pub(crate) fn gltf_write_mesh(mesh: &Bound<'_, TriangleMesh>, path: PathBuf) -> PyResult<()> {
    let inner = &mesh.get().inner;
    mesh.py()
        .detach(|| gltf::write_mesh(inner, &path))
        .or_raise()
}
