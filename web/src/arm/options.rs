//! Options of an arm.

use kinopt::arm::Base;
use kinopt_bindings::option::arm::{OBJECTS, apply, options as options_of_arms};
use kinopt_bindings::option::names;
use wasm_bindgen::prelude::*;

use crate::arguments::NamedArguments;
use crate::error::{Exception, raise};
use crate::robot::Robot;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** Numbers of joints: one for all joints, one for each, or numbers by joint name. */
export type PerJoint = number | Numbers | Record<string, number>;

/** A configuration, or positions by joint name; joints without a position are at the default start. */
export type Configuration = Numbers | Record<string, number>;

/** Options of an arm. Lists have one number for each free joint, from base to tip. */
export interface ArmOptions {
    /** Largest number of attempts of a query; default 200. */
    attempts?: number;
    /** Builds the seed atlas: fewer iterations, for some megabytes and milliseconds at construction. Default: true. */
    atlas?: boolean;
    /** Returns the closest pose on any branch if the target is missed. Default: false, the branch of the start. */
    globalSearchOnMiss?: boolean;
    /** Goal bounds: "pose" (the default), "position", or half widths along and about the axes, metres and radians. */
    goal?: "pose" | "position" | Numbers;
    /** Configuration of the robot for the joints that `only` omits. Default: the neutral configuration. */
    held?: Numbers;
    /** Number of iterations after which no attempt begins. Default: 2 600, or none if `attempts` is given. */
    iterations?: number;
    /** Narrower position limits, radians or metres. Default: those of the robot. */
    jointLimits?: Record<string, readonly [number, number]>;
    /** Positive weights of the joints in joint distances. Default: 1 each. */
    jointWeights?: PerJoint;
    /** Strength of joint limit avoidance of `track`, `follower` and `servo`, radians. Default: 4. */
    limitAvoidance?: number;
    /** Locked joints with their values, radians or metres. */
    locked?: Record<string, number>;
    /** Largest displacement of each joint from the start, radians or metres. Default: unbounded. */
    maxMove?: PerJoint;
    /** Length that weighs as much as a radian in a missed pose, metres. Default: a quarter of the arm's reach. */
    metresPerRadian?: number;
    /** Free joints; all others are locked at their values in `held`. */
    only?: readonly string[];
    /** Largest angle between the tool and its target, radians. Default: 1e-6. */
    orientationTolerance?: number;
    /** Largest distance of the tool from its target, metres. Default: 1e-6. */
    positionTolerance?: number;
    /** Nominal posture for the null space, radians or metres. Default: none. */
    posture?: PerJoint;
    /**
     * Selection among several solutions: one on the branch of the start (the default), the first one found, or the
     * nearest to the start.
     */
    search?: "start" | "first" | "nearest";
    /** Seed of the random generator. Default: 0. */
    seed?: number;
    /** Time limit of a query, seconds. Results then depend on the machine. Default: none. */
    timeLimit?: number;
    /** Placement on the tip that is brought to the target. Default: the tip. */
    tool?: Placement;
}
"#;

#[wasm_bindgen]
extern "C" {
    /// Options of an arm.
    #[wasm_bindgen(typescript_type = "ArmOptions")]
    pub type ArmOptions;
}

/// Builds an arm with the given options.
pub(super) fn build(
    robot: &Robot,
    base: Option<String>,
    tip: &str,
    options: Option<ArmOptions>,
) -> Result<kinopt::Arm, Exception> {
    let from = match &base {
        Some(base) => Base::from(base),
        None => Base::World,
    };
    let builder = kinopt::Arm::builder(&*robot.inner, from, tip);
    let known = names(&options_of_arms())
        .into_iter()
        .filter(|name| !OBJECTS.contains(name));
    let options = NamedArguments::of(options, "option of an arm", known)?;
    apply(builder, &options, robot.inner.model())?
        .build()
        .map_err(raise)
}
