//! Masses of robots and rigs.

use kinopt::model::Masses;

use crate::error::{Exception, raise};
use crate::model::Model;

/// Density of flesh, kg/m³.
const DENSITY: f64 = 1000.0;

/// Masses of a robot from its file, or of a rig by the volume of its mesh.
pub(crate) fn masses_of(model: &Model) -> Result<Masses, Exception> {
    match (&model.robot, &model.rig) {
        (Some(robot), _) => robot.masses().map_err(raise),
        (None, Some(rig)) => rig.masses(DENSITY).map_err(raise),
        (None, None) => Err(Exception::new(
            "the model has no masses: set `masses` of the task",
        )),
    }
}
