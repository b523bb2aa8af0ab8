//! Solutions of a batch of targets.

use kinopt::arm::PoseOutcome;
use wasm_bindgen::prelude::*;

use crate::view;

/// Solutions of a batch of targets, in their order.
#[wasm_bindgen]
pub struct Batch {
    pub(super) q: Vec<f64>,
    pub(super) outcomes: Vec<PoseOutcome>,
}

impl Batch {
    pub(super) fn with_room(targets: usize, joints: usize) -> Self {
        Self {
            q: vec![0.0; targets * joints],
            outcomes: vec![PoseOutcome::default(); targets],
        }
    }
}

#[wasm_bindgen]
impl Batch {
    /// Configurations, one after another, as a view: valid until the next call into the module.
    #[wasm_bindgen(getter, unchecked_return_type = "Float64Array")]
    pub fn q(&self) -> js_sys::Float64Array {
        view::doubles(&self.q)
    }

    /// 1 for each target that is reached, 0 for others.
    #[wasm_bindgen(getter)]
    pub fn reached(&self) -> Vec<u8> {
        self.each(|outcome| outcome.reached.into())
    }

    /// Distance of each tool from its target, metres.
    #[wasm_bindgen(getter, js_name = positionError)]
    pub fn position_error(&self) -> Vec<f64> {
        self.each(|outcome| outcome.position_error)
    }

    /// Angle between each tool and its target, radians.
    #[wasm_bindgen(getter, js_name = orientationError)]
    pub fn orientation_error(&self) -> Vec<f64> {
        self.each(|outcome| outcome.orientation_error)
    }
}

impl Batch {
    fn each<T>(&self, what: impl Fn(&PoseOutcome) -> T) -> Vec<T> {
        self.outcomes.iter().map(what).collect()
    }
}
