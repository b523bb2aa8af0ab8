//! Conversion between numpy arrays and slices. float64 arrays (float32 for vertices) in C order are borrowed; other
//! array-likes are converted.

use std::ops::Deref;

use numpy::ndarray::{Dimension, Ix1, Ix2, Ix3, IxDyn};
use numpy::{
    Element, PyArray, PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyReadonlyArray,
    PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyIndexError, PyMemoryError, PyOverflowError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyMapping};

use crate::error::invalid;

/// Numbers of an array in C order.
pub(crate) struct Numbers<'py, D: Dimension, T: Element = f64>(PyReadonlyArray<'py, T, D>);

impl<D: Dimension, T: Element> Numbers<'_, D, T> {
    pub(crate) fn shape(&self) -> &[usize] {
        self.0.shape()
    }
}

impl<D: Dimension, T: Element> Numbers<'_, D, T> {
    /// Returns the array object, to store it.
    pub(crate) fn keep(&self) -> Py<PyAny> {
        self.0.as_any().clone().unbind()
    }
}

impl<D: Dimension, T: Element> Deref for Numbers<'_, D, T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        // `numbers` accepts contiguous arrays only.
        self.0.as_slice().unwrap_or_default()
    }
}

/// One-dimensional array of numbers, such as a configuration.
pub(crate) type Vector<'py> = Numbers<'py, Ix1>;
/// Two-dimensional array of numbers in row order.
pub(crate) type RowBlock<'py> = Numbers<'py, Ix2>;

/// Reads a list of numbers; `what` names it in messages.
pub(crate) fn vector<'py>(value: &Bound<'py, PyAny>, what: &str) -> PyResult<Vector<'py>> {
    numbers(value, what, "one list of numbers")
}

/// One query or several: configurations of shape (k,) or (N, k), numbers of shape () or (N,).
pub(crate) struct Queries<'py> {
    numbers: Numbers<'py, IxDyn>,
    columns: usize,
    /// Number of queries; `None` for a single one without an axis.
    count: Option<usize>,
}

impl<'py> Queries<'py> {
    /// Reads configurations of `columns` numbers each; `what` names them in messages.
    pub(crate) fn rows(value: &Bound<'py, PyAny>, what: &str, columns: usize) -> PyResult<Self> {
        let numbers: Numbers<'py, IxDyn> = numbers(value, what, "an array")?;
        let count = match numbers.shape() {
            [last] if *last == columns => None,
            [count, last] if *last == columns => Some(*count),
            shape => {
                return Err(invalid(format!(
                    "{what} has shape {}, expected ({columns},) or (N, {columns})",
                    shape_text(shape)
                )));
            }
        };
        Ok(Self {
            numbers,
            columns,
            count,
        })
    }

    /// Reads single numbers, such as times.
    pub(crate) fn numbers(value: &Bound<'py, PyAny>, what: &str) -> PyResult<Self> {
        // The conversion makes a list of a scalar, so the axes are counted first.
        let one = axes(value)? == 0;
        let numbers: Numbers<'py, IxDyn> = numbers(value, what, "a number or a list of numbers")?;
        let count = match numbers.shape() {
            [_] if one => None,
            [] => None,
            [count] => Some(*count),
            shape => {
                return Err(invalid(format!(
                    "{what} has shape {}, expected () or (N,)",
                    shape_text(shape)
                )));
            }
        };
        Ok(Self {
            numbers,
            columns: 1,
            count,
        })
    }

    /// True if there is an axis of queries.
    pub(crate) fn is_table(&self) -> bool {
        self.count.is_some()
    }

    /// All numbers, one query after another.
    pub(crate) fn all(&self) -> &[f64] {
        &self.numbers
    }

    /// Number of queries.
    pub(crate) fn count(&self) -> usize {
        self.count.unwrap_or(1)
    }

    /// Shape of results that have the shape `each` for one query.
    pub(crate) fn shape(&self, each: &[usize]) -> Vec<usize> {
        self.count.iter().chain(each).copied().collect()
    }

