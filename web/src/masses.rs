//! The masses of whatever has some.

use std::rc::Rc;

use kinopt::io::rig::Rig;
use kinopt::model::Masses;
use kinopt::robot::Robot;
use wasm_bindgen::prelude::*;

use crate::model::Model;
use crate::raise;

/// Of flesh, kg/m³.
const DENSITY: f64 = 1000.0;

/// What has the masses of a model's frames.
#[derive(Clone)]
pub(crate) enum Body {
    Robot(Rc<Robot>),
    Rig(Rc<Rig>),
}

/// Those of a robot's file, or of a rig by the volume of its mesh.
pub(crate) fn masses_of(model: &Model) -> Result<Masses, JsError> {
    match &model.body {
        Some(Body::Robot(robot)) => robot.masses().map_err(raise),
        Some(Body::Rig(rig)) => rig.masses(DENSITY).map_err(raise),
        None => Err(JsError::new(
            "this model has no masses of its own: give the task `masses`",
        )),
    }
}
