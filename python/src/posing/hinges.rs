//! Hinges as dicts by bone.

use kinopt::motion::posing::guess_hinges;
use kinopt::skeleton::{Hinge, Hinges, Skeleton};
use kinopt_bindings::hinges::hinges;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays;
use crate::error::invalid;
use crate::object::Object;

/// Hinges of a dict by bone, or guessed ones for `None`.
pub(crate) fn hinges_of(
    skeleton: &Skeleton,
    source: Option<&Bound<'_, PyAny>>,
) -> PyResult<Hinges> {
    let Some(source) = source else {
        let guesses = guess_hinges(skeleton).into_iter();
        return Ok(guesses.map(|guess| (guess.bone, guess.hinge)).collect());
    };
    let dict = source.cast::<PyDict>();
    let dict = dict.map_err(|_| invalid("hinges must be a dict by bone"))?;
    let entry = |(bone, hinge): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
        Ok((arrays::name(&bone, "a bone of hinges")?, Object::of(&hinge)))
    };
    hinges(dict.iter().map(entry).collect::<PyResult<_>>()?)
}

fn entry<'py>(py: Python<'py>, hinge: &Hinge) -> PyResult<Bound<'py, PyDict>> {
    let entry = PyDict::new(py);
    let [x, y, z] = hinge.axis.to_array();
    entry.set_item("axis", (x, y, z))?;
    entry.set_item("range", (hinge.limits.lower, hinge.limits.upper))?;
    Ok(entry)
}

/// Hinges as a dict: {bone: {"axis": (x, y, z), "range": (lower, upper)}}.
pub(crate) fn named<'py>(py: Python<'py>, hinges: &Hinges) -> PyResult<Bound<'py, PyDict>> {
    let by_bone = PyDict::new(py);
    for (bone, hinge) in hinges {
        by_bone.set_item(bone, entry(py, hinge)?)?;
    }
    Ok(by_bone)
}

/// Guessed hinges as a dict, with their rest bends and sources.
pub(crate) fn guessed<'py>(py: Python<'py>, skeleton: &Skeleton) -> PyResult<Bound<'py, PyDict>> {
    let by_bone = PyDict::new(py);
    for guess in guess_hinges(skeleton) {
        let entry = entry(py, &guess.hinge)?;
        entry.set_item("rest_bend", guess.rest_bend)?;
        entry.set_item("source", guess.source.to_string())?;
        by_bone.set_item(guess.bone, entry)?;
    }
    Ok(by_bone)
}
