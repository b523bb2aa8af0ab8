//! Options of an arm.

use kinopt::arm::{ArmBuilder, Base, PoseBounds, Search};
use kinopt::model::UnknownName;
use wasm_bindgen::prelude::*;

use crate::arguments::NamedArguments;
use crate::clock;
use crate::raise;
use crate::robot::Robot;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
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
    /** Positive weights of the joints in joint distances. Default: 1 each. */
    jointWeights?: Numbers;
    /** Strength of joint limit avoidance of `track`, `follower` and `servo`, radians. Default: 4. */
    limitAvoidance?: number;
    /** Locked joints with their values, radians or metres. */
    locked?: Record<string, number>;
    /** Largest displacement of each joint from the start, radians or metres. Default: unbounded. */
    maxMove?: Numbers;
    /** Length that weighs as much as a radian in a missed pose, metres. Default: a quarter of the arm's reach. */
    metresPerRadian?: number;
    /** Free joints; all others are locked at their values in `held`. */
    only?: readonly string[];
    /** Largest angle between the tool and its target, radians. Default: 1e-6. */
    orientationTolerance?: number;
    /** Largest distance of the tool from its target, metres. Default: 1e-6. */
    positionTolerance?: number;
    /** Nominal posture for the null space, radians or metres. Default: none. */
    posture?: Numbers;
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

const KNOWN: [&str; 19] = [
    "attempts",
    "atlas",
    "globalSearchOnMiss",
    "goal",
    "held",
    "iterations",
    "jointWeights",
    "limitAvoidance",
    "locked",
    "maxMove",
    "metresPerRadian",
    "only",
    "orientationTolerance",
    "positionTolerance",
    "posture",
    "search",
    "seed",
    "timeLimit",
    "tool",
];

/// Builds an arm with the given options.
pub(super) fn build(
    robot: &Robot,
    base: Option<String>,
    tip: &str,
    options: Option<ArmOptions>,
) -> Result<kinopt::Arm, JsError> {
    let from = match &base {
        Some(base) => Base::from(base),
        None => Base::World,
    };
    let neutral = robot.inner.model().neutral();
    let builder = kinopt::Arm::builder(&*robot.inner, from, tip);
    let builder = apply(builder, options, neutral)?;
    builder.build().map_err(raise)
}

/// Applies the options to the builder; `neutral` is the default configuration of locked joints.
fn apply<'m>(
    mut builder: ArmBuilder<'m>,
    options: Option<ArmOptions>,
    neutral: Vec<f64>,
) -> Result<ArmBuilder<'m>, JsError> {
    let options = options.map_or(JsValue::UNDEFINED, JsValue::from);
    let options = NamedArguments::new(options, "option of an arm", &KNOWN)?;
    macro_rules! set {
        ($($read:ident $name:literal $with:ident $(& $by_reference:tt)?;)*) => {$(
            if let Some(value) = options.$read($name)? {
                builder = builder.$with(set!(@ value $($by_reference)?));
            }
        )*};
        (@ $value:ident) => { $value };
        (@ $value:ident slice) => { &$value };
    }
    set! {
        whole "attempts" with_attempts;
        switch "atlas" with_atlas;
        switch "globalSearchOnMiss" with_global_search_on_miss;
        whole "iterations" with_iterations;
        numbers "jointWeights" with_joint_weights &slice;
        number "limitAvoidance" with_limit_avoidance;
        numbers "maxMove" with_max_move &slice;
        number "metresPerRadian" with_metres_per_radian;
        number "orientationTolerance" with_orientation_tolerance;
        number "positionTolerance" with_position_tolerance;
        numbers "posture" with_posture &slice;
        placement "tool" with_tool;
    }
    if let Some(seed) = options.whole("seed")? {
        builder = builder.with_seed(seed.into());
    }
    if let Some(limit) = clock::time_limit(&options)? {
        builder = builder.with_time_limit(limit);
    }
    if let Some(name) = options.text("search")? {
        builder = builder.with_search(search(&name)?);
    }
    if let Some(value) = options.get("goal") {
        builder = builder.with_goal(goal(&value)?);
    }
    for (joint, value) in options.by_name("locked")? {
        builder = builder.with_locked(&joint, value);
    }
    if let Some(joints) = options.texts("only")? {
        builder = builder.with_only(&joints, &options.numbers("held")?.unwrap_or(neutral));
    }
    Ok(builder)
}

fn search(name: &str) -> Result<Search, JsError> {
    let names = ["start", "first", "nearest"];
    match name {
        "start" => Ok(Search::Start),
        "first" => Ok(Search::First),
        "nearest" => Ok(Search::Nearest),
        _ => Err(raise(UnknownName::new("search", name, names))),
    }
}

/// Reads "pose", "position", or half widths along and about the axes.
pub(crate) fn goal(value: &JsValue) -> Result<PoseBounds, JsError> {
    match value.as_string().as_deref() {
        Some("pose") => Ok(PoseBounds::pose()),
        Some("position") => Ok(PoseBounds::position()),
        Some(other) => {
            let names = ["pose", "position"];
            Err(raise(UnknownName::new("goal", other, names)))
        }
        None => {
            let widths = crate::arguments::vector::<6>(value, "goal")?;
            match widths.iter().find(|width| width.is_nan() || **width < 0.0) {
                None => Ok(PoseBounds::within(widths)),
                Some(width) => Err(JsError::new(&format!(
                    "goal contains {width}, expected numbers of at least 0"
                ))),
            }
        }
    }
}
