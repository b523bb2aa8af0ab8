//! Curves through keys: numbers, vectors, rotations and angles over time.

pub(super) mod easing;
mod euler;
mod keyed;
mod rotation;

use numpy::PyArrayDyn;
use pyo3::prelude::*;

use crate::arrays::{self, Queries};
use crate::transforms::numbers;
pub(crate) use euler::EulerCurve;
pub(crate) use keyed::{KeyedCurve, Values};
pub(crate) use rotation::RotationCurve;

/// Number of times between two checks for signals.
const TIMES_AT_A_TIME: usize = 4096;

/// Reads key times.
fn times_of(value: &Bound<'_, PyAny>) -> PyResult<Vec<f32>> {
    numbers(value, "times", None)
}

/// Samples at one time or several, with numbers of the shape `each` for one time.
fn sampled<'py>(
    times: &Bound<'py, PyAny>,
    each: &[usize],
    at: impl Fn(f32, &mut [f32]) + Sync,
) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
    let py = times.py();
    let times = Queries::numbers(times, "times")?;
    times.compute((py, None), each, TIMES_AT_A_TIME, |time, buffer| {
        at(arrays::finite(time[0], "times")? as f32, buffer);
        Ok(())
    })
}
