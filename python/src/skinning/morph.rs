//! Morph targets and blend shapes.

use std::sync::Arc;

use kinopt::glam::{Vec3, Vec4};
use kinopt::skinning::{BlendShapes as Shapes, MorphTarget as Target, MorphTargets as Targets};
use numpy::ndarray::Ix1;
use numpy::{PyArray1, PyArray2, PyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::arrays::{self, Numbers};
use crate::error::{OrRaise, invalid};
use crate::mesh::TriangleMesh;
use crate::pickling;
use crate::transforms::numbers;
use crate::vertices::{self, to_array, vectors, whole};

/// Sparse differences of one shape from the mesh at rest; float32, in the model's unit.
///
/// A target of sparse deltas: `vertices`, shape (N,), ascending, and for each of them `position_deltas`, shape (N, 3);
/// optionally `normal_deltas` and `tangent_deltas`, (N, 3).
///
/// Raises `InvalidValueError` for lists of different lengths, vertices that do not ascend and numbers that are not
/// finite.
#[pyclass(frozen, module = "kinopt.skinning")]
#[derive(Clone)]
pub(crate) struct MorphTarget {
    inner: Target,
}

#[pymethods]
impl MorphTarget {
    #[new]
    #[pyo3(signature = (name, vertices, position_deltas, normal_deltas = None, tangent_deltas = None))]
    fn new(
        name: String,
        vertices: &Bound<'_, PyAny>,
        position_deltas: &Bound<'_, PyAny>,
        normal_deltas: Option<&Bound<'_, PyAny>>,
        tangent_deltas: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let indices: Numbers<'_, Ix1, i64> = whole(vertices, "vertices", "one list of indices")?;
        let index = |&index: &i64| {
            u32::try_from(index).map_err(|_| invalid(format!("{index} is no index of a vertex")))
        };
        let indices = indices.iter().map(index).collect::<PyResult<_>>()?;
        let optional = |value: Option<&Bound<'_, PyAny>>, what: &str| match value {
            Some(value) => Ok(vectors(value, what)?.to_vec()),
            None => PyResult::Ok(Vec::new()),
        };
        let target = Target::new(
            name,
            indices,
            vectors(position_deltas, "position_deltas")?.to_vec(),
            optional(normal_deltas, "normal_deltas")?,
            optional(tangent_deltas, "tangent_deltas")?,
        );
        let inner = target.or_raise()?;
        Ok(Self { inner })
    }

    /// The target that changes the mesh `rest` into `shape` at weight 1. Vertices whose position and normal change by
    /// at most `threshold` (positions in the model's unit) are omitted.
    ///
    /// Raises `InvalidValueError` for meshes of different numbers of vertices and for a threshold below 0.
    #[classmethod]
    #[pyo3(signature = (name, rest, shape, threshold = 0.0))]
    fn between(
        _class: &Bound<'_, PyType>,
        name: String,
        rest: &Bound<'_, TriangleMesh>,
        shape: &Bound<'_, TriangleMesh>,
        threshold: f32,
    ) -> PyResult<Self> {
        let (rest, shape) = (&rest.get().inner, &shape.get().inner);
        let inner = Target::between(name, rest, shape, threshold).or_raise()?;
        Ok(Self { inner })
    }

    /// Name in clips and files.
    #[getter]
    fn name(&self) -> &str {
        self.inner.name()
    }

    /// Indices of its vertices, ascending, shape (N,), uint32.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        PyArray1::from_slice(py, self.inner.vertices())
    }

    /// Displacements of these vertices, shape (N, 3).
    #[getter]
    fn position_deltas<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        to_array(py, self.inner.position_deltas(), 3)
    }

    /// Changes of their normals, shape (N, 3); None if it does not change normals.
    #[getter]
    fn normal_deltas<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f32>>>> {
        optional_array(py, self.inner.normal_deltas())
    }

    /// Changes of their tangents, shape (N, 3); None if it does not change tangents.
    #[getter]
    fn tangent_deltas<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f32>>>> {
        optional_array(py, self.inner.tangent_deltas())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let parts = (
            self.name(),
            self.vertices(py),
            self.position_deltas(py)?,
            self.normal_deltas(py)?,
            self.tangent_deltas(py)?,
        );
        pickling::by_class::<Self>(py, parts)
    }

    fn __repr__(&self) -> String {
        format!(
            "MorphTarget({:?}, {} vertices)",
            self.inner.name(),
            self.inner.vertices().len()
        )
    }
}

fn optional_array<'py>(
    py: Python<'py>,
    deltas: &[Vec3],
) -> PyResult<Option<Bound<'py, PyArray2<f32>>>> {
    let array = (!deltas.is_empty()).then(|| to_array(py, deltas, 3));
    array.transpose()
}

/// Immutable list of the morph targets of one mesh.
///
/// Targets for a mesh of `vertex_count` vertices.
///
/// Raises `InvalidValueError` if a target has a vertex that does not exist.
#[pyclass(frozen, module = "kinopt.skinning")]
pub(crate) struct MorphTargets {
    pub(crate) inner: Arc<Targets>,
}

impl From<Targets> for MorphTargets {
    fn from(targets: Targets) -> Self {
        let inner = Arc::new(targets);
        Self { inner }
    }
}