    /// Array of the results of `work`, of the shape `each` for one query; `out` receives them if given. Runs as
    /// [`each`](Self::each).
    pub(crate) fn compute<T: Element + Send>(
        &self,
        (py, out): (Python<'py>, Option<&Bound<'py, PyAny>>),
        each: &[usize],
        at_a_time: usize,
        work: impl FnMut(&[f64], &mut [T]) -> PyResult<()> + Send,
    ) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
        let array = output_array::<T>(py, out, &self.shape(each))?;
        fill(&array, |buffer| self.each(py, buffer, at_a_time, work))?;
        Ok(array)
    }

    /// Calls `work` with each query and its part of the results, without the GIL. Checks for signals after every
    /// `at_a_time` queries.
    pub(crate) fn each<T: Send>(
        &self,
        py: Python<'py>,
        buffer: &mut [T],
        at_a_time: usize,
        mut work: impl FnMut(&[f64], &mut [T]) -> PyResult<()> + Send,
    ) -> PyResult<()> {
        let count = self.count.unwrap_or(1);
        let width = buffer.len() / count.max(1);
        let (q, columns) = (&*self.numbers, self.columns);
        for first in (0..count).step_by(at_a_time) {
            py.check_signals()?;
            py.detach(|| {
                (first..count.min(first + at_a_time)).try_for_each(|i| {
                    let q = &q[i * columns..(i + 1) * columns];
                    work(q, &mut buffer[i * width..(i + 1) * width])
                })
            })?;
        }
        Ok(())
    }
}

/// Copies a list of numbers. Faster than [`vector`] for one configuration, because it registers no borrow.
pub(crate) fn copied(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<f64>> {
    if let Ok(array) = value.cast::<PyArray1<f64>>() {
        if let Ok(numbers) = array.to_vec() {
            return Ok(numbers);
        }
    }
    Ok(vector(value, what)?.to_vec())
}

/// Reads a list of `length` numbers.
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

/// Reads a fixed number of numbers.
pub(crate) fn array<const N: usize>(value: &Bound<'_, PyAny>, what: &str) -> PyResult<[f64; N]> {
    let mut array = [0.0; N];
    array.copy_from_slice(&vector_of(value, what, N)?);
    Ok(array)
}

/// Reads a table of `columns` columns.
pub(crate) fn rows<'py>(
    value: &Bound<'py, PyAny>,
    what: &str,
    columns: usize,
) -> PyResult<RowBlock<'py>> {
    let rows: RowBlock<'py> = numbers(value, what, &format!("rows of {columns} numbers"))?;
    match rows.shape()[1] == columns {
        true => Ok(rows),
        false => Err(invalid(format!(
            "{what} has shape ({}, {}), expected (N, {columns})",
            rows.shape()[0],
            rows.shape()[1]
        ))),
    }
}

/// Reads a table of a fixed shape.
pub(crate) fn table<const R: usize, const C: usize>(
    value: &Bound<'_, PyAny>,
    what: &str,
) -> PyResult<[[f64; C]; R]> {
    let rows = rows(value, what, C)?;
    if rows.shape()[0] != R {
        return Err(invalid(format!(
            "{what} has shape {}, expected ({R}, {C})",
            shape_text(rows.shape())
        )));
    }
    let mut table = [[0.0; C]; R];
    for (target, row) in table.iter_mut().zip(rows.chunks_exact(C)) {
        target.copy_from_slice(row);
    }
    Ok(table)
}

/// Reads matrices of a fixed shape, shape (N, height, width).
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

/// Number of axes of an array-like, for arguments that accept one item or several.
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

