//! DMAT tables: skin weights.

use std::path::PathBuf;

use kinopt::io::dmat::{self, DmatEncoding};
use kinopt::model::UnknownName;
use kinopt::nalgebra::DMatrix;
use numpy::PyArrayDyn;
use numpy::ndarray::Ix2;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::{self, Numbers};
use crate::error::OrRaise;
use crate::transforms::shaped;

fn encoding(name: &str) -> PyResult<DmatEncoding> {
    match name {
        "binary" => Ok(DmatEncoding::Binary),
        "text" => Ok(DmatEncoding::Text),
        _ => Err(UnknownName::new("encoding", name, ["binary", "text"])).or_raise(),
    }
}

fn to_array(py: Python<'_>, table: DMatrix<f64>) -> PyResult<Bound<'_, PyArrayDyn<f64>>> {
    let shape = [table.nrows(), table.ncols()];
    shaped(py, table.transpose().as_slice().to_vec(), &shape)
}

fn read(value: &Bound<'_, PyAny>) -> PyResult<DMatrix<f64>> {
    let table: Numbers<'_, Ix2> = arrays::numbers(value, "table", "(rows, columns)")?;
    let [rows, columns] = [table.shape()[0], table.shape()[1]];
    Ok(DMatrix::from_row_slice(rows, columns, &table))
}

/// Reads a DMAT file: a table of float64, shape (rows, columns).
///
/// Raises `FileError` if it cannot be opened, `InvalidFileError` with the line or byte.
#[pyfunction]
pub(crate) fn dmat_read(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyArrayDyn<f64>>> {
    let table = py.detach(|| dmat::read(&path)).or_raise()?;
    to_array(py, table)
}

/// Reads the bytes of a DMAT file; `name` is its name in messages.
///
/// Raises `InvalidFileError` with the line or byte.
#[pyfunction]
#[pyo3(signature = (data, name = "table.dmat"))]
pub(crate) fn dmat_from_bytes<'py>(
    py: Python<'py>,
    data: &[u8],
    name: &str,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    to_array(py, dmat::from_bytes(data, name).or_raise()?)
}

/// The bytes of a DMAT file of a table, shape (rows, columns); `encoding` is "binary" or "text".
///
/// Raises `UnknownNameError` for another encoding, `InvalidValueError` for a value that is not a table of numbers.
#[pyfunction]
#[pyo3(signature = (table, encoding = "binary"))]
pub(crate) fn dmat_to_bytes<'py>(
    table: &Bound<'py, PyAny>,
    encoding: &str,
) -> PyResult<Bound<'py, PyBytes>> {
    let bytes = dmat::to_bytes(&read(table)?, self::encoding(encoding)?);
    Ok(PyBytes::new(table.py(), &bytes))
}

/// Writes a DMAT file of a table, shape (rows, columns); `encoding` is "binary" or "text".
///
/// Raises `FileError`.
#[pyfunction]
#[pyo3(signature = (table, path, encoding = "binary"))]
pub(crate) fn dmat_write(table: &Bound<'_, PyAny>, path: PathBuf, encoding: &str) -> PyResult<()> {
    let (encoding, matrix) = (self::encoding(encoding)?, read(table)?);
    table
        .py()
        .detach(|| dmat::write(&matrix, encoding, &path))
        .or_raise()
}