#[pymethods]
impl MorphTargets {
    #[new]
    fn new(
        #[pyo3(from_py_with = crate::arrays::whole)] vertex_count: usize,
        targets: Vec<Bound<'_, MorphTarget>>,
    ) -> PyResult<Self> {
        let targets = targets.iter().map(|target| target.get().inner.clone());
        let targets = Targets::new(vertex_count, targets.collect());
        targets.or_raise().map(Self::from)
    }

    /// Targets, in the order of the weights.
    #[getter]
    fn targets(&self) -> Vec<MorphTarget> {
        let targets = self.inner.targets().iter();
        targets
            .map(|inner| MorphTarget {
                inner: inner.clone(),
            })
            .collect()
    }

    /// Names of the targets.
    #[getter]
    fn names(&self) -> Vec<&str> {
        self.inner.targets().iter().map(Target::name).collect()
    }

    /// Number of vertices of the mesh.
    #[getter]
    fn vertex_count(&self) -> usize {
        self.inner.vertex_count()
    }

    /// Adds the sum of the targets, by their `weights`, shape (targets,), to vertices at rest, in place. `positions`
    /// (V, 3), `normals` (V, 3) and `tangents` (V, 4) are float32 arrays in C order. Changed normals and tangents are
    /// normalised.
    ///
    /// Raises `InvalidValueError` for other shapes and for weights that are not finite; the arrays then do not change.
    #[pyo3(signature = (weights, positions = None, normals = None, tangents = None))]
    fn apply(
        &self,
        py: Python<'_>,
        weights: &Bound<'_, PyAny>,
        positions: Option<&Bound<'_, PyAny>>,
        normals: Option<&Bound<'_, PyAny>>,
        tangents: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let weights = numbers(weights, "weights", None)?;
        let vertices = self.inner.vertex_count();
        // A missing buffer has no vertices.
        let output = |buffer: Option<&Bound<'_, PyAny>>, columns: usize| {
            let rows = if buffer.is_some() { vertices } else { 0 };
            arrays::output_array::<f32>(py, buffer, &[rows, columns]).map(Bound::unbind)
        };
        let (positions, normals, signed) = (
            output(positions, 3)?,
            output(normals, 3)?,
            output(tangents, 4)?,
        );
        vertices::fill(positions.bind(py), |positions| {
            vertices::fill(normals.bind(py), |normals| {
                arrays::fill(signed.bind(py), |signed| {
                    let mut tangents: Vec<Vec4> =
                        signed.chunks_exact(4).map(Vec4::from_slice).collect();
                    let apply = || {
                        self.inner
                            .apply(&weights, positions, normals, &mut tangents)
                    };
                    py.detach(apply).or_raise()?;
                    for (tangent, components) in tangents.iter().zip(signed.chunks_exact_mut(4)) {
                        components.copy_from_slice(&tangent.to_array());
                    }
                    Ok(())
                })
            })
        })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let parts = (self.inner.vertex_count(), self.targets());
        pickling::by_class::<Self>(py, parts)
    }

    fn __repr__(&self) -> String {
        format!("MorphTargets({})", self.names().join(", "))
    }
}

/// Key shapes of one mesh, each with a position for every vertex: a mesh is their weighted mean.
///
/// Key shapes: {name: positions}, each of shape (V, 3), in the model's unit.
///
/// Raises `InvalidValueError` without a shape, for different counts, and for positions that are not finite.
#[pyclass(frozen, module = "kinopt.skinning")]
pub(crate) struct BlendShapes {
    inner: Shapes,
    /// Positions by shape, for pickling.
    shapes: Vec<(String, Vec<Vec3>)>,
}

#[pymethods]
impl BlendShapes {
    #[new]
    fn new(shapes: &Bound<'_, pyo3::types::PyDict>) -> PyResult<Self> {
        let mut read = Vec::new();
        for (name, positions) in shapes {
            let name = arrays::name(&name, "a shape")?;
            let positions = vectors(&positions, &name)?.to_vec();
            read.push((name, positions));
        }
        let inner = Shapes::new(read.clone()).or_raise()?;
        Ok(Self {
            inner,
            shapes: read,
        })
    }

    /// Names of the shapes, in the order of the weights.
    #[getter]
    fn names(&self) -> Vec<String> {
        self.inner.names().to_vec()
    }

    /// Number of vertices of each shape.
    #[getter]
    fn vertex_count(&self) -> usize {
        self.inner.vertex_count()
    }

    /// Weighted mean of the shapes, shape (V, 3), float32. `weights`, shape (shapes,), must sum to 1 within 1e-5;
    /// negative ones exaggerate. `out` receives the result.
    ///
    /// Raises `InvalidValueError` for other weights.
    #[pyo3(signature = (weights, *, out = None))]
    fn blend<'py>(
        &self,
        py: Python<'py>,
        weights: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let weights = numbers(weights, "weights", None)?;
        let array = arrays::output_array::<f32>(py, out, &[self.inner.vertex_count(), 3])?;
        vertices::fill(&array, |buffer| {
            py.detach(|| self.inner.blend(&weights, buffer)).or_raise()
        })?;
        Ok(array)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let shapes = pyo3::types::PyDict::new(py);
        for (name, positions) in &self.shapes {
            shapes.set_item(name, to_array(py, positions, 3)?)?;
        }
        pickling::by_class::<Self>(py, (shapes,))
    }

    fn __repr__(&self) -> String {
        format!("BlendShapes({})", self.inner.names().join(", "))
    }
}
