//! Access to the model of an object.

use std::sync::Arc;

use pyo3::prelude::*;

use crate::error::invalid;
use crate::model::Model;
use crate::robot::Robot;

/// Returns a `Model`, or the model of an object that has one.
pub(crate) fn model_of(value: &Bound<'_, PyAny>) -> PyResult<Arc<kinopt::Model>> {
    if let Ok(model) = value.cast::<Model>() {
        return Ok(Arc::clone(&model.get().inner));
    }
    if let Ok(robot) = value.cast::<Robot>() {
        return Ok(Arc::clone(&robot.get().model));
    }
    match value.getattr_opt("model")? {
        Some(model) if !model.is(value) => model_of(&model),
        _ => Err(invalid(format!(
            "expected a model, a robot, a skeleton or a rig, not {}; \
             `Armature.skeleton` returns the skeleton of a scene's armature",
            value.get_type().name()?
        ))),
    }
}
