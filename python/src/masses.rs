//! The masses of whatever has some.

use kinopt::model::Masses;
use pyo3::prelude::*;

use crate::error::{OrRaise, invalid};
use crate::robot::Robot;

/// Those of a robot's file.
pub(crate) fn masses_of(value: &Bound<'_, PyAny>) -> PyResult<Masses> {
    if let Ok(robot) = value.cast::<Robot>() {
        return robot.get().inner.masses().or_raise();
    }
    Err(invalid(format!(
        "a {} has no masses of its own: give the task masses=",
        value.get_type().name()?
    )))
}