/// Reads numbers with the number of axes of `D`.
pub(crate) fn numbers<'py, D: Dimension, T: Element>(
    value: &Bound<'py, PyAny>,
    what: &str,
    expected: &str,
) -> PyResult<Numbers<'py, D, T>> {
    if let Ok(array) = value.cast::<PyArray<T, D>>() {
        if array.is_c_contiguous() && array.is_aligned() {
            return readonly(array, what);
        }
    }
    let converted = convert::<T>(value, what)?;
    let array = converted.cast::<PyArray<T, D>>().map_err(|_| {
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

fn readonly<'py, D: Dimension, T: Element>(
    array: &Bound<'py, PyArray<T, D>>,
    what: &str,
) -> PyResult<Numbers<'py, D, T>> {
    match array.try_readonly() {
        Ok(array) => Ok(Numbers(array)),
        Err(_) => Err(invalid(format!(
            "{what} is being written to by another call"
        ))),
    }
}

/// Shape in the notation of Python.
pub(crate) fn shape_text(shape: &[usize]) -> String {
    match shape {
        [length] => format!("({length},)"),
        _ => {
            let lengths: Vec<String> = shape.iter().map(usize::to_string).collect();
            format!("({})", lengths.join(", "))
        }
    }
}

/// Converts a value that holds real numbers to an array of `T` in C order.
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
    // Complex numbers would lose their imaginary part; texts and dates are not numbers.
    if !matches!(kind.as_str(), "f" | "i" | "u" | "b") {
        return Err(invalid(format!("{what} holds no real numbers but {dtype}")));
    }
    let arguments = PyDict::new(py);
    arguments.set_item(intern!(py, "dtype"), T::get_dtype(py))?;
    let converted = numpy
        .call_method(intern!(py, "ascontiguousarray"), (array,), Some(&arguments))
        .map_err(no_numbers)?;
    // The data of a byte buffer may be misaligned.
    let aligned = converted
        .cast::<PyUntypedArray>()
        .is_ok_and(|array| array.is_aligned());
    match aligned {
        true => Ok(converted),
        false => converted.call_method0(intern!(py, "copy")),
    }
}

/// Size in bytes from which numpy allocates the array: it raises an error when memory does not suffice.
const LARGE_ARRAY_BYTES: usize = 1 << 20;

/// Allocates an array of zeros.
///
/// Raises `MemoryError` when memory does not suffice.
pub(crate) fn zeros<'py, T: Element, D: Dimension>(
    py: Python<'py>,
    shape: D,
) -> PyResult<Bound<'py, PyArray<T, D>>> {
    let lengths = shape.slice().to_vec();
    let count =
        (lengths.iter()).try_fold(size_of::<T>(), |bytes, length| bytes.checked_mul(*length));
    if count.is_some_and(|bytes| bytes < LARGE_ARRAY_BYTES) {
        return Ok(PyArray::zeros(py, shape, false));
    }
    let shape_words = shape_text(&lengths);
    let array = numpy(py)?.call_method1(intern!(py, "zeros"), (lengths, T::get_dtype(py)));
    let array = array.map_err(|error| match error.is_instance_of::<PyMemoryError>(py) {
        true => error,
        // Larger than the address space.
        false => PyMemoryError::new_err(format!(
            "an array of shape {shape_words} is too large: {error}"
        )),
    })?;
    Ok(array.cast_into::<PyArray<T, D>>()?)
}

/// Returns the caller's array to write rows into, or a new one.
pub(crate) fn output_rows<'py>(
    py: Python<'py>,
    out: Option<&Bound<'py, PyAny>>,
    rows: usize,
    columns: usize,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let array = output_array::<f64>(py, out, &[rows, columns])?;
    Ok(array.cast_into::<PyArray2<f64>>()?)
}

/// Returns the caller's array of any shape to write into, or a new one.
pub(crate) fn output_array<'py, T: Element>(
    py: Python<'py>,
    out: Option<&Bound<'py, PyAny>>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    let Some(out) = out else {
        return zeros(py, IxDyn(shape));
    };
    let unfit = || {
        invalid(format!(
            "out must be a writable {} array of shape {} in C order",
            T::get_dtype(py),
            shape_text(shape)
        ))
    };
    let array = out.cast::<PyArrayDyn<T>>().map_err(|_| unfit())?;
    let writable: bool = out
        .getattr(intern!(py, "flags"))?
        .getattr(intern!(py, "writeable"))?
        .extract()?;
    match array.shape() == shape && array.is_c_contiguous() && array.is_aligned() && writable {
        true => Ok(array.clone()),
        false => Err(unfit()),
    }
}

