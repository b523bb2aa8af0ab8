//! Sparse skin weights.

use std::sync::Arc;

use kinopt::skinning::{Influence, SkinWeights as Weights};
use numpy::ndarray::{Ix1, Ix2};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyType};

use crate::arrays::{self, Numbers};
use crate::error::{OrRaise, invalid};
use crate::pickling;
use crate::vertices::whole;

/// Sparse skin weights: any number of influences for each vertex, sorted by bone.
///
/// The weights of each vertex sum to 1; they are stored exactly as given.
///
/// Weights in coordinate form: vertex `vertices[i]` has the influence `weights[i]` of bone `bones[i]`, in any order:
/// three lists of shape (K,).
///
/// Raises `InvalidValueError` with the vertex and bone for a weight that is not finite or is below -1e-2, an index out
/// of range, a duplicate pair, and vertex weights that do not sum to 1 within 1e-5.
#[pyclass(frozen, module = "kinopt.skinning")]
pub(crate) struct SkinWeights {
    pub(crate) inner: Arc<Weights>,
}

impl From<Arc<Weights>> for SkinWeights {
    fn from(inner: Arc<Weights>) -> Self {
        Self { inner }
    }
}

impl From<Weights> for SkinWeights {
    fn from(weights: Weights) -> Self {
        Arc::new(weights).into()
    }
}

impl SkinWeights {
    fn all(&self) -> impl Iterator<Item = &Influence> {
        self.inner.iter().flatten()
    }
}

/// Limit on the number of bones, far above real skeletons: it bounds the memory for invalid input.
const MAX_BONES: usize = 1 << 20;

