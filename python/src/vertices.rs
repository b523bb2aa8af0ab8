//! Vertices: float32 arrays of three columns, borrowed as vectors of the library.

use std::ops::Deref;

use kinopt::glam::{Vec3, Vec4};
use kinopt::skinning::PosedVertices;
use numpy::ndarray::Ix2;
use numpy::{
    PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::prelude::*;

use crate::arrays::{self, Numbers, shape_text};
use crate::error::invalid;

/// Vectors of single precision.
pub(crate) struct Vectors<'py>(Numbers<'py, Ix2, f32>);

impl Deref for Vectors<'_> {
    type Target = [Vec3];

    fn deref(&self) -> &[Vec3] {
        bytemuck::cast_slice(&self.0)
    }
}

/// Reads positions, normals or other vectors, shape (N, 3); `what` names them in messages.
pub(crate) fn vectors<'py>(value: &Bound<'py, PyAny>, what: &str) -> PyResult<Vectors<'py>> {
    of_columns(value, what, 3).map(Vectors)
}

/// Reads tangents with the sign of the bitangent, shape (N, 4). Copied, because the library's vectors are aligned to 16
/// bytes.
pub(crate) fn tangents(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<Vec4>> {
    let rows = of_columns(value, what, 4)?;
    Ok(rows.chunks_exact(4).map(Vec4::from_slice).collect())
}

fn of_columns<'py>(
    value: &Bound<'py, PyAny>,
    what: &str,
    columns: usize,
) -> PyResult<Numbers<'py, Ix2, f32>> {
    let numbers: Numbers<'py, Ix2, f32> = arrays::numbers(value, what, &format!("(N, {columns})"))?;
    match numbers.shape()[1] == columns {
        true => Ok(numbers),
        false => Err(invalid(format!(
            "{what} has shape {}, expected (N, {columns})",
            shape_text(numbers.shape())
        ))),
    }
}

/// New array of shape (N, 3) that takes over the memory of the vectors.
pub(crate) fn into_array(py: Python<'_>, vectors: Vec<Vec3>) -> PyResult<Bound<'_, PyArray2<f32>>> {
    let count = vectors.len();
    let numbers: Vec<f32> = bytemuck::allocation::try_cast_vec(vectors)
        .unwrap_or_else(|(_, vectors)| bytemuck::cast_slice(&vectors).to_vec());
    PyArray1::from_vec(py, numbers).reshape([count, 3])
}

/// New array of shape (N, columns) of vectors with `columns` numbers.
pub(crate) fn to_array<'py, V: bytemuck::Pod>(
    py: Python<'py>,
    vectors: &[V],
    columns: usize,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let numbers: &[f32] = bytemuck::cast_slice(vectors);
    PyArray1::from_slice(py, numbers).reshape([vectors.len(), columns])
}

/// Calls `fill` with the numbers of an array as vectors.
pub(crate) fn fill(
    array: &Bound<'_, PyArrayDyn<f32>>,
    fill: impl FnOnce(&mut [Vec3]) -> PyResult<()>,
) -> PyResult<()> {
    arrays::fill(array, |numbers| fill(bytemuck::cast_slice_mut(numbers)))
}

/// Requested vertex attribute.
#[derive(Clone, Copy)]
pub(crate) enum Part {
    Positions,
    Normals,
}

impl Part {
    /// Number of values of a mesh.
    pub(crate) fn count(self, mesh: &kinopt::mesh::TriangleMesh) -> usize {
        match self {
            Self::Positions => mesh.positions().len(),
            Self::Normals => mesh.normals().len(),
        }
    }

    /// Output buffers for this attribute only.
    pub(crate) fn of(self, buffer: &mut [f32]) -> PosedVertices<'_> {
        let buffer = bytemuck::cast_slice_mut(buffer);
        match self {
            Self::Positions => PosedVertices {
                positions: buffer,
                ..PosedVertices::default()
            },
            Self::Normals => PosedVertices {
                normals: buffer,
                ..PosedVertices::default()
            },
        }
    }
}

/// Reads vertex indices of triangles, shape (N, 3), of any integer type.
pub(crate) fn triangles(value: &Bound<'_, PyAny>) -> PyResult<Vec<[u32; 3]>> {
    let expected = "(N, 3)";
    if is_u32(value) {
        let numbers: Numbers<'_, Ix2, u32> = arrays::numbers(value, "triangles", expected)?;
        check_three(numbers.shape())?;
        return Ok(bytemuck::cast_slice(&numbers).to_vec());
    }
    let numbers: Numbers<'_, Ix2, i64> = whole(value, "triangles", expected)?;
    check_three(numbers.shape())?;
    let corner = |index: i64| {
        u32::try_from(index)
            .map_err(|_| invalid(format!("triangles: {index} is no index of a vertex")))
    };
    let corners: Vec<u32> = numbers
        .iter()
        .map(|&i| corner(i))
        .collect::<PyResult<_>>()?;
    Ok(bytemuck::cast_slice(&corners).to_vec())
}

/// Reads whole numbers of any integer type.
pub(crate) fn whole<'py, D: numpy::ndarray::Dimension>(
    value: &Bound<'py, PyAny>,
    what: &str,
    expected: &str,
) -> PyResult<Numbers<'py, D, i64>> {
    let array = arrays::numpy(value.py())?
        .call_method1("asarray", (value,))
        .map_err(|error| invalid(format!("{what} holds no numbers: {error}")))?;
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    let empty = array
        .cast::<PyUntypedArray>()
        .is_ok_and(|array| array.is_empty());
    if !matches!(kind.as_str(), "i" | "u") && !empty {
        return Err(invalid(format!("{what} must be whole numbers")));
    }
    arrays::numbers(&array, what, expected)
}

fn is_u32(value: &Bound<'_, PyAny>) -> bool {
    value.cast::<PyArray2<u32>>().is_ok()
}

fn check_three(shape: &[usize]) -> PyResult<()> {
    match shape[1] == 3 {
        true => Ok(()),
        false => Err(invalid(format!(
            "triangles has shape {}, expected (N, 3)",
            shape_text(shape)
        ))),
    }
}
