//! Retargeting problems: capture, target, map and options.

use std::sync::Arc;

use kinopt::collision::{self, Checker};
use kinopt::motion::retarget::{
    self, BodyMap, FootShapes, HeldObject, RetargetError, RetargetOptions, Retargeting, Terrain,
    UpAxis,
};
use kinopt::robot::Robot;
use kinopt_bindings::{Arguments, Classify, Value, coordinates, option};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::capture::Capture;
use super::figure_target::FigureTarget;
use crate::error::{OrRaise, invalid, raise};
use crate::has_model::model_of;
use crate::object::Options;
use crate::world::World;

/// Target of retargeting as a robot: a skeleton is put on a free base.
pub(crate) fn target_of(target: &Bound<'_, PyAny>) -> PyResult<Arc<Robot>> {
    if let Ok(robot) = target.cast::<crate::robot::Robot>() {
        return Ok(Arc::clone(&robot.get().inner));
    }
    if let Ok(figure) = target.cast::<FigureTarget>() {
        return Ok(Arc::new(figure.get().inner.robot().clone()));
    }
    if let Some(figure) = FigureTarget::of(target, None)? {
        return Ok(Arc::new(figure.inner.robot().clone()));
    }
    let model = model_of(target)?;
    let robot = Robot::new(kinopt::Model::clone(&model), Vec::new()).or_raise()?;
    Ok(Arc::new(robot))
}

/// Target of retargeting as a character; `None` for a robot or a model.
fn character_of(target: &Bound<'_, PyAny>) -> PyResult<Option<retarget::FigureTarget>> {
    if let Ok(figure) = target.cast::<FigureTarget>() {
        return Ok(Some(figure.get().inner.clone()));
    }
    Ok(FigureTarget::of(target, None)?.map(|figure| figure.inner))
}

/// Margin of collision avoidance, metres; `None` disables it. `keep_clear` is another name of `margin`.
pub(super) fn margin(options: &Options<'_, '_>) -> PyResult<Option<f64>> {
    let number = |name: &str| {
        let value = options.get(name)?;
        value.map(|value| value.number(name)).transpose()
    };
    match (number("keep_clear")?, number("margin")?) {
        (Some(_), Some(_)) => Err(invalid(
            "keep_clear and margin are both the smallest distance of links: give one of them",
        )),
        (keep_clear, margin) => {
            let default = options.get("world")?.map(|_| 0.0);
            Ok(keep_clear.or(margin).or(default))
        }
    }
}

/// Obstacles, copied at this moment.
pub(super) fn world(options: &Options<'_, '_>) -> PyResult<Option<collision::World>> {
    let value = options.0.get_item("world")?;
    let Some(value) = value.filter(|value| !value.is_none()) else {
        return Ok(None);
    };
    match value.cast::<World>() {
        Ok(world) => Ok(Some(world.get().snapshot())),
        Err(_) => Err(invalid(format!(
            "world must be a kinopt.World, not {value}"
        ))),
    }
}

/// Reads the options of the library.
pub(super) fn retarget_options(options: &Options<'_, '_>, up: UpAxis) -> PyResult<RetargetOptions> {
    let defaults = RetargetOptions::default().with_up(up);
    option::apply(options, &option::retarget::options(), defaults)
}

/// Collision checker of a robot with the given margin; `None` without collision avoidance.
fn checker_of(target: &Bound<'_, PyAny>, options: &Options<'_, '_>) -> PyResult<Option<Checker>> {
    let Some(margin) = margin(options)? else {
        return Ok(None);
    };
    let robot = target.cast::<crate::robot::Robot>();
    let robot = robot
        .map_err(|_| invalid("keep_clear, world and margin need a Robot with collision shapes"))?;
    let world = world(options)?.unwrap_or_default();
    let checker = robot.get().checker()?.with_world(&world).or_raise()?;
    Ok(Some(checker.with_margin(margin).or_raise()?))
}

/// Shapes of a robot's feet, including meshes.
pub(super) fn foot_shapes_of(target: &Bound<'_, PyAny>) -> Option<FootShapes> {
    let robot = target.cast::<crate::robot::Robot>().ok()?;
    Some(robot.get().foot_shapes())
}

/// Reads a map in JSON; a map of several robots has the drives of each under the name of its file.
pub(super) fn read_map(map: &str, robot: &Robot) -> PyResult<BodyMap> {
    let file = robot.file().and_then(std::path::Path::file_name);
    let file = file.map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    BodyMap::from_json(map, &file).map_err(raised)
}

/// Exception of an error. An error about the map sets `_of_map`, for callers that know the map's file.
pub(super) fn raised(error: RetargetError) -> PyErr {
    let raised = raise(error.kind(), error.to_string());
    if error.is_of_map() {
        Python::attach(|py| {
            // If it fails, the message only lacks the name of the file.
            let _ = raised.value(py).setattr("_of_map", true);
        });
    }
    raised
}

/// A capture, a target, the map between them and the options.
pub(super) struct RetargetRequest {
    pub(super) capture: Arc<retarget::Capture>,
    robot: Arc<Robot>,
    character: Option<retarget::FigureTarget>,
    map: BodyMap,
    options: RetargetOptions,
    checker: Option<Checker>,
    object: Option<HeldObject>,
}

/// Text of an option in JSON.
fn json(options: &Options<'_, '_>, name: &str) -> PyResult<Option<String>> {
    let value = options.0.get_item(name)?;
    let value = value.filter(|value| !value.is_none());
    value.map(|value| value.extract()).transpose()
}

impl RetargetRequest {
    /// Reads a problem with a map in JSON.
    pub(super) fn read(
        capture: &Bound<'_, Capture>,
        target: &Bound<'_, PyAny>,
        map: &str,
        requested: &Bound<'_, PyDict>,
    ) -> PyResult<Self> {
        let robot = target_of(target)?;
        let requested = Options(requested);
        let mut options = retarget_options(&requested, capture.get().up)?;
        options.shapes = foot_shapes_of(target);
        let terrain = json(&requested, "terrain")?;
        options.terrain = terrain
            .map(|text| Terrain::from_json(&text))
            .transpose()
            .map_err(raised)?;
        let object = json(&requested, "held_object")?;
        Ok(Self {
            object: object
                .map(|text| HeldObject::from_json(&text))
                .transpose()
                .map_err(raised)?,
            capture: Arc::clone(&capture.get().inner),
            map: read_map(map, &robot)?,
            checker: checker_of(target, &requested)?,
            character: character_of(target)?,
            robot,
            options,
        })
    }

    /// Fits the capture to the target, with collision avoidance if enabled.
    pub(super) fn fitted(&self) -> Result<Retargeting<'_>, RetargetError> {
        let options = self.options.clone();
        let fitted = match &self.character {
            Some(figure) => Retargeting::onto_character(figure, &self.map, &self.capture, options)?,
            None => Retargeting::new(&self.robot, &self.map, &self.capture, options)?,
        };
        let fitted = match &self.object {
            Some(object) => fitted.with_object(object, &self.capture)?,
            None => fitted,
        };
        Ok(match &self.checker {
            Some(checker) => fitted.keep_clear(checker),
            None => fitted,
        })
    }

    /// Names of the numbers of a configuration.
    pub(super) fn names(&self) -> Vec<String> {
        coordinates::names(self.robot.model())
    }
}