/// Reads vertices, bones and weights from three arrays.
fn collected(
    [vertices, bones]: [&Bound<'_, PyAny>; 2],
    weights: &Bound<'_, PyAny>,
    vertex_count: usize,
    bone_count: usize,
) -> PyResult<kinopt::skinning::SkinWeightsBuilder> {
    let expected = "one list of indices";
    let vertices: Numbers<'_, Ix1, i64> = whole(vertices, "vertices", expected)?;
    let bones: Numbers<'_, Ix1, i64> = whole(bones, "bones", expected)?;
    let weights = arrays::vector_of(weights, "weights", vertices.len())?;
    if bone_count > MAX_BONES {
        return Err(too_many(bone_count));
    }
    if bones.len() != vertices.len() {
        return Err(invalid(format!(
            "bones has shape ({},), expected ({},)",
            bones.len(),
            vertices.len()
        )));
    }
    let index = |what: &str, index: i64| {
        usize::try_from(index).map_err(|_| invalid(format!("{what} {index} is below 0")))
    };
    let mut builder = Weights::builder(vertex_count, bone_count);
    for ((&vertex, &bone), &weight) in vertices.iter().zip(&*bones).zip(&*weights) {
        let (vertex, bone) = (index("vertex", vertex)?, index("bone", bone)?);
        builder.add(vertex, bone, weight).or_raise()?;
    }
    Ok(builder)
}

fn too_many(bones: usize) -> PyErr {
    invalid(format!("{bones} bones, where there may be {MAX_BONES}"))
}

#[pymethods]
impl SkinWeights {
    #[new]
    fn new(
        vertices: &Bound<'_, PyAny>,
        bones: &Bound<'_, PyAny>,
        weights: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = crate::arrays::whole)] vertex_count: usize,
        #[pyo3(from_py_with = crate::arrays::whole)] bone_count: usize,
    ) -> PyResult<Self> {
        let builder = collected([vertices, bones], weights, vertex_count, bone_count)?;
        builder.build().or_raise().map(Self::from)
    }

    /// As the constructor, but with repairs: negative weights become zero, and weights that do not sum to 1 are divided
    /// by their sum.
    ///
    /// Returns the weights and a report: {"negative": number of weights set to zero, "rescaled": number of rescaled
    /// vertices, "worst": (vertex, sum) with the sum farthest from 1, or None}.
    ///
    /// Raises `InvalidValueError` for other defects: an index out of range, a duplicate pair, a vertex without any
    /// weight.
    #[classmethod]
    fn repaired<'py>(
        class: &Bound<'py, PyType>,
        vertices: &Bound<'py, PyAny>,
        bones: &Bound<'py, PyAny>,
        weights: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = crate::arrays::whole)] vertex_count: usize,
        #[pyo3(from_py_with = crate::arrays::whole)] bone_count: usize,
    ) -> PyResult<(Self, Bound<'py, PyDict>)> {
        let builder = collected([vertices, bones], weights, vertex_count, bone_count)?;
        let (weights, repair) = builder.build_repaired().or_raise()?;
        let done = PyDict::new(class.py());
        done.set_item("negative", repair.negative)?;
        done.set_item("rescaled", repair.rescaled)?;
        done.set_item("worst", repair.worst)?;
        Ok((weights.into(), done))
    }

    /// Weights of a table with a row for each vertex and a column for each bone, shape (V, bones); zeros are omitted.
    ///
    /// Raises `InvalidValueError` as the constructor does.
    #[classmethod]
    fn from_table(_class: &Bound<'_, PyType>, table: &Bound<'_, PyAny>) -> PyResult<Self> {
        let table: Numbers<'_, Ix2> = arrays::numbers(table, "table", "(V, bones)")?;
        if table.shape()[1] > MAX_BONES {
            return Err(too_many(table.shape()[1]));
        }
        let mut builder = Weights::builder(table.shape()[0], table.shape()[1]);
        for (vertex, row) in table.chunks_exact(table.shape()[1].max(1)).enumerate() {
            for (bone, &weight) in row.iter().enumerate() {
                builder.add(vertex, bone, weight).or_raise()?;
            }
        }
        builder.build().or_raise().map(Self::from)
    }

    /// The table that `from_table` reads, shape (V, bones), float64.
    ///
    /// Raises `MemoryError` if the table does not fit in memory.
    fn to_table<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (vertices, bones) = (self.inner.vertex_count(), self.inner.bone_count());
        let table = arrays::numpy(py)?.call_method1("zeros", ((vertices, bones),))?;
        let table = table.cast_into::<PyArray2<f64>>()?;
        arrays::fill(&table, |table| {
            for (row, influences) in table.chunks_mut(bones.max(1)).zip(self.inner.iter()) {
                for influence in influences {
                    row[influence.bone as usize] = influence.weight;
                }
            }
            Ok(())
        })?;
        Ok(table)
    }

    /// Number of vertices.
    #[getter]
    fn vertex_count(&self) -> usize {
        self.inner.vertex_count()
    }

    /// Number of bones of the skeleton.
    #[getter]
    fn bone_count(&self) -> usize {
        self.inner.bone_count()
    }

    /// Largest number of influences on one vertex.
    #[getter]
    fn max_influences(&self) -> usize {
        self.inner.max_influences()
    }

    /// Index of each vertex's first influence in `bones` and `weights`, and one past the last: shape (V + 1,), int64,
    /// as in scipy's compressed sparse rows.
    #[getter]
    fn starts<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        let mut starts = vec![0];
        let mut end = 0;
        for influences in self.inner.iter() {
            end += influences.len() as i64;
            starts.push(end);
        }
        PyArray1::from_vec(py, starts)
    }

    /// Bones of all influences, vertex by vertex, shape (influences,), int64.
    #[getter]
    fn bones<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        PyArray1::from_iter(py, self.all().map(|influence| i64::from(influence.bone)))
    }

    /// Weights of all influences, vertex by vertex, shape (influences,), float64.
    #[getter]
    fn weights<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.all().map(|influence| influence.weight))
    }

    /// Influences of one vertex, sorted by bone: [(bone, weight), ...]; empty for an unknown vertex.
    ///
    /// Raises `InvalidValueError` for a number below 0.
    fn influences(
        &self,
        #[pyo3(from_py_with = crate::arrays::whole)] vertex: usize,
    ) -> Vec<(u32, f64)> {
        let influences = self.inner.influences(vertex).iter();
        influences.map(|i| (i.bone, i.weight)).collect()
    }

    /// The `most` largest influences of each vertex, divided by their sum, and the loss: {"vertices": number of
    /// vertices that lost influences, "largest_lost": largest weight lost by a vertex, "mean_lost": mean over all
    /// vertices}.
    ///
    /// Raises `InvalidValueError` for a `most` of 0.
    fn pruned<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = crate::arrays::whole)] most: usize,
    ) -> PyResult<(Self, Bound<'py, PyDict>)> {
        let (weights, pruning) = py.detach(|| self.inner.pruned(most)).or_raise()?;
        let lost = PyDict::new(py);
        lost.set_item("vertices", pruning.vertices)?;
        lost.set_item("largest_lost", pruning.largest_lost)?;
        lost.set_item("mean_lost", pruning.mean_lost)?;
        Ok((weights.into(), lost))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let rows = self.inner.iter().enumerate();
        let vertices = rows.flat_map(|(vertex, row)| row.iter().map(move |_| vertex as i64));
        let parts = (
            PyArray1::from_iter(py, vertices),
            self.bones(py),
            self.weights(py),
            self.inner.vertex_count(),
            self.inner.bone_count(),
        );
        pickling::by_class::<Self>(py, parts)
    }

    fn __repr__(&self) -> String {
        format!(
            "SkinWeights({} vertices, {} bones, at most {} influences)",
            self.inner.vertex_count(),
            self.inner.bone_count(),
            self.inner.max_influences()
        )
    }
}
