//! A whole movement, and the truth about it.

use kinopt::motion::clip::MotionBound;
use kinopt::motion::retarget::{RetargetError, UpAxis};
use kinopt::solver::Side;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

use super::capture::Capture;
use super::question::{Options, Question, raised};
use crate::arrays;

/// What `kinopt.Retargeted` is made of: numbers and names in the order of its fields.
type MovementParts<'py> = (
    Bound<'py, PyArray2<f64>>,
    Vec<String>,
    Bound<'py, PyAny>,
    (Vec<String>, Bound<'py, PyArray2<f64>>),
    Bound<'py, PyArray2<f64>>,
    Vec<String>,
    (f64, f64, f64, f64),
    Vec<(String, &'static str, usize, usize)>,
    Vec<(usize, String, String, f64)>,
    Vec<(usize, String)>,
    Option<&'static str>,
);

/// A capture on a target by a map (JSON).
#[pyfunction]
pub(super) fn capture_retargeted<'py>(
    py: Python<'py>,
    capture: &Bound<'py, Capture>,
    target: &Bound<'py, PyAny>,
    map: &str,
    whole: bool,
    options: Options,
) -> PyResult<MovementParts<'py>> {
    let question = Question::read(capture, target, map, &options)?;
    let found = py.detach(|| {
        let retargeting = question.fitted()?;
        let found = match whole {
            true => retargeting.whole()?,
            false => retargeting.per_frame()?,
        };
        let errors = retargeting.errors(&found)?;
        let limits = retargeting.limits_met(&found);
        let driving = retargeting.driving();
        let stride = retargeting.stride();
        let up = retargeting.model_stands_along();
        Ok::<_, RetargetError>((found, errors, limits, driving, stride, up))
    });
    let (found, errors, limits, driving, stride, up) = found.map_err(raised)?;
    let driven = driving
        .iter()
        .map(|&joint| question.capture.names()[joint].clone());
    let limits = limits.into_iter().map(|met| {
        let side = match (met.bound, met.side) {
            (MotionBound::Speed, Side::Lower) => "speed down",
            (MotionBound::Speed, Side::Upper) => "speed up",
            (_, Side::Lower) => "lower",
            (_, Side::Upper) => "upper",
        };
        (met.joint, side, met.frames.start, met.frames.end)
    });
    let touching = found.touching.into_iter().map(|own| {
        let pair = own.pair;
        (own.frame, pair.first, pair.second, pair.distance)
    });
    let given_up = found.given_up.into_iter();
    let given_up = given_up.map(|own| (own.frame, own.standing));
    let frames = found.q.len() / found.configuration_len.max(1);
    let contacts = PyArray1::from_slice(py, &found.contacts);
    let points = found.standing_at.iter();
    let standing_at: Vec<f64> = points.flat_map(|at| at.to_array()).collect();
    Ok((
        arrays::list(py, &found.q).reshape([frames, found.configuration_len])?,
        question.names(),
        contacts.reshape([frames, found.standing.len()])?.into_any(),
        (
            found.standing,
            arrays::list(py, &standing_at).reshape([found.standing_at.len(), 3])?,
        ),
        arrays::list(py, &errors).reshape([frames, driving.len()])?,
        driven.collect(),
        (found.mean_error, found.slip, found.sunk, stride),
        limits.collect(),
        touching.collect(),
        given_up.collect(),
        up.filter(|up| *up == UpAxis::Y).map(|_| "y"),
    ))
}
