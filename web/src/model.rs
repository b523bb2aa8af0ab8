//! Models: joints in a tree, with limits.

use std::rc::Rc;

use kinopt::model::Limits;
use kinopt::robot::Robot;
use wasm_bindgen::prelude::*;

/// Joints in a tree, with limits: what problems are stated on.
#[wasm_bindgen]
#[derive(Clone)]
pub struct Model {
    pub(crate) inner: kinopt::Model,
    /// What it is the model of, if that is a robot: its followers follow.
    pub(crate) robot: Option<Rc<Robot>>,
    /// Or a rig.
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
    /// Its name.
    #[wasm_bindgen(getter)]
    pub fn name(&self) -> String {
        self.inner.name().to_owned()
    }

    /// The joints, parents before children.
    #[wasm_bindgen(getter, js_name = jointNames)]
    pub fn joint_names(&self) -> Vec<String> {
        let joints = self.inner.joints().iter();
        joints.map(|joint| joint.name.clone()).collect()
    }

    /// The frames, which tasks speak of.
    #[wasm_bindgen(getter, js_name = frameNames)]
    pub fn frame_names(&self) -> Vec<String> {
        let frames = self.inner.frames().iter();
        frames.map(|frame| frame.name.clone()).collect()
    }

    /// How many numbers a configuration has.
    #[wasm_bindgen(getter, js_name = configurationLen)]
    pub fn configuration_len(&self) -> usize {
        self.inner.configuration_len()
    }

    /// Lower limits, radians and metres.
    #[wasm_bindgen(getter)]
    pub fn lower(&self) -> Vec<f64> {
        self.limits(|limits| limits.lower)
    }

    /// Upper limits, radians and metres.
    #[wasm_bindgen(getter)]
    pub fn upper(&self) -> Vec<f64> {
        self.limits(|limits| limits.upper)
    }

    /// The longest way from the root to a frame, in the model's unit of length.
    #[wasm_bindgen(getter)]
    pub fn reach(&self) -> f64 {
        self.inner.reach()
    }

    /// All joints at 0, or at the limit next to it; mimic joints at the values that their source joints give them.
    pub fn neutral(&self) -> Vec<f64> {
        match &self.robot {
            Some(robot) => robot.neutral(),
            None => self.inner.neutral(),
        }
    }

    /// A configuration sampled uniformly within the limits, with mimic joints at the values that their source joints give them. Equal
    /// seeds give equal configurations.
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
