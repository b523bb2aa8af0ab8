//! How strongly each bone moves each vertex.

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

/// Sparse skin weights: for each vertex the bones that move it, any number of them, sorted by bone.
///
/// Each vertex's weights sum to 1; they are kept exactly as given.
///
/// Weights in coordinates: vertex `vertices[i]` follows bone `bones[i]` by `weights[i]`, in any order;
/// three lists of one length.
///
/// Raises `InvalidValueError` naming the vertex and bone where a weight is not finite or below zero by
/// more than 1e-2, an index is out of range, a pair occurs twice or a vertex's weights do not sum to 1
/// within 1e-5.
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

/// More bones than any skeleton has: memory that grows with their number is not asked for beyond it.
const BONES: usize = 1 << 20;

/// Vertices, bones and weights of three arrays, collected.
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
    if bone_count > BONES {
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
    invalid(format!("{bones} bones, where there may be {BONES}"))
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

    /// As the constructor, but repaired where that has one meaning: weights below zero become zero, and
    /// weights that do not sum to 1 are divided by their sum.
    ///
    /// Gives the weights and what was done: {"negative": how many became zero, "rescaled": at how many
    /// vertices, "worst": (vertex, sum) furthest from 1, or None}.
    ///
    /// Raises `InvalidValueError` for what cannot be repaired: an index out of range, a pair that occurs
    /// twice, a vertex without any weight.
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

    /// Weights of a table with a row a vertex and a column a bone, shape (V, bones); zeros are left out.
    ///
    /// Raises `InvalidValueError` as the constructor does.
    #[classmethod]
    fn from_table(_class: &Bound<'_, PyType>, table: &Bound<'_, PyAny>) -> PyResult<Self> {
        let table: Numbers<'_, Ix2> = arrays::numbers(table, "table", "(V, bones)")?;
        if table.shape()[1] > BONES {
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
    /// Raises `MemoryError` where the table does not fit in memory.
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

    /// How many vertices have weights.
    #[getter]
    fn vertex_count(&self) -> usize {
        self.inner.vertex_count()
    }

    /// How many bones the skeleton has.
    #[getter]
    fn bone_count(&self) -> usize {
        self.inner.bone_count()
    }

    /// The largest number of influences on one vertex.
    #[getter]
    fn max_influences(&self) -> usize {
        self.inner.max_influences()
    }

    /// Where each vertex's influences start in `bones` and `weights`, and one past the last: shape (V + 1,),
    /// int64, as in scipy's compressed sparse rows.
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

    /// The bones of all influences, vertex by vertex, shape (influences,), int64.
    #[getter]
    fn bones<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        PyArray1::from_iter(py, self.all().map(|influence| i64::from(influence.bone)))
    }

    /// The weights of all influences, vertex by vertex, shape (influences,), float64.
    #[getter]
    fn weights<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.all().map(|influence| influence.weight))
    }

    /// One vertex's influences, sorted by bone: [(bone, weight), ...]; empty where there is no such vertex.
    ///
    /// Raises `InvalidValueError` for a number below 0.
    fn influences(
        &self,
        #[pyo3(from_py_with = crate::arrays::whole)] vertex: usize,
    ) -> Vec<(u32, f64)> {
        let influences = self.inner.influences(vertex).iter();
        influences.map(|i| (i.bone, i.weight)).collect()
    }

    /// The `most` influences of each vertex with the largest weights, divided by their sum, and what was
    /// lost: {"vertices": how many lost any, "largest_lost": weight that one vertex lost at most,
    /// "mean_lost": over all vertices}.
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
