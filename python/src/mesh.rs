//! Triangle meshes: arrays of float32 and uint32.

use std::sync::Arc;

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

use crate::error::OrRaise;
use crate::pickling;
use crate::vertices::{into_array, to_array, vectors};

/// Immutable triangle mesh whose indices are in range and whose numbers are finite.
///
/// Positions are in the unit of the model (metres for robots). Triangles are counter-clockwise seen from outside.
///
/// A mesh of `positions`, shape (V, 3), `triangles`, shape (F, 3), whole numbers from 0, and `normals`, shape (V, 3),
/// of any length, or None.
///
/// Raises `InvalidValueError` if a number is not finite, an index is out of range or counts disagree.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct TriangleMesh {
    pub(crate) inner: Arc<kinopt::mesh::TriangleMesh>,
    // Created at the first access, then shared.
    positions: PyOnceLock<Py<PyArray2<f32>>>,
    normals: PyOnceLock<Py<PyArray2<f32>>>,
    triangles: PyOnceLock<Py<PyArray2<u32>>>,
}

impl From<Arc<kinopt::mesh::TriangleMesh>> for TriangleMesh {
    fn from(inner: Arc<kinopt::mesh::TriangleMesh>) -> Self {
        Self {
            inner,
            positions: PyOnceLock::new(),
            normals: PyOnceLock::new(),
            triangles: PyOnceLock::new(),
        }
    }
}

impl From<kinopt::mesh::TriangleMesh> for TriangleMesh {
    fn from(mesh: kinopt::mesh::TriangleMesh) -> Self {
        Arc::new(mesh).into()
    }
}

#[pymethods]
impl TriangleMesh {
    #[new]
    #[pyo3(signature = (positions, triangles, normals = None))]
    fn new(
        positions: &Bound<'_, PyAny>,
        triangles: &Bound<'_, PyAny>,
        normals: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let positions = vectors(positions, "positions")?.to_vec();
        let normals = match normals {
            Some(normals) => vectors(normals, "normals")?.to_vec(),
            None => Vec::new(),
        };
        let triangles = crate::vertices::triangles(triangles)?;
        let mesh = kinopt::mesh::TriangleMesh::new(positions, normals, triangles);
        mesh.or_raise().map(Self::from)
    }

    /// Positions of the vertices, shape (V, 3), float32, in the unit of the model; read-only.
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let array = self
            .positions
            .get_or_try_init(py, || read_only(to_array(py, self.inner.positions(), 3)?));
        Ok(array?.bind(py).clone())
    }

    /// Normals of the vertices as given, shape (V, 3), float32, read-only; None without normals.
    #[getter]
    fn normals<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f32>>>> {
        if self.inner.normals().is_empty() {
            return Ok(None);
        }
        let array = self
            .normals
            .get_or_try_init(py, || read_only(to_array(py, self.inner.normals(), 3)?));
        Ok(Some(array?.bind(py).clone()))
    }

    /// Vertex indices of the triangles from 0, shape (F, 3), uint32, read-only.
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let array = self.triangles.get_or_try_init(py, || {
            let corners: &[u32] = bytemuck::cast_slice(self.inner.triangles());
            let array = PyArray1::from_slice(py, corners);
            read_only(array.reshape([self.inner.triangles().len(), 3])?)
        });
        Ok(array?.bind(py).clone())
    }

    /// The mesh with other positions, shape (V, 3), and normals, shape (V, 3) or None.
    ///
    /// Raises `InvalidValueError` for another number of vertices and for numbers that are not finite.
    #[pyo3(signature = (positions, normals = None))]
    fn with_vertices(
        &self,
        positions: &Bound<'_, PyAny>,
        normals: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let positions = vectors(positions, "positions")?.to_vec();
        let normals = match normals {
            Some(normals) => vectors(normals, "normals")?.to_vec(),
            None => Vec::new(),
        };
        let mesh = self.inner.with_vertices(positions, normals);
        mesh.or_raise().map(Self::from)
    }

    /// This mesh with its normals replaced by `vertex_normals()`.
    fn with_computed_normals(&self) -> Self {
        let mesh = kinopt::mesh::TriangleMesh::clone(&self.inner);
        mesh.with_computed_normals().into()
    }

    /// Unit vertex normals, shape (V, 3), float32: the sum of the normals of adjacent triangles, weighted by area. Zero
    /// for a vertex without triangles, or with triangles of zero area only.
    fn vertex_normals<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        into_array(py, self.inner.vertex_normals())
    }

    /// Lowest and highest corner of the bounding box of all vertices, shape (2, 3), float32; None without vertices.
    fn bounding_box<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f32>>>> {
        let corners = self.inner.bounding_box();
        corners.map(|corners| to_array(py, &corners, 3)).transpose()
    }

    /// Diagonal of the bounding box, in the unit of the model; 0 without vertices.
    #[getter]
    fn size(&self) -> f64 {
        self.inner.size()
    }

    /// True if the triangles bound a solid consistently: every directed edge occurs once, and so does its opposite.
    fn is_closed(&self) -> bool {
        self.inner.is_closed()
    }

    /// Enclosed volume in cubic units: positive if triangles are counter-clockwise seen from outside. Only meaningful
    /// for closed meshes.
    fn signed_volume(&self) -> f64 {
        self.inner.signed_volume()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let parts = (self.positions(py)?, self.triangles(py)?, self.normals(py)?);
        pickling::by_class::<Self>(py, parts)
    }

    fn __repr__(&self) -> String {
        format!(
            "TriangleMesh({}, {}{})",
            kinopt::counted(self.inner.positions().len(), "vertex"),
            kinopt::counted(self.inner.triangles().len(), "triangle"),
            if self.inner.normals().is_empty() {
                ""
            } else {
                ", with normals"
            }
        )
    }
}

/// Read-only array.
fn read_only<T: numpy::Element>(array: Bound<'_, PyArray2<T>>) -> PyResult<Py<PyArray2<T>>> {
    array
        .getattr("flags")?
        .setattr("writeable", false)
        .map(|()| array.unbind())
}
