//! Centres of mass of robots and rigs.

use std::sync::Arc;

use kinopt::kinematics::{centre_of_mass, centre_of_mass_jacobian};
use kinopt::model::Masses;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::Queries;
use crate::error::{OrRaise, invalid};
use crate::rig::Rig;
use crate::robot::Robot;

/// Density of flesh, kg/m³.
pub(crate) const DENSITY: f64 = 1000.0;

/// Rows between two checks for signals.
const ROWS_AT_A_TIME: usize = 256;

/// Centre of mass at one configuration, shape (3,), or at several, shape (N, 3).
pub(crate) fn centres<'py>(
    q: &Bound<'py, PyAny>,
    model: &kinopt::Model,
    masses: &Masses,
) -> PyResult<Bound<'py, PyAny>> {
    let q_rows = Queries::rows(q, "q", model.configuration_len())?;
    let array = q_rows.compute((q.py(), None), &[3], ROWS_AT_A_TIME, |q, row_buffer| {
        let centre = centre_of_mass(model, masses, q).or_raise()?;
        row_buffer.copy_from_slice(&centre.to_array());
        Ok(())
    })?;
    Ok(array.into_any())
}

/// Jacobian of the centre of mass: shape (3, nv), or (N, 3, nv).
pub(crate) fn centres_jacobians<'py>(
    q: &Bound<'py, PyAny>,
    model: &kinopt::Model,
    masses: &Masses,
) -> PyResult<Bound<'py, PyAny>> {
    let q_rows = Queries::rows(q, "q", model.configuration_len())?;
    let shape = [3, model.degrees_of_freedom()];
    let array = q_rows.compute((q.py(), None), &shape, ROWS_AT_A_TIME, |q, row_buffer| {
        let jacobian = centre_of_mass_jacobian(model, masses, q).or_raise()?;
        row_buffer.copy_from_slice(jacobian.transpose().as_slice());
        Ok(())
    })?;
    Ok(array.into_any())
}

/// Masses as a dict: {"frame": (kg, (x, y, z))}.
pub(crate) fn by_frame<'py>(
    py: Python<'py>,
    model: &kinopt::Model,
    masses: &Masses,
) -> PyResult<Bound<'py, PyDict>> {
    let (frames, by_frame) = (model.frames(), PyDict::new(py));
    for point in masses.points() {
        let [x, y, z] = point.at.to_array();
        by_frame.set_item(&frames[point.frame.index()].name, (point.mass, (x, y, z)))?;
    }
    Ok(by_frame)
}

/// Masses of a robot from its file, or of a rig by the volume of its mesh.
pub(crate) fn masses_of(value: &Bound<'_, PyAny>) -> PyResult<Masses> {
    if let Ok(robot) = value.cast::<Robot>() {
        return robot.get().inner.masses().or_raise();
    }
    if let Ok(rig) = value.cast::<Rig>() {
        let rig = Arc::clone(&rig.get().inner);
        return value.py().detach(|| rig.masses(DENSITY)).or_raise();
    }
    Err(invalid(format!(
        "a {} has no masses: set masses= of the task",
        value.get_type().name()?
    )))
}
