//! Solutions of several targets.

use js_sys::Array;
use kinopt::arm::{JointJump, PoseOutcome};
use wasm_bindgen::prelude::*;

use crate::object;
use crate::view;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/**
 * A step of a path in which a joint moves farther than 0.2 rad, or a prismatic joint farther than the equivalent
 * length. `solvePath` lists reconfigurations only.
 */
export interface JointJump {
    /** Index of the row after the step; 0 for the step that closes a cyclic path. */
    index: number;
    joint: string;
    /** Radians; of a prismatic joint the equivalent angle. */
    distance: number;
    /** True if the arm leaves its branch. False for a fast motion or a coarse path: small steps lead there too. */
    reconfiguration: boolean;
}
"#;

#[wasm_bindgen]
extern "C" {
    /// Jumps as objects.
    #[wasm_bindgen(typescript_type = "JointJump[]")]
    pub type Jumps;
}

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

/// Solutions along a path.
#[wasm_bindgen]
pub struct Track {
    q: Vec<f64>,
    reached: Vec<u8>,
    jumps: Array,
}

impl Track {
    pub(super) fn new(arm: &kinopt::Arm, track: kinopt::arm::Track) -> Self {
        let names: Vec<&str> = arm.joints().collect();
        Self {
            jumps: jumps(&track.jumps, &names),
            q: track
                .solutions
                .iter()
                .flat_map(|solution| &solution.q)
                .copied()
                .collect(),
            reached: track
                .solutions
                .iter()
                .map(|solution| solution.reached.into())
                .collect(),
        }
    }
}

#[wasm_bindgen]
impl Track {
    /// Configurations, one after another, as a view: valid until the next call into the module.
    #[wasm_bindgen(getter, unchecked_return_type = "Float64Array")]
    pub fn q(&self) -> js_sys::Float64Array {
        view::doubles(&self.q)
    }

    /// 1 for each target that is reached, 0 for others.
    #[wasm_bindgen(getter)]
    pub fn reached(&self) -> Vec<u8> {
        self.reached.clone()
    }

    /// Steps in which a joint moves farther than 0.2 rad.
    #[wasm_bindgen(getter)]
    pub fn jumps(&self) -> Jumps {
        self.jumps.clone().unchecked_into()
    }
}

/// Jumps as objects, with the names of their joints.
pub(crate) fn jumps<S: AsRef<str>>(jumps: &[JointJump], joints: &[S]) -> Array {
    let jumps = jumps.iter().map(|jump| {
        let joint = joints.get(jump.joint).map_or("", AsRef::as_ref);
        object::of([
            ("index", jump.index.into()),
            ("joint", joint.into()),
            ("distance", jump.distance.into()),
            ("reconfiguration", jump.reconfiguration.into()),
        ])
    });
    jumps.collect()
}