/// Calls `fill` with exclusive access to the numbers of an array in C order.
pub(crate) fn fill<T: Element, D: Dimension>(
    array: &Bound<'_, PyArray<T, D>>,
    fill: impl FnOnce(&mut [T]) -> PyResult<()>,
) -> PyResult<()> {
    let mut writable = array
        .try_readwrite()
        .map_err(|_| invalid("out is being read or written to by another call, or is an input"))?;
    let numbers = writable
        .as_slice_mut()
        .map_err(|error| invalid(error.to_string()))?;
    fill(numbers)
}

/// New list of numbers.
pub(crate) fn list<'py>(py: Python<'py>, values: &[f64]) -> Bound<'py, PyArray1<f64>> {
    PyArray1::from_slice(py, values)
}

/// Numbers of a field, which Python reads as a new array.
#[derive(Clone)]
pub(crate) struct Floats(pub(crate) Vec<f64>);

impl<'py> IntoPyObject<'py> for &Floats {
    type Target = PyArray1<f64>;
    type Output = Bound<'py, PyArray1<f64>>;
    type Error = std::convert::Infallible;

    fn into_pyobject(self, py: Python<'py>) -> Result<Self::Output, Self::Error> {
        Ok(list(py, &self.0))
    }
}

/// Result of indexing a sequence, as in numpy.
pub(crate) enum Picked {
    /// One item, selected by a whole number; negative numbers count from the end.
    One(usize),
    /// Several items, selected by a slice, a mask or a list of numbers: their indices.
    Some(Vec<usize>),
}

/// Reads an index of one or several of `count` items.
pub(crate) fn pick(index: &Bound<'_, PyAny>, count: usize) -> PyResult<Picked> {
    let py = index.py();
    match index.extract::<isize>() {
        Ok(i) if !index.is_instance_of::<PyBool>() => {
            return resolve_index(i, count).map(Picked::One);
        }
        Err(error) if error.is_instance_of::<PyOverflowError>(py) => {
            return Err(out_of_range(index, count));
        }
        _ => {}
    }
    let all = PyArray1::from_iter(py, 0..count as i64);
    let picked = all.as_any().get_item(index)?;
    let indices = picked.cast::<PyArray1<i64>>().ok();
    let indices = indices.and_then(|indices| indices.try_readonly().ok());
    match indices {
        Some(indices) => Ok(Picked::Some(
            indices.as_array().iter().map(|&i| i as usize).collect(),
        )),
        None => Err(PyIndexError::new_err(
            "an index is a whole number, a slice, a mask of shape (N,) or a list of whole numbers",
        )),
    }
}

/// Resolves an index that may count from the end.
pub(crate) fn resolve_index(i: isize, count: usize) -> PyResult<usize> {
    let index = if i < 0 {
        i.checked_add_unsigned(count)
    } else {
        Some(i)
    };
    let index = index.and_then(|index| usize::try_from(index).ok());
    index
        .filter(|&index| index < count)
        .ok_or_else(|| out_of_range(i, count))
}

fn out_of_range(i: impl std::fmt::Display, count: usize) -> PyErr {
    PyIndexError::new_err(format!("index {i} is out of range: there are {count}"))
}

/// New read-only list of numbers: writes to it would be lost.
pub(crate) fn frozen(
    py: Python<'_>,
    values: impl IntoIterator<Item = f64>,
) -> PyResult<Bound<'_, PyArray1<f64>>> {
    let array = PyArray1::from_iter(py, values);
    freeze(&array)?;
    Ok(array)
}

