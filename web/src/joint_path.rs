//! Joint paths of arms, and their times.

use js_sys::Array;
use kinopt::arm::JointJump;
use kinopt::motion::path::TimingLimits;
use wasm_bindgen::prelude::*;

use crate::error::{Exception, raise};
use crate::{object, view};

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** A step of a path in which a joint moves farther than its bound. */
export interface JointJump {
    /** Index of the row after the step; 0 for the step that closes a cyclic path. */
    index: number;
    joint: string;
    /** Radians; of a prismatic joint the equivalent angle. */
    distance: number;
    /** True if the arm leaves its branch. False for a fast motion or a coarse path: small steps lead there too. */
    reconfiguration: boolean;
}

/** Results of the rows of a tracked path. */
export interface TrackReport {
    /** 1 for each target that is reached, 0 for others. */
    reached: Uint8Array;
}
"#;

#[wasm_bindgen]
extern "C" {
    /// Jumps as objects.
    #[wasm_bindgen(typescript_type = "JointJump[]")]
    pub type JointJumps;
}

/// Joint path of an arm: one configuration a row, with its jumps and a report.
#[wasm_bindgen]
pub struct JointPath {
    inner: kinopt::arm::JointPath<()>,
    joints: Vec<String>,
    rates: [Vec<f64>; 2],
    reached: bool,
    report: JsValue,
}

impl JointPath {
    /// Path of an arm with a report as an object.
    pub(crate) fn new(
        arm: &kinopt::Arm,
        inner: kinopt::arm::JointPath<()>,
        reached: bool,
        report: JsValue,
    ) -> Self {
        let rates = [arm.velocity_limits(), arm.acceleration_limits()];
        Self {
            inner,
            joints: arm.joints().map(str::to_owned).collect(),
            rates: rates.map(<[f64]>::to_vec),
            reached,
            report,
        }
    }
}

#[wasm_bindgen]
impl JointPath {
    /// Configurations, one after another, as a view: valid until the next call into the module.
    #[wasm_bindgen(getter, unchecked_return_type = "Float64Array")]
    pub fn q(&self) -> js_sys::Float64Array {
        view::doubles(&self.inner.q)
    }

    /// Names of the joints, the columns of `q`.
    #[wasm_bindgen(getter, js_name = jointNames)]
    pub fn joint_names(&self) -> Vec<String> {
        self.joints.clone()
    }

    /// Steps in which a joint moves farther than its bound, in order. `solvePath` lists reconfigurations only.
    #[wasm_bindgen(getter)]
    pub fn jumps(&self) -> JointJumps {
        let object = |jump: &JointJump| {
            object::of([
                ("index", jump.index.into()),
                ("joint", self.joints[jump.joint].as_str().into()),
                ("distance", jump.distance.into()),
                ("reconfiguration", jump.reconfiguration.into()),
            ])
        };
        let jumps = self.inner.jumps.iter().map(object);
        jumps.collect::<Array>().unchecked_into()
    }

    /// True if all rows are reached without jumps, and all steps are collision-free.
    #[wasm_bindgen(getter)]
    pub fn reached(&self) -> bool {
        self.reached
    }

    /// Errors of the path: of `track` one solution a row.
    #[wasm_bindgen(getter, unchecked_return_type = "PathReport | TrackReport")]
    pub fn report(&self) -> JsValue {
        self.report.clone()
    }

    /// Time of each row, seconds, starting at 0: time-optimal from rest to rest under acceleration and velocity limits.
    /// Limits have one number for each joint or one for all. Velocity limits default to those of the robot.
    pub fn times(
        &self,
        #[wasm_bindgen(unchecked_param_type = "Numbers | number")] accelerations: JsValue,
        #[wasm_bindgen(unchecked_optional_param_type = "Numbers | number")] velocities: JsValue,
    ) -> Result<Vec<f64>, Exception> {
        let limits = |value: &JsValue, what: &str, defaults: &[f64]| match value.as_f64() {
            Some(number) => Ok(vec![number; self.joints.len()]),
            None if value.is_undefined() => Ok(defaults.to_vec()),
            None => crate::arguments::numbers(value, what),
        };
        let [default_velocities, default_accelerations] = &self.rates;
        let velocities = limits(&velocities, "velocities", default_velocities)?;
        let accelerations = limits(&accelerations, "accelerations", default_accelerations)?;
        let limits = TimingLimits::new(&velocities, &accelerations).with_joint_names(&self.joints);
        let trajectory = self.inner.trajectory(&limits).map_err(raise)?;
        Ok(trajectory.times)
    }
}
