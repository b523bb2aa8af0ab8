//! Models: a tree of joints with limits.

use std::rc::Rc;

use kinopt::model::Limits;
use kinopt::robot::Robot;
use kinopt_bindings::coordinates;
use wasm_bindgen::prelude::*;

/// Tree of joints with limits; problems use it.
#[wasm_bindgen]
#[derive(Clone)]
pub struct Model {
    pub(crate) inner: kinopt::Model,
    /// Robot of the model, if any, for its mimic joints.
    pub(crate) robot: Option<Rc<Robot>>,
    /// Rig of the model, if any.
    #[cfg(feature = "bodies")]
    pub(crate) rig: Option<Rc<kinopt::io::rig::Rig>>,
}

impl From<kinopt::Model> for Model {
    fn from(inner: kinopt::Model) -> Self {
        Self {
            inner,
            robot: None,
            #[cfg(feature = "bodies")]
            rig: None,
        }
    }
}

#[wasm_bindgen]
impl Model {
    /// Name of the model.
    #[wasm_bindgen(getter)]
    pub fn name(&self) -> String {
        self.inner.name().to_owned()
    }

    /// Names of the joints, parents before children. Fixed joints are included, although a configuration has no numbers
    /// for them: use `Arm.jointNames` to label the numbers of an arm.
    #[wasm_bindgen(getter, js_name = jointNames)]
    pub fn joint_names(&self) -> Vec<String> {
        let joints = self.inner.joints().iter();
        joints.map(|joint| joint.name.clone()).collect()
    }

    /// Names of the frames, which tasks and arms use.
    #[wasm_bindgen(getter, js_name = frameNames)]
    pub fn frame_names(&self) -> Vec<String> {
        let frames = self.inner.frames().iter();
        frames.map(|frame| frame.name.clone()).collect()
    }

    /// Names of the numbers of a configuration: of the joints, with the component for a ball's quaternion, as in
    /// "hip w".
    #[wasm_bindgen(getter, js_name = coordinateNames)]
    pub fn coordinate_names(&self) -> Vec<String> {
        coordinates::names(&self.inner)
    }

    /// Units of the numbers of a configuration: "rad" or "m", "units" for an unknown unit of length, "" for the
    /// component of a quaternion.
    #[wasm_bindgen(getter, js_name = coordinateUnits)]
    pub fn coordinate_units(&self) -> Vec<String> {
        let joints = self.inner.moving_joints().iter();
        let units = joints.map(|&id| coordinates::unit(&self.inner, id));
        units.map(str::to_owned).collect()
    }

    /// Number of values in a configuration: one for each revolute or prismatic joint, four for a ball joint, none for a
    /// fixed joint.
    #[wasm_bindgen(getter, js_name = configurationLen)]
    pub fn configuration_len(&self) -> usize {
        self.inner.configuration_len()
    }

    /// Lower position limits, one number for each number of a configuration, radians and metres.
    #[wasm_bindgen(getter)]
    pub fn lower(&self) -> Vec<f64> {
        self.limits(|limits| limits.lower)
    }

    /// Upper position limits, one number for each number of a configuration, radians and metres.
    #[wasm_bindgen(getter)]
    pub fn upper(&self) -> Vec<f64> {
        self.limits(|limits| limits.upper)
    }

    /// Longest chain from the root to a frame, in the model's unit of length.
    #[wasm_bindgen(getter)]
    pub fn reach(&self) -> f64 {
        self.inner.reach()
    }

    /// Configuration with all joints at 0, or at the nearest limit; mimic joints follow their source joints.
    pub fn neutral(&self) -> Vec<f64> {
        match &self.robot {
            Some(robot) => robot.neutral(),
            None => self.inner.neutral(),
        }
    }

    /// A configuration sampled uniformly within the limits; mimic joints follow their source joints. Equal seeds give
    /// equal configurations.
    #[wasm_bindgen(js_name = randomConfiguration)]
    pub fn random_configuration(&self, seed: u32) -> Vec<f64> {
        match &self.robot {
            Some(robot) => robot.random_configuration(seed.into()),
            None => self.inner.random_configuration(seed.into()),
        }
    }
}

impl Model {
    fn limits(&self, side: impl Fn(Limits) -> f64) -> Vec<f64> {
        self.inner.limits().map(side).collect()
    }
}