/// Makes an array read-only.
pub(crate) fn freeze<T: Element, D: Dimension>(array: &Bound<'_, PyArray<T, D>>) -> PyResult<()> {
    match array.try_readwrite() {
        Ok(writable) => drop(writable.make_nonwriteable()),
        Err(error) => return Err(invalid(error.to_string())),
    }
    Ok(())
}

/// Reads a whole number of at least 0. The error shows the value.
pub(crate) fn whole<T: TryFrom<u64>>(value: &Bound<'_, PyAny>) -> PyResult<T> {
    let number = value.extract::<u64>().ok();
    let number = number.and_then(|number| T::try_from(number).ok());
    number.ok_or_else(|| {
        invalid(format!(
            "{} is no whole number of at least 0, or too large a one",
            shown(value)
        ))
    })
}

/// As [`whole`], or `None`.
pub(crate) fn whole_or_none<T: TryFrom<u64>>(value: &Bound<'_, PyAny>) -> PyResult<Option<T>> {
    match value.is_none() {
        true => Ok(None),
        false => whole(value).map(Some),
    }
}

/// Reads one number; `what` names it in messages.
pub(crate) fn number(value: &Bound<'_, PyAny>, what: &str) -> PyResult<f64> {
    let number = value.extract();
    number.map_err(|_| invalid(format!("{what} must be a number, not {}", shown(value))))
}

/// Reads a name, such as that of a joint; `what` describes it in messages.
pub(crate) fn name(value: &Bound<'_, PyAny>, what: &str) -> PyResult<String> {
    let name = value.extract();
    name.map_err(|_| invalid(format!("{what} must be a name, not {}", shown(value))))
}

/// Reads a word. The caller compares it with `valid`, which the error lists.
pub(crate) fn word(value: &Bound<'_, PyAny>, what: &str, valid: &[&str]) -> PyResult<String> {
    value.extract().map_err(|_| {
        let valid = valid.join(", ");
        invalid(format!(
            "{what} must be one of {valid}, not {}",
            shown(value)
        ))
    })
}

/// Returns the number if it is neither NaN nor infinite.
pub(crate) fn finite(value: f64, what: &str) -> PyResult<f64> {
    match value.is_finite() {
        true => Ok(value),
        false => Err(invalid(format!("{what} is {value}, which is not finite"))),
    }
}

/// Returns the number if it is within [0, 1].
pub(crate) fn share(value: f32, what: &str) -> PyResult<f32> {
    match (0.0..=1.0).contains(&value) {
        true => Ok(value),
        false => Err(invalid(format!(
            "{what} is {value}, which is not within [0, 1]"
        ))),
    }
}

/// Text of a value in messages.
pub(crate) fn shown(value: &Bound<'_, PyAny>) -> String {
    value
        .repr()
        .map_or_else(|_| "that".to_owned(), |text| text.to_string())
}

/// Numbers in a `repr`: four decimals, the middle of long lists omitted.
pub(crate) fn few(values: &[f64]) -> String {
    const ENDS: usize = 4;
    let texts = |values: &[f64]| {
        let texts: Vec<String> = values.iter().map(|value| format!("{value:.4}")).collect();
        texts.join(", ")
    };
    match values {
        _ if values.len() <= 3 * ENDS => format!("[{}]", texts(values)),
        _ => format!(
            "[{}, ..., {}]",
            texts(&values[..ENDS]),
            texts(&values[values.len() - ENDS..])
        ),
    }
}

/// Reads the items of a dict, empty for None.
pub(crate) fn items<'py>(
    value: Option<&Bound<'py, PyAny>>,
    what: &str,
) -> PyResult<Vec<(Bound<'py, PyAny>, Bound<'py, PyAny>)>> {
    let Some(value) = value else {
        return Ok(Vec::new());
    };
    if let Ok(dict) = value.cast::<PyDict>() {
        return Ok(dict.iter().collect());
    }
    let Ok(mapping) = value.cast::<PyMapping>() else {
        return Err(invalid(format!("{what} must be a dict")));
    };
    mapping.items()?.iter().map(|item| item.extract()).collect()
}
