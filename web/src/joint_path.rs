//! Joint paths of arms, and their times.

use js_sys::Array;
use kinopt::arm::JointJump;
use kinopt::motion::path::TimingLimits;
use kinopt_bindings::per_joint::per_joint;
use wasm_bindgen::prelude::*;

use crate::arguments::NamedArguments;
use crate::error::{Exception, raise};
use crate::value::Value;
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

/** Joint limits of times: one number for all joints, one for each, or numbers by joint name. */
export interface TimingOptions {
    /** rad/s² or m/s². Default: those of the robot. */
    accelerationLimits?: PerJoint;
    /** rad/s or m/s. Default: those of the robot. */
    velocityLimits?: PerJoint;
    /** Times a path with `unreached` rows too, which is an exception by default. */
    allowUnreached?: boolean;
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
    /// Options of times.
    #[wasm_bindgen(typescript_type = "TimingOptions")]
    pub type TimingOptions;
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

    /// Rows that are not reached, or whose step is not proven collision-free, in order. The report has the reasons.
    #[wasm_bindgen(getter)]
    pub fn unreached(&self) -> Vec<usize> {
        self.inner.unreached.clone()
    }

    /// Time of each row, seconds, starting at 0: time-optimal from rest to rest under acceleration and velocity limits.
    pub fn times(&self, options: Option<TimingOptions>) -> Result<Vec<f64>, Exception> {
        let known = ["acceleration_limits", "velocity_limits", "allow_unreached"];
        let options = NamedArguments::of(options, "option of times", known)?;
        let limits = |name: &str, defaults: &[f64]| match options.get(name) {
            Some(limits) => per_joint(&Value(limits), name, &self.joints, None),
            None => Ok(defaults.to_vec()),
        };
        let [velocities, accelerations] = &self.rates;
        let velocities = limits("velocityLimits", velocities)?;
        let accelerations = limits("accelerationLimits", accelerations)?;
        let limits = TimingLimits::new(&velocities, &accelerations)
            .with_joint_names(&self.joints)
            .with_unreached_allowed(options.switch("allowUnreached")?.unwrap_or(false));
        let trajectory = self.inner.trajectory(&limits).map_err(raise)?;
        Ok(trajectory.times)
    }
}
