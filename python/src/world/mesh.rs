//! Meshes from arrays or files.

use std::path::PathBuf;

use kinopt::collision::MeshFile;
use pyo3::prelude::*;

use super::vectors;
use crate::arrays;
use crate::error::{OrRaise, invalid};

/// Creates a mesh from vertices and triangles, or from a file.
pub(super) fn mesh(
    py: Python<'_>,
    vertices: &Bound<'_, PyAny>,
    triangles: Option<&Bound<'_, PyAny>>,
) -> PyResult<MeshFile> {
    match (vertices.extract::<PathBuf>(), triangles) {
        (Ok(file), None) => py.detach(|| MeshFile::read(file)).or_raise(),
        (Ok(_), Some(_)) => Err(invalid("triangles must be omitted for a mesh file")),
        (Err(_), None) => Err(invalid(
            "triangles are missing: a mesh is vertices and triangles, or a file",
        )),
        (Err(_), Some(triangles)) => {
            let mut mesh = MeshFile::default();
            mesh.points = vectors(vertices, "vertices")?;
            mesh.triangles = crate::vertices::triangles(triangles)?;
            Ok(mesh)
        }
    }
}

/// Reads scale factors along x, y and z.
pub(super) fn scale(value: Option<&Bound<'_, PyAny>>) -> PyResult<[f64; 3]> {
    let Some(value) = value else {
        return Ok([1.0; 3]);
    };
    match value.extract::<f64>() {
        Ok(factor) => Ok([factor; 3]),
        Err(_) => arrays::array(value, "scale"),
    }
}
