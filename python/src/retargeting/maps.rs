//! Maps guessed from joint names.

use kinopt::motion::retarget::{BodyMap, KnownSkeleton, MapGuess};
use pyo3::prelude::*;

use super::capture::Capture;
use super::request::{raised, read_map, target_of};
use crate::error::OrRaise;
use crate::scene::SceneFile;

/// A guessed map: JSON, the known skeleton, the known body, and notes.
type Guessed = (
    String,
    Option<&'static str>,
    Option<&'static str>,
    Vec<String>,
);

fn guessed(mut guess: MapGuess, capture: &Capture) -> Guessed {
    let up = capture.up.name();
    if let Some(along) = guess.up.filter(|along| *along != capture.up) {
        let along = along.name();
        let note = format!("the body is upright along {along}, but the upward axis is {up}");
        guess.notes.push(note);
    }
    if capture.is_detected {
        let note = format!(
            "the body is upright along {up}, which is used as the upward axis: up= sets it"
        );
        guess.notes.push(note);
    }
    (guess.map.to_json(), guess.skeleton, guess.body, guess.notes)
}

/// Guesses a map from joint names.
#[pyfunction]
pub(super) fn map_guessed(
    capture: &Bound<'_, Capture>,
    target: &Bound<'_, PyAny>,
) -> PyResult<Guessed> {
    let robot = target_of(target)?;
    let mut map = BodyMap::default();
    if let Ok(file) = target.cast::<SceneFile>() {
        map.human_bones = file.try_borrow()?.inner.human_bones();
    }
    let (capture, model) = (capture.get(), robot.model());
    let guess = match map.human_bones.is_empty() {
        true => BodyMap::guess(&capture.inner, model),
        false => map.completed(&capture.inner, model),
    };
    guess.or_raise().map(|guess| guessed(guess, capture))
}

/// The map of a known skeleton.
#[pyfunction]
pub(super) fn map_of_skeleton(
    skeleton: &str,
    capture: &Bound<'_, Capture>,
    target: &Bound<'_, PyAny>,
) -> PyResult<Guessed> {
    let robot = target_of(target)?;
    let skeleton = KnownSkeleton::named(skeleton).or_raise()?;
    let guess = BodyMap::from_skeleton(&skeleton, &capture.get().inner, robot.model());
    guess.or_raise().map(|guess| guessed(guess, capture.get()))
}

/// Completes a map given in JSON: adds drives by name if it has none for the target, and returns notes.
#[pyfunction]
pub(super) fn map_completed(
    map: &str,
    capture: &Bound<'_, Capture>,
    target: &Bound<'_, PyAny>,
) -> PyResult<(Option<String>, Vec<String>)> {
    let robot = target_of(target)?;
    let map = read_map(map, &robot)?;
    let has_no_drives = map.drives.is_empty();
    let guess = map
        .completed(&capture.get().inner, robot.model())
        .map_err(raised)?;
    let (map, .., notes) = guessed(guess, capture.get());
    Ok((has_no_drives.then_some(map), notes))
}

/// Names of the known skeletons.
#[pyfunction]
pub(super) fn skeleton_names() -> Vec<&'static str> {
    KnownSkeleton::names().collect()
}

/// Names of the first joints of a known skeleton; None if it does not fit an array of `joints` joints.
#[pyfunction]
pub(super) fn skeleton_joints(skeleton: &str, joints: usize) -> PyResult<Option<Vec<String>>> {
    let known = KnownSkeleton::named(skeleton).or_raise()?;
    Ok(known.joints_of_array(joints).map(<[String]>::to_vec))
}
