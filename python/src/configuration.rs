//! Operations on configurations: integration, difference, interpolation.

use kinopt::model::ModelError;
use numpy::ndarray::IxDyn;
use pyo3::prelude::*;

use crate::arrays::{Queries, fill};
use crate::error::{OrRaise, invalid};

/// Rows between two checks for signals.
const ROWS_AT_A_TIME: usize = 4096;

/// Computes one row for each row of numbers: a list for a list, a table for a table.
pub(crate) fn of_one<'py>(
    argument: (&Bound<'py, PyAny>, &str, usize),
    width: usize,
    compute: impl Fn(&[f64], &mut [f64]) -> Result<(), ModelError> + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    of_two(argument, argument, width, |q, _, computed| {
        compute(q, computed)
    })
}

/// Computes one row for each pair of rows. Each argument is a list or a table; one list pairs with all rows of a table.
pub(crate) fn of_two<'py>(
    (first, first_is, first_width): (&Bound<'py, PyAny>, &str, usize),
    (second, second_is, second_width): (&Bound<'py, PyAny>, &str, usize),
    width: usize,
    compute: impl Fn(&[f64], &[f64], &mut [f64]) -> Result<(), ModelError> + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    let py = first.py();
    let first = Queries::rows(first, first_is, first_width)?;
    let second = Queries::rows(second, second_is, second_width)?;
    let both = [&first, &second];
    let [first_rows, second_rows] = both.map(Queries::count);
    if first_rows != second_rows && first_rows != 1 && second_rows != 1 {
        return Err(invalid(format!(
            "{first_is} has {first_rows} rows and {second_is} {second_rows}: expected equal numbers, \
             or one row of either"
        )));
    }
    let table = both.iter().any(|rows| rows.is_table());
    let count = if first_rows == 1 {
        second_rows
    } else {
        first_rows
    };
    let shape: Vec<usize> = table.then_some(count).into_iter().chain([width]).collect();
    let array = crate::arrays::zeros::<f64, _>(py, IxDyn(&shape))?;
    let (first, second) = (first.all(), second.all());
    // A single row pairs with every row of the other argument.
    let row_range = |row: usize, rows: usize, width: usize| {
        let first = if rows == 1 { 0 } else { row * width };
        first..first + width
    };
    fill(&array, |buffer| {
        for start in (0..count).step_by(ROWS_AT_A_TIME) {
            py.check_signals()?;
            py.detach(|| {
                (start..count.min(start + ROWS_AT_A_TIME)).try_for_each(|row| {
                    let row_buffer = &mut buffer[row * width..(row + 1) * width];
                    compute(
                        &first[row_range(row, first_rows, first_width)],
                        &second[row_range(row, second_rows, second_width)],
                        row_buffer,
                    )
                    .or_raise()
                })
            })?;
        }
        Ok(())
    })?;
    Ok(array.into_any())
}
