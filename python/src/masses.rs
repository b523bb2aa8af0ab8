//! The masses of whatever has some.

use std::sync::Arc;

use kinopt::model::Masses;
use pyo3::prelude::*;

use crate::error::{OrRaise, invalid};
use crate::rig::Rig;
use crate::robot::Robot;

/// Of flesh, kg/m³.
const DENSITY: f64 = 1000.0;

/// Those of a robot's file, or of a rig by the volume of its mesh.
pub(crate) fn masses_of(value: &Bound<'_, PyAny>) -> PyResult<Masses> {
    if let Ok(robot) = value.cast::<Robot>() {
        return robot.get().inner.masses().or_raise();
    }
    if let Ok(rig) = value.cast::<Rig>() {
        let rig = Arc::clone(&rig.get().inner);
        return value.py().detach(|| rig.masses(DENSITY)).or_raise();
    }
    Err(invalid(format!(
        "a {} has no masses of its own: give the task masses=",
        value.get_type().name()?
    )))
}
