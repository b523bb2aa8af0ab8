//! Configurations moved, compared and mixed, one or many.

use kinopt::model::ModelError;
use numpy::PyArray;
use numpy::ndarray::IxDyn;
use pyo3::prelude::*;

use crate::arrays::{Questions, fill};
use crate::error::{OrRaise, invalid};

/// Rows between two looks at signals.
const PIECE: usize = 4096;

/// One row for each of two that go together: lists of numbers or tables of as many rows.
pub(crate) fn of_two<'py>(
    (first, first_is, first_width): (&Bound<'py, PyAny>, &str, usize),
    (second, second_is, second_width): (&Bound<'py, PyAny>, &str, usize),
    width: usize,
    compute: impl Fn(&[f64], &[f64], &mut [f64]) -> Result<(), ModelError> + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    let py = first.py();
    let first = Questions::rows(first, first_is, first_width)?;
    let second = Questions::rows(second, second_is, second_width)?;
    let shape = match (first.shape(&[]), second.shape(&[])) {
        (one, other) if one == other => first.shape(&[width]),
        _ => {
            return Err(invalid(format!(
                "{first_is} has {} rows and {second_is} {}: they go together one by one",
                first.count(),
                second.count()
            )));
        }
    };
    let array = PyArray::<f64, IxDyn>::zeros(py, shape, false);
    let mut others = second.all().chunks_exact(second_width.max(1));
    fill(&array, |room| {
        first.each(py, room, PIECE, |row, to| {
            let other = others.next().unwrap_or_default();
            compute(row, other, to).or_raise()
        })
    })?;
    Ok(array.into_any())
}
