//! Retargeting problems: capture, target, map and options.

use std::sync::Arc;

use kinopt::collision::{self, Checker};
use kinopt::motion::retarget::{
    self, BodyMap, FootShapes, RetargetError, RetargetOptions, Retargeting, UpAxis,
};
use kinopt::robot::Robot;
use kinopt_bindings::Classify;
use pyo3::prelude::*;

use super::capture::Capture;
use super::figure_target::FigureTarget;
use crate::error::{OrRaise, invalid, raise};
use crate::has_model::model_of;
use crate::model::Model;
use crate::world::World;

/// Target of retargeting as a robot: a skeleton is put on a free base.
pub(super) fn target_of(target: &Bound<'_, PyAny>) -> PyResult<Arc<Robot>> {
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

/// Options of retargeting.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(super) struct Options {
    contact_speed: Option<f64>,
    contact_height: Option<f64>,
    acceleration: Option<f64>,
    keep_clear: Option<f64>,
    world: Option<Py<PyAny>>,
    margin: Option<f64>,
}

impl Options {
    /// Margin of collision avoidance, metres; `None` disables it. `keep_clear` is another name of `margin`.
    pub(super) fn margin(&self) -> PyResult<Option<f64>> {
        match (self.keep_clear, self.margin) {
            (Some(_), Some(_)) => Err(invalid(
                "keep_clear and margin are both the smallest distance of links: give one of them",
            )),
            (keep_clear, margin) => Ok(keep_clear
                .or(margin)
                .or(self.world.is_some().then_some(0.0))),
        }
    }

    /// Obstacles, copied at this moment.
    pub(super) fn world(&self, py: Python<'_>) -> PyResult<Option<collision::World>> {
        let Some(value) = &self.world else {
            return Ok(None);
        };
        let value = value.bind(py);
        match value.cast::<World>() {
            Ok(world) => Ok(Some(world.get().snapshot())),
            Err(_) => Err(invalid(format!(
                "world must be a kinopt.World, not {value}"
            ))),
        }
    }

    pub(super) fn read(&self, up: UpAxis) -> RetargetOptions {
        let mut options = RetargetOptions::default().with_up(up);
        let contacts = &mut options.contacts;
        contacts.speed = self.contact_speed.unwrap_or(contacts.speed);
        contacts.height = self.contact_height.unwrap_or(contacts.height);
        options.acceleration = self.acceleration.unwrap_or(options.acceleration);
        options
    }
}

/// Collision checker of a robot with the given margin; `None` without collision avoidance.
fn checker_of(target: &Bound<'_, PyAny>, options: &Options) -> PyResult<Option<Checker>> {
    let Some(margin) = options.margin()? else {
        return Ok(None);
    };
    let robot = target.cast::<crate::robot::Robot>();
    let robot = robot
        .map_err(|_| invalid("keep_clear, world and margin need a Robot with collision shapes"))?;
    let world = options.world(target.py())?.unwrap_or_default();
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
    map: BodyMap,
    options: RetargetOptions,
    checker: Option<Checker>,
}

impl RetargetRequest {
    /// Reads a problem with a map in JSON.
    pub(super) fn read(
        capture: &Bound<'_, Capture>,
        target: &Bound<'_, PyAny>,
        map: &str,
        requested: &Options,
    ) -> PyResult<Self> {
        let robot = target_of(target)?;
        let mut options = requested.read(capture.get().up);
        options.shapes = foot_shapes_of(target);
        Ok(Self {
            capture: Arc::clone(&capture.get().inner),
            map: read_map(map, &robot)?,
            checker: checker_of(target, requested)?,
            robot,
            options,
        })
    }

    /// Fits the capture to the target, with collision avoidance if enabled.
    pub(super) fn fitted(&self) -> Result<Retargeting<'_>, RetargetError> {
        let options = self.options.clone();
        let fitted = Retargeting::new(&self.robot, &self.map, &self.capture, options)?;
        Ok(match &self.checker {
            Some(checker) => fitted.keep_clear(checker),
            None => fitted,
        })
    }

    /// Names of the numbers of a configuration.
    pub(super) fn names(&self) -> Vec<String> {
        let inner = Arc::new(self.robot.model().clone());
        Model { inner }.coordinate_names()
    }
}
