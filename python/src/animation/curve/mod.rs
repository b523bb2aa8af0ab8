//! Curves through keys: numbers, vectors, rotations and angles over time.

pub(super) mod easing;
mod euler;
mod keyed;
mod rotation;

use numpy::PyArrayDyn;
use pyo3::prelude::*;

use crate::arrays::{self, Questions};
use crate::transforms::numbers;
pub(crate) use euler::EulerCurve;
pub(crate) use keyed::{KeyedCurve, Values};
pub(crate) use rotation::RotationCurve;

/// Times that are looked at between two looks at signals.
const TIMES_AT_A_TIME: usize = 4096;

/// Key times.
fn times_of(value: &Bound<'_, PyAny>) -> PyResult<Vec<f32>> {
    numbers(value, "times", None)
}

/// What is there at one time or at many, numbers of the shape `each` at a time.
fn sampled<'py>(
    times: &Bound<'py, PyAny>,
    each: &[usize],
    at: impl Fn(f32, &mut [f32]) + Sync,
) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
    let py = times.py();
    let times = Questions::numbers(times, "times")?;
    let array = arrays::room_of::<f32>(py, None, &times.shape(each))?;
    arrays::fill(&array, |room| {
        times.each(py, room, TIMES_AT_A_TIME, |time, room| {
            at(arrays::finite(time[0], "times")? as f32, room);
            Ok(())
        })
    })?;
    Ok(array)
}
