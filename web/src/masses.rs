//! Masses of robots and rigs.

use kinopt::model::Masses;
use wasm_bindgen::prelude::*;

use crate::error::{Exception, raise};
use crate::model::Model;
use crate::object;
use crate::rig::Rig;
use crate::robot::Robot;
#[cfg(feature = "gltf")]
use crate::scene::Scene;

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

#[wasm_bindgen]
extern "C" {
    /// Masses as an object.
    #[wasm_bindgen(typescript_type = "Record<string, Float64Array>")]
    pub type FrameMasses;
}

#[wasm_bindgen]
impl Robot {
    /// Masses by link: kilograms, and the centre of mass in the link's coordinates, metres. The option `masses` of tasks
    /// takes them.
    #[wasm_bindgen(getter)]
    pub fn masses(&self) -> Result<FrameMasses, Exception> {
        let masses = self.inner.masses().map_err(raise)?;
        Ok(by_frame(self.inner.model(), &masses))
    }
}

#[wasm_bindgen]
impl Rig {
    /// Masses by bone: kilograms by the volume of its part of the mesh at 1000 kg/m³, and the centre of mass in the
    /// coordinates of the bone's first frame. The option `masses` of tasks takes them.
    #[wasm_bindgen(getter)]
    pub fn masses(&self) -> Result<FrameMasses, Exception> {
        let masses = self.inner.masses(DENSITY).map_err(raise)?;
        Ok(by_frame(self.inner.skeleton.model(), &masses))
    }
}

#[cfg(feature = "gltf")]
#[wasm_bindgen]
impl Scene {
    /// Masses by bone: kilograms by the volume of all meshes at 1000 kg/m³, and the centre of mass in the bone's
    /// coordinates. Open parts of meshes do not count. The option `masses` of tasks takes them.
    #[wasm_bindgen(getter)]
    pub fn masses(&self) -> Result<FrameMasses, Exception> {
        let scene = &self.inner;
        let skeleton = scene
            .armature
            .turning_skeleton("scene", &scene.turning_bones());
        let skeleton = skeleton.map_err(raise)?;
        let masses = scene.masses(&skeleton, DENSITY).map_err(raise)?;
        Ok(by_frame(skeleton.model(), &masses))
    }
}

fn by_frame(model: &kinopt::Model, masses: &Masses) -> FrameMasses {
    let by_frame = object::of([]);
    for point in masses.points() {
        let [x, y, z] = point.at.to_array();
        let numbers = js_sys::Float64Array::from(&[point.mass, x, y, z][..]);
        let name = model.frames()[point.frame.index()].name.as_str();
        object::add(&by_frame, [(name, numbers.into())]);
    }
    by_frame.unchecked_into()
}
