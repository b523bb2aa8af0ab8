//! Numbers from Python: arrays of float64 in C order are read where they lie, everything else that
//! numpy can make such an array of is converted.

use std::ops::Deref;

use numpy::ndarray::{Dimension, Ix1, Ix2, Ix3};
use numpy::{
    Element, PyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::PyIndexError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::invalid;

/// Numbers of an array in C order.
pub(crate) struct Numbers<'py, D: Dimension>(PyReadonlyArray<'py, f64, D>);

impl<D: Dimension> Numbers<'_, D> {
    pub(crate) fn shape(&self) -> &[usize] {
        self.0.shape()
    }
}

impl<D: Dimension> Deref for Numbers<'_, D> {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        // `numbers` lets through what is contiguous alone.
        self.0.as_slice().unwrap_or_default()
    }
}

/// One configuration, or another list of numbers.
pub(crate) type Vector<'py> = Numbers<'py, Ix1>;
/// A table of numbers, rows one after another.
pub(crate) type Rows<'py> = Numbers<'py, Ix2>;

/// A list of numbers; `what` is its name in messages.
pub(crate) fn vector<'py>(value: &Bound<'py, PyAny>, what: &str) -> PyResult<Vector<'py>> {
    numbers(value, what, "one list of numbers")
}

/// A list of `length` numbers.
pub(crate) fn vector_of<'py>(
    value: &Bound<'py, PyAny>,
    what: &str,
    length: usize,
) -> PyResult<Vector<'py>> {
    let vector = vector(value, what)?;
    match vector.len() == length {
        true => Ok(vector),
        false => Err(invalid(format!(
            "{what} has shape ({},), expected ({length},)",
            vector.len()
        ))),
    }
}

/// A fixed number of numbers.
pub(crate) fn array<const N: usize>(value: &Bound<'_, PyAny>, what: &str) -> PyResult<[f64; N]> {
    let mut array = [0.0; N];
    array.copy_from_slice(&vector_of(value, what, N)?);
    Ok(array)
}

/// A table with so many columns.
pub(crate) fn rows<'py>(
    value: &Bound<'py, PyAny>,
    what: &str,
    columns: usize,
) -> PyResult<Rows<'py>> {
    let rows: Rows<'py> = numbers(value, what, &format!("rows of {columns} numbers"))?;
    match rows.shape()[1] == columns {
        true => Ok(rows),
        false => Err(invalid(format!(
            "{what} has shape ({}, {}), expected (N, {columns})",
            rows.shape()[0],
            rows.shape()[1]
        ))),
    }
}

/// Matrices of a fixed shape, one after another.
pub(crate) fn matrices<'py>(
    value: &Bound<'py, PyAny>,
    what: &str,
    [height, width]: [usize; 2],
) -> PyResult<Numbers<'py, Ix3>> {
    let matrices: Numbers<'py, Ix3> =
        numbers(value, what, &format!("N matrices of {height} x {width}"))?;
    match matrices.shape()[1..] == [height, width] {
        true => Ok(matrices),
        false => Err(invalid(format!(
            "{what} has shape {:?}, expected (N, {height}, {width})",
            matrices.shape()
        ))),
    }
}

/// How many axes an array-like has, for arguments that may be one thing or many.
pub(crate) fn axes(value: &Bound<'_, PyAny>) -> PyResult<usize> {
    match value.cast::<PyUntypedArray>() {
        Ok(array) => Ok(array.ndim()),
        Err(_) => numpy(value.py())?
            .call_method1(intern!(value.py(), "ndim"), (value,))?
            .extract(),
    }
}

