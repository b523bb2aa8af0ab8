//! Cartesian paths of arms, with the fewest reconfigurations.

use js_sys::Array;
use kinopt::motion::path::{self, CartesianPath, TimingLimits};
use kinopt_bindings::names::miss_reason;
use kinopt_bindings::option::{self, names};
use wasm_bindgen::prelude::*;

use crate::arguments::NamedArguments;
use crate::arm::{Arm, Jumps, jumps};
use crate::placement::read_all;
use crate::value::Value;
use crate::{object, raise, solution, view};

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
export interface PathOptions {
    /** From first to last (the default), as a closed path, or as a closed path from the best entry. */
    traversal?: "open" | "cyclic" | "any-start";
    /** Configuration of the first point, or of the last; default: any. */
    start?: Numbers;
    end?: Numbers;
    /** Weight of a radian or metre of each joint in the path length. */
    jointWeights?: Numbers;
    /** Largest displacement of a joint between two points on the same branch, radians; default: 0.2. */
    maxStep?: number;
    /** Largest number of known configurations of a point; default: 256. */
    samples?: number;
    /** Time of each point, seconds. With `keepTimes` a step that is too fast for a joint is a reconfiguration too. */
    times?: Numbers;
    keepTimes?: boolean;
    /**
     * Further tools of the arm, sixteen numbers each, relative to the tip. `toolOfPoints` has the tool of each point: 0
     * is the arm's own tool, 1 the first of these.
     */
    tools?: Numbers;
    toolOfPoints?: Numbers;
}

/** A point of a path that the tool does not reach. */
export interface MissedPoint {
    index: number;
    /** Error beyond the goal bounds, metres and radians. */
    positionError: number;
    orientationError: number;
    reason: string;
}

/** A step of a path that is not proven collision-free. */
export interface BlockedStep extends Collision {
    index: number;
}
"#;

#[wasm_bindgen]
extern "C" {
    /// Options of a path.
    #[wasm_bindgen(typescript_type = "PathOptions")]
    pub type PathOptions;
    /// Missed points as objects.
    #[wasm_bindgen(typescript_type = "MissedPoint[]")]
    pub type MissedPoints;
    /// Blocked steps as objects.
    #[wasm_bindgen(typescript_type = "BlockedStep[]")]
    pub type BlockedSteps;
}

/// Solves a Cartesian path of the tool, sixteen numbers for each point in the arm's base, with the fewest
/// reconfigurations, then the shortest. A point that is not reached is no exception: see `missed`.
#[wasm_bindgen(js_name = solvePath)]
pub fn solve_path(
    arm: &Arm,
    #[wasm_bindgen(unchecked_param_type = "Numbers")] points: &[f64],
    options: Option<PathOptions>,
) -> Result<PathSolution, JsError> {
    let known = names(&option::path::options());
    let arguments = NamedArguments::of(options, "option of a path", known)?;
    let options = option::path::PathOptions {
        tool_of_points: arguments.wholes("toolOfPoints")?,
        ..option::path::PathOptions::of(&arguments)?
    };
    let path = CartesianPath::new(read_all(points, "point")?).map_err(raise)?;
    let path = options.path::<Value>(path)?;
    let others = arguments.numbers("tools")?.unwrap_or_default();
    let others = read_all(&others, "tool")?.into_iter();
    let others = others.map(|tool| arm.inner.with_tool(tool).map_err(raise));
    let others = others.collect::<Result<Vec<_>, _>>()?;
    let inner = options.solve(&arm.inner, &others, &path).map_err(raise)?;
    let rates = [arm.inner.velocity_limits(), arm.inner.acceleration_limits()];
    Ok(PathSolution {
        inner,
        joints: arm.inner.joints().map(str::to_owned).collect(),
        rates: rates.map(<[f64]>::to_vec),
    })
}

/// Joint path for a Cartesian path.
#[wasm_bindgen]
pub struct PathSolution {
    inner: path::PathSolution,
    joints: Vec<String>,
    rates: [Vec<f64>; 2],
}

#[wasm_bindgen]
impl PathSolution {
    /// One configuration for each point, one after another, as a view: valid until the next call into the module.
    #[wasm_bindgen(getter, unchecked_return_type = "Float64Array")]
    pub fn q(&self) -> js_sys::Float64Array {
        view::doubles(&self.inner.q)
    }

    /// Names of the joints, the columns of `q`.
    #[wasm_bindgen(getter, js_name = jointNames)]
    pub fn joint_names(&self) -> Vec<String> {
        self.joints.clone()
    }

    /// Index of the point of the first row: 0 except for traversal "any-start".
    #[wasm_bindgen(getter)]
    pub fn entry(&self) -> usize {
        self.inner.entry
    }

    /// Steps in which the arm leaves its branch.
    #[wasm_bindgen(getter)]
    pub fn jumps(&self) -> Jumps {
        jumps(&self.inner.jumps, &self.joints).unchecked_into()
    }

    /// Points that are not reached, in order.
    #[wasm_bindgen(getter)]
    pub fn missed(&self) -> MissedPoints {
        let missed = self.inner.missed.iter().map(|missed| {
            let reason = miss_reason(&missed.reason);
            object::of([
                ("index", missed.index.into()),
                ("positionError", missed.position_error.into()),
                ("orientationError", missed.orientation_error.into()),
                ("reason", reason.into()),
            ])
        });
        missed.collect::<Array>().unchecked_into()
    }

    /// Steps that are not proven collision-free, for an arm that avoids collisions.
    #[wasm_bindgen(getter)]
    pub fn blocked(&self) -> BlockedSteps {
        let blocked = self.inner.blocked.iter().map(|step| {
            let fields = object::of(solution::fields(&step.by));
            object::add(&fields, [("index", step.index.into())]);
            fields
        });
        blocked.collect::<Array>().unchecked_into()
    }

    /// True if all points are reached on one branch, and all steps are collision-free.
    #[wasm_bindgen(getter, js_name = isWhole)]
    pub fn is_whole(&self) -> bool {
        self.inner.is_whole()
    }

    /// Weighted joint length of all steps.
    #[wasm_bindgen(getter)]
    pub fn length(&self) -> f64 {
        self.inner.length
    }

    /// Upper bound of the tool's distance from the path between rows, metres.
    #[wasm_bindgen(getter, js_name = largestDeviation)]
    pub fn largest_deviation(&self) -> f64 {
        self.inner.largest_deviation.metres
    }

    /// Upper bound of the tool's rotation from the path between rows, radians.
    #[wasm_bindgen(getter, js_name = largestTurn)]
    pub fn largest_turn(&self) -> f64 {
        self.inner.largest_deviation.radians
    }

    /// Time of each row, seconds, starting at 0: time-optimal from rest to rest under acceleration and velocity limits.
    /// Limits have one number for each joint or one for all. Velocity limits default to those of the robot.
    pub fn times(
        &self,
        #[wasm_bindgen(unchecked_param_type = "Numbers | number")] accelerations: JsValue,
        #[wasm_bindgen(unchecked_optional_param_type = "Numbers | number")] velocities: JsValue,
    ) -> Result<Vec<f64>, JsError> {
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
        Ok(trajectory.times().to_vec())
    }
}
