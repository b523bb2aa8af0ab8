//! Easing functions.

use kinopt::animation::{BezierEasing, Easing};
use numpy::PyArrayDyn;
use pyo3::prelude::*;

use super::TIMES_AT_A_TIME;
use crate::arrays::Queries;
use crate::error::{OrRaise, invalid};

/// Eased fraction for fractions `t` of the time, within [0, 1]; float64 of the shape of `t`, () or (N,).
///
/// `how` is "linear", "quadratic_in", "quadratic_out", "quadratic_in_out", "cubic_in", "cubic_out", "cubic_in_out", or
/// two handles ((time, value), (time, value)), as in CSS's cubic-bezier.
///
/// Raises `InvalidValueError` for another name, for handles with times that are not within [0, 1], and for fractions of
/// another shape.
#[pyfunction]
pub(crate) fn easing<'py>(
    how: &Bound<'py, PyAny>,
    t: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let py = how.py();
    let easing = read_easing(how)?;
    let fractions = Queries::numbers(t, "t")?;
    fractions.compute((py, None), &[], TIMES_AT_A_TIME, |t, buffer| {
        buffer[0] = easing.at(t[0]);
        Ok(())
    })
}

pub(super) fn read_easings(values: &[Bound<'_, PyAny>]) -> PyResult<Vec<Easing>> {
    values.iter().map(read_easing).collect()
}

fn read_easing(value: &Bound<'_, PyAny>) -> PyResult<Easing> {
    if let Ok(name) = value.extract::<String>() {
        let quoted = serde_json::to_string(&name).or_raise()?;
        return serde_json::from_str(&quoted).or_raise();
    }
    let [first, second]: [[f32; 2]; 2] = value.extract().map_err(|_| {
        invalid("an easing is a name or two handles ((time, value), (time, value))")
    })?;
    BezierEasing::new(first, second)
        .or_raise()
        .map(Easing::Bezier)
}
