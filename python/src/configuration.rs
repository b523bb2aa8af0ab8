//! Operations on one configuration or several: integration, difference, interpolation.

use kinopt::model::ModelError;
use numpy::ndarray::IxDyn;
use pyo3::prelude::*;

use crate::arrays::{Questions, fill};
use crate::error::{OrRaise, invalid};

/// Rows between two checks for signals.
const PIECE: usize = 4096;

/// Computes one row for each row of numbers: a list for a list, a table for a table.
pub(crate) fn of_one<'py>(
    given: (&Bound<'py, PyAny>, &str, usize),
    width: usize,
    compute: impl Fn(&[f64], &mut [f64]) -> Result<(), ModelError> + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    of_two(given, given, width, |q, _, computed| compute(q, computed))
}

/// Computes one row for each pair of rows. Each argument is a list or a table; one list pairs with all rows of a table.
pub(crate) fn of_two<'py>(
    (first, first_is, first_width): (&Bound<'py, PyAny>, &str, usize),
    (second, second_is, second_width): (&Bound<'py, PyAny>, &str, usize),
    width: usize,
    compute: impl Fn(&[f64], &[f64], &mut [f64]) -> Result<(), ModelError> + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    let py = first.py();
    let first = Questions::rows(first, first_is, first_width)?;
    let second = Questions::rows(second, second_is, second_width)?;
    let both = [&first, &second];
    let [one, other] = both.map(Questions::count);
    if one != other && one != 1 && other != 1 {
        return Err(invalid(format!(
            "{first_is} has {one} rows and {second_is} {other}: expected equal numbers, or one row of either"
        )));
    }
    let table = both.iter().any(|rows| rows.is_table());
    let count = if one == 1 { other } else { one };
    let shape: Vec<usize> = table.then_some(count).into_iter().chain([width]).collect();
    let array = crate::arrays::zeros::<f64, _>(py, IxDyn(&shape))?;
    let (first, second) = (first.all(), second.all());
    // A single row pairs with every row of the other argument.
    let at = |row: usize, rows: usize, width: usize| {
        let first = if rows == 1 { 0 } else { row * width };
        first..first + width
    };
    fill(&array, |room| {
        for start in (0..count).step_by(PIECE) {
            py.check_signals()?;
            py.detach(|| {
                (start..count.min(start + PIECE)).try_for_each(|row| {
                    let to = &mut room[row * width..(row + 1) * width];
                    compute(
                        &first[at(row, one, first_width)],
                        &second[at(row, other, second_width)],
                        to,
                    )
                    .or_raise()
                })
            })?;
        }
        Ok(())
    })?;
    Ok(array.into_any())
}