pub(crate) fn numpy(py: Python<'_>) -> PyResult<Bound<'_, PyModule>> {
    py.import(intern!(py, "numpy"))
}

/// Numbers with as many axes as `D` has.
fn numbers<'py, D: Dimension>(
    value: &Bound<'py, PyAny>,
    what: &str,
    expected: &str,
) -> PyResult<Numbers<'py, D>> {
    if let Ok(array) = value.cast::<PyArray<f64, D>>() {
        if array.is_c_contiguous() {
            return readonly(array, what);
        }
    }
    let converted = convert::<f64>(value, what)?;
    let array = converted.cast::<PyArray<f64, D>>().map_err(|_| {
        let shape: Vec<usize> = converted
            .cast::<PyUntypedArray>()
            .map(|array| array.shape().to_vec())
            .unwrap_or_default();
        invalid(format!(
            "{what} has shape {}, expected {expected}",
            shape_text(&shape)
        ))
    })?;
    readonly(array, what)
}

fn readonly<'py, D: Dimension>(
    array: &Bound<'py, PyArray<f64, D>>,
    what: &str,
) -> PyResult<Numbers<'py, D>> {
    match array.try_readonly() {
        Ok(array) => Ok(Numbers(array)),
        Err(_) => Err(invalid(format!(
            "{what} is being written to by another call"
        ))),
    }
}

/// A shape as Python writes it.
pub(crate) fn shape_text(shape: &[usize]) -> String {
    match shape {
        [length] => format!("({length},)"),
        _ => {
            let lengths: Vec<String> = shape.iter().map(usize::to_string).collect();
            format!("({})", lengths.join(", "))
        }
    }
}

/// An array of `T` in C order of whatever holds real numbers.
pub(crate) fn convert<'py, T: Element>(
    value: &Bound<'py, PyAny>,
    what: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let py = value.py();
    let numpy = numpy(py)?;
    let no_numbers = |error: PyErr| invalid(format!("{what} holds no numbers: {error}"));
    let array = numpy
        .call_method1(intern!(py, "asarray"), (value,))
        .map_err(no_numbers)?;
    let dtype = array.getattr(intern!(py, "dtype"))?;
    let kind: String = dtype.getattr(intern!(py, "kind"))?.extract()?;
    // Complex numbers would lose a part, texts and dates are no numbers.
    if !matches!(kind.as_str(), "f" | "i" | "u" | "b") {
        return Err(invalid(format!("{what} holds no real numbers but {dtype}")));
    }
    let arguments = PyDict::new(py);
    arguments.set_item(intern!(py, "dtype"), T::get_dtype(py))?;
    numpy
        .call_method(intern!(py, "ascontiguousarray"), (array,), Some(&arguments))
        .map_err(no_numbers)
}

/// An array of the caller's to write rows into, or a new one.
pub(crate) fn room<'py>(
    py: Python<'py>,
    out: Option<&Bound<'py, PyAny>>,
    rows: usize,
    columns: usize,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let Some(out) = out else {
        return Ok(PyArray2::zeros(py, [rows, columns], false));
    };
    let unfit = || {
        invalid(format!(
            "out must be a writable float64 array of shape ({rows}, {columns}) in C order"
        ))
    };
    let array = out.cast::<PyArray2<f64>>().map_err(|_| unfit())?;
    let writable: bool = out
        .getattr(intern!(py, "flags"))?
        .getattr(intern!(py, "writeable"))?
        .extract()?;
    match array.shape() == [rows, columns] && array.is_c_contiguous() && writable {
        true => Ok(array.clone()),
        false => Err(unfit()),
    }
}

/// A new list of numbers.
pub(crate) fn list<'py>(py: Python<'py>, values: &[f64]) -> Bound<'py, PyArray1<f64>> {
    PyArray1::from_slice(py, values)
}

/// The place of an index that may count from the end.
pub(crate) fn place(i: isize, count: usize) -> PyResult<usize> {
    let place = if i < 0 {
        i.checked_add_unsigned(count)
    } else {
        Some(i)
    };
    let place = place.and_then(|place| usize::try_from(place).ok());
    place.filter(|&place| place < count).ok_or_else(|| {
        PyIndexError::new_err(format!("index {i} is out of range: there are {count}"))
    })
}
