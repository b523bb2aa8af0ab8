//! Placements as 4 x 4 arrays, and conversion from other libraries.

use kinopt::spatial::{Matrix3, Placement, Vector3};
use kinopt_bindings::placement::{bad_last_row, of_rows, to_rows};
use numpy::{PyArray2, PyArray3, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::intern;
use pyo3::prelude::*;

use crate::arrays::{self, shape_text};
use crate::error::invalid;

/// Placements of targets, borrowed as numbers.
pub(crate) struct Placements<'py>(arrays::Numbers<'py, numpy::ndarray::Ix3>);

impl Placements<'_> {
    pub(crate) fn len(&self) -> usize {
        self.0.shape()[0]
    }

    /// All numbers, sixteen for each placement, row-major.
    pub(crate) fn numbers(&self) -> &[f64] {
        &self.0
    }

    /// Returns the array object, to store it.
    pub(crate) fn keep(&self) -> Py<PyAny> {
        self.0.keep()
    }

    /// All placements, checked.
    pub(crate) fn to_vec(&self, what: &str) -> PyResult<Vec<Placement<f64>>> {
        let mut placements = Vec::with_capacity(self.len());
        read_all(self.numbers(), what, 0, &mut placements)?;
        Ok(placements)
    }
}

/// Reads placements of sixteen numbers each; `first` is the index of the first in messages.
pub(crate) fn read_all(
    numbers: &[f64],
    what: &str,
    first: usize,
    placements: &mut Vec<Placement<f64>>,
) -> PyResult<()> {
    for (i, numbers) in numbers.chunks_exact(16).enumerate() {
        let Ok(numbers) = numbers.try_into() else {
            continue;
        };
        let placement = of_rows(numbers);
        let placement = placement.map_err(|last_row| {
            invalid(bad_last_row(&format!("{what} {}", first + i), last_row))
        })?;
        placements.push(placement);
    }
    Ok(())
}

/// Converts the sixteen numbers of a matrix to a placement.
fn of_matrix(numbers: &[f64], what: &str) -> PyResult<Placement<f64>> {
    let numbers = numbers
        .try_into()
        .map_err(|_| invalid(format!("{what} is no matrix of 4 x 4")))?;
    of_rows(numbers).map_err(|last_row| invalid(bad_last_row(what, last_row)))
}

/// Reads one placement: a 4 x 4 array-like, or an object that has `homogeneous` (pinocchio's SE3), `as_matrix()` or `A`
/// (spatialmath).
pub(crate) fn placement(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Placement<f64>> {
    if let Ok(array) = value.cast::<PyArray2<f64>>() {
        if array.shape() == [4, 4] && array.is_c_contiguous() {
            // A copy is faster than registering a borrow.
            if let Ok(numbers) = array.to_vec() {
                return of_matrix(&numbers, what);
            }
        }
    }
    let matrix = matrix_of(value)?;
    let converted = arrays::convert::<f64>(&matrix, what)?;
    match converted.cast::<PyArray2<f64>>() {
        Ok(array) if array.shape() == [4, 4] => placement(&converted, what),
        _ => {
            let shape: Vec<usize> = converted.getattr(intern!(value.py(), "shape"))?.extract()?;
            Err(invalid(format!(
                "{what} has shape {}, expected a placement of shape (4, 4)",
                shape_text(&shape)
            )))
        }
    }
}

/// Reads a rotation matrix: a 3 x 3 array, the rotation of a placement, or an object that has `as_matrix()` (scipy's
/// Rotation) or `A` (spatialmath).
pub(crate) fn rotation(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Matrix3<f64>> {
    let matrix = matrix_of(value)?;
    let rows: usize = matrix.len().unwrap_or(0);
    if rows == 4 {
        return Ok(placement(&matrix, what)?.rotation);
    }
    let [a, b, c] = arrays::table::<3, 3>(&matrix, what)?;
    let column = |k: usize| Vector3::new(a[k], b[k], c[k]);
    Ok(Matrix3::from_columns(column(0), column(1), column(2)))
}

/// Reads several placements: an array of shape (N, 4, 4), or a list of values that [`placement`] reads.
pub(crate) fn placements<'py>(value: &Bound<'py, PyAny>, what: &str) -> PyResult<Placements<'py>> {
    if value.cast::<PyArray3<f64>>().is_ok() {
        return Ok(Placements(arrays::matrices(value, what, [4, 4])?));
    }
    let py = value.py();
    if value.hasattr(intern!(py, "shape"))? {
        return Ok(Placements(arrays::matrices(
            &matrix_of(value)?,
            what,
            [4, 4],
        )?));
    }
    // A list may hold objects of other libraries.
    let mut numbers = Vec::new();
    let items = value.try_iter().map_err(|_| {
        invalid(format!(
            "{what} must be an array of shape (N, 4, 4) or a list of placements"
        ))
    })?;
    for (i, item) in items.enumerate() {
        let placement = placement(&item?, &format!("{what} {i}"))?;
        numbers.extend(to_rows(&placement));
    }
    let count = numbers.len() / 16;
    let array = arrays::list(py, &numbers).reshape([count, 4, 4])?;
    Ok(Placements(arrays::matrices(array.as_any(), what, [4, 4])?))
}

/// Returns the matrix of an object of another library, or the object itself.
fn matrix_of<'py>(value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let py = value.py();
    if let Some(matrix) = value.getattr_opt(intern!(py, "homogeneous"))? {
        return Ok(matrix);
    }
    if let Some(method) = value.getattr_opt(intern!(py, "as_matrix"))? {
        return method.call0();
    }
    if let Some(matrix) = value.getattr_opt(intern!(py, "A"))? {
        return Ok(matrix);
    }
    Ok(value.clone())
}

/// Placement of a field, which Python reads as a new 4 x 4 array.
#[derive(Clone)]
pub(crate) struct Matrix(pub(crate) Placement<f64>);

impl<'py> IntoPyObject<'py> for &Matrix {
    type Target = PyArray2<f64>;
    type Output = Bound<'py, PyArray2<f64>>;
    type Error = PyErr;

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Self::Output> {
        to_array(py, &self.0)
    }
}

/// A new 4 x 4 array.
pub(crate) fn to_array<'py>(
    py: Python<'py>,
    placement: &Placement<f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    arrays::list(py, &to_rows(placement)).reshape([4, 4])
}

/// A new array of shape (N, 4, 4).
pub(crate) fn to_arrays<'py>(
    py: Python<'py>,
    placements: &[Placement<f64>],
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let numbers: Vec<f64> = placements.iter().flat_map(to_rows).collect();
    arrays::list(py, &numbers).reshape([placements.len(), 4, 4])
}
