//! Scores of robot motions.

use std::path::PathBuf;

use kinopt::motion::path::QuaternionOrder;
use kinopt::motion::retarget::{BodyMap, ContactDetection, FootShapes};
use kinopt::motion::score::{Heading, MotionScorer, ScoreWeights};
use kinopt::robot::Robot;
use kinopt_bindings::motion_file::{MotionReading, RobotMotion};
use numpy::ndarray::Ix2;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::capture::Capture;
use super::request::{foot_shapes_of, read_map, target_of};
use crate::arrays::{self, Numbers};
use crate::error::{OrRaise, invalid};

/// Frames per second of a motion without a rate.
const DEFAULT_RATE: f64 = 30.0;

/// Score of a motion as a JSON document. `motion` is an array (T, nq) or the path of a file; `map` is JSON.
#[pyfunction]
pub(super) fn motion_scored(
    py: Python<'_>,
    motion: &Bound<'_, PyAny>,
    target: &Bound<'_, PyAny>,
    capture: Option<&Bound<'_, Capture>>,
    map: Option<&str>,
    options: &Bound<'_, PyDict>,
) -> PyResult<String> {
    let robot = target_of(target)?;
    let subject_rate = capture.map(|capture| capture.get().inner.frame_rate());
    let motion = read_motion(motion, &robot, subject_rate, options)?;
    let rate = motion.frame_rate.or(subject_rate).unwrap_or(DEFAULT_RATE);
    let map: Option<BodyMap> = map.map(|map| read_map(map, &robot)).transpose()?;
    let mut scorer = match (capture, &map) {
        (Some(capture), Some(map)) => {
            let capture = capture.get();
            MotionScorer::of_subject(&robot, &capture.inner, map, capture.up).or_raise()?
        }
        _ => MotionScorer::new(&robot),
    };
    scorer = apply(scorer, options)?;
    if let Some(shapes) = foot_shapes_of(target) {
        scorer = scorer.with_shapes(shapes);
    } else {
        scorer = scorer.with_shapes(FootShapes::of(&robot));
    }
    if required(options, "collisions")? {
        let robot = target.cast::<crate::robot::Robot>();
        let robot = robot.map_err(|_| invalid("collisions need a Robot with collision shapes"))?;
        scorer = scorer.with_collisions(&robot.get().checker()?);
    }
    let score = py.detach(|| scorer.score(&motion.q, rate)).or_raise()?;
    serde_json::to_string(&score).or_raise()
}

/// Motion of an array or a file.
fn read_motion(
    motion: &Bound<'_, PyAny>,
    robot: &Robot,
    subject_rate: Option<f64>,
    options: &Bound<'_, PyDict>,
) -> PyResult<RobotMotion> {
    let fps: Option<f64> = optional(options, "fps")?;
    let quaternion: Option<String> = optional(options, "quaternion")?;
    let quaternion = match quaternion.as_deref() {
        None => None,
        Some("xyzw") => Some(QuaternionOrder::WLast),
        Some("wxyz") => Some(QuaternionOrder::WFirst),
        Some(other) => {
            return Err(invalid(format!(
                "quaternion is {other:?}, expected \"xyzw\" or \"wxyz\""
            )));
        }
    };
    let Ok(path) = motion.extract::<PathBuf>() else {
        let numbers: Numbers<'_, Ix2> = arrays::numbers(motion, "motion", "(T, nq)")?;
        let width = robot.model().configuration_len();
        if numbers.shape()[1] != width {
            return Err(invalid(format!(
                "motion has shape {}, expected (T, {width})",
                arrays::shape_text(numbers.shape())
            )));
        }
        return Ok(RobotMotion {
            q: numbers.to_vec(),
            frame_rate: fps,
        });
    };
    let is_scene = path.extension().is_some_and(|extension| {
        ["glb", "gltf", "vrm"]
            .iter()
            .any(|scene| extension.eq_ignore_ascii_case(scene))
    });
    let reading = MotionReading {
        quaternion,
        // Samples of a scene have the rate of the subject.
        frame_rate: fps.or(subject_rate.filter(|_| is_scene)),
        clip: None,
    };
    RobotMotion::read(robot, &path, &reading).or_raise()
}

fn apply<'r>(scorer: MotionScorer<'r>, options: &Bound<'_, PyDict>) -> PyResult<MotionScorer<'r>> {
    let heading = match options.get_item("heading")? {
        Some(heading) if !heading.is_none() => match heading.extract::<f64>() {
            Ok(degrees) => Heading::Fixed(degrees.to_radians()),
            Err(_) if heading.extract::<&str>().is_ok_and(|text| text == "fit") => Heading::Fitted,
            Err(_) => {
                return Err(invalid(format!(
                    "heading is {heading}, expected degrees or \"fit\""
                )));
            }
        },
        _ => Heading::default(),
    };
    let mut weights = ScoreWeights::default();
    let given: Option<Vec<(String, f64)>> = optional(options, "weights")?;
    for (name, weight) in given.into_iter().flatten() {
        weights.set(&name, weight).or_raise()?;
    }
    let usual = ContactDetection::default();
    let speed: Option<f64> = optional(options, "contact_speed")?;
    let height: Option<f64> = optional(options, "contact_height")?;
    let contacts = usual
        .with_speed(speed.unwrap_or(usual.speed))
        .with_height(height.unwrap_or(usual.height));
    Ok(scorer
        .with_start(required(options, "start")?)
        .with_ground(required(options, "ground")?)
        .with_heading(heading)
        .with_weights(weights)
        .with_contacts(contacts))
}

/// Option that may be None.
fn optional<'py, T: FromPyObjectOwned<'py>>(
    options: &Bound<'py, PyDict>,
    name: &str,
) -> PyResult<Option<T>> {
    match options.get_item(name)? {
        Some(value) if !value.is_none() => value.extract::<T>().map(Some).map_err(Into::into),
        _ => Ok(None),
    }
}

/// Option with a value.
fn required<'py, T: FromPyObjectOwned<'py>>(
    options: &Bound<'py, PyDict>,
    name: &str,
) -> PyResult<T> {
    optional(options, name)?.ok_or_else(|| invalid(format!("{name} is missing")))
}
