//! Access to the model of an object, and configurations of that model by joint name.

use std::sync::Arc;

use kinopt_bindings::per_joint::configuration_of;
use pyo3::prelude::*;

use crate::error::invalid;
use crate::model::Model;
use crate::named_configuration::by_position;
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

/// Returns a configuration of a model, or of an object that has one, by joint name as an array; other values as they
/// are. Missing joints are at the neutral configuration, and mimic joints of a robot follow.
pub(crate) fn configuration_of_model<'py>(
    holder: &Bound<'_, PyAny>,
    q: &Bound<'py, PyAny>,
    what: &str,
) -> PyResult<Bound<'py, PyAny>> {
    if let Ok(robot) = holder.cast::<Robot>() {
        return robot.get().by_position(q, what);
    }
    by_position(q, |q| {
        let model = model_of(holder)?;
        configuration_of(q, what, &model, model.neutral())
    })
}
