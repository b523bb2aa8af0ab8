//! Options of an arm.

use kinopt::Model;
use kinopt::arm::ArmBuilder;
use kinopt::model::Limits;

use super::{Joints, OptionSpec, Setter};
use crate::names::{SEARCHES, named};
use crate::per_joint::configuration_of;
use crate::value::{Arguments, ErrorOf, OrRaise, Value};

/// Options that are objects of the interface, or belong to one.
pub const OBJECTS: [&str; 4] = ["collision_model", "margin", "srdf", "world"];

/// Options of an arm, by name.
///
/// Those with [`Setter::Elsewhere`] are objects of the interface, except `only` and `held`: see [`apply`].
#[must_use]
pub fn options<'m>() -> [OptionSpec<ArmBuilder<'m>>; 24] {
    [
        OptionSpec {
            name: "goal",
            set: Setter::PoseBounds(ArmBuilder::with_goal),
            doc: "goal bounds, a `PoseBounds`, \"pose\" or \"position\".",
            default: "the full pose",
        },
        OptionSpec {
            name: "tool",
            set: Setter::Placement(|arm, tool| arm.with_tool(tool)),
            doc: "placement of the tool relative to the tip, 4 x 4, metres.",
            default: "the tip itself",
        },
        OptionSpec {
            name: "joint_limits",
            set: Setter::Ranges(|arm, limits| {
                let narrow =
                    |arm: ArmBuilder<'m>, (joint, (lower, upper)): (String, (f64, f64))| {
                        arm.with_joint_limits(&joint, Limits::new(lower, upper))
                    };
                limits.into_iter().fold(arm, narrow)
            }),
            doc: "narrower position limits, {joint: (lower, upper)}, radians or metres, within those of the robot.",
            default: "those of the robot",
        },
        OptionSpec {
            name: "world",
            set: Setter::Elsewhere,
            doc: "a `World` to avoid collisions with, copied at this moment; the arm then also avoids collisions with \
                  its own robot. A solution is then reached only if it is collision-free by the exact distances of \
                  the robot's collision shapes (`solution.collisions`). Paths are collision-free between their points \
                  too. `with_world` replaces it.",
            default: "no obstacles",
        },
        OptionSpec {
            name: "margin",
            set: Setter::Elsewhere,
            doc: "smallest distance of all pairs, metres, at least 0; without a `world`, of the links of the robot.",
            default: "0",
        },
        OptionSpec {
            name: "collision_model",
            set: Setter::Elsewhere,
            doc: "a `CollisionModel` of the robot, with the shapes and pairs for `world` and `margin`.",
            default: "that of `robot`, without the pairs that are never, or in a thousand random configurations \
                      always, in contact",
        },
        OptionSpec {
            name: "posture",
            set: Setter::PerJoint(|arm, posture| arm.with_posture(&posture), None),
            doc: "nominal posture of a redundant arm, shape (dof,) or {joint: position}, radians or metres.",
            default: "none",
        },
        OptionSpec {
            name: "position_tolerance",
            set: Setter::Number(ArmBuilder::with_position_tolerance),
            doc: "largest distance of the tool from its target, metres.",
            default: "1e-6",
        },
        OptionSpec {
            name: "orientation_tolerance",
            set: Setter::Number(ArmBuilder::with_orientation_tolerance),
            doc: "largest angle between the tool and its target, radians.",
            default: "1e-6",
        },
        OptionSpec {
            name: "search",
            set: Setter::Named(|arm, name| Ok(arm.with_search(named("search", name, &SEARCHES)?))),
            doc: "\"start\" (the solution of the attempt from the start; other attempts only if that fails), \
                  \"first\" (the fastest) or \"nearest\" (the nearest to the start).",
            default: "\"start\"",
        },
        OptionSpec {
            name: "max_move",
            set: Setter::PerJoint(
                |arm, max_move| arm.with_max_move(&max_move),
                Some(f64::INFINITY),
            ),
            doc: "largest displacement of each joint from its start, radians or metres, a hard bound: shape (dof,), a \
                  number, or {joint: displacement}.",
            default: "inf",
        },
        OptionSpec {
            name: "joint_weights",
            set: Setter::PerJoint(|arm, weights| arm.with_joint_weights(&weights), Some(1.0)),
            doc: "weight of a radian or metre of each joint in joint distances, above 0: shape (dof,), a number, or \
                  {joint: weight}.",
            default: "1 each",
        },
        OptionSpec {
            name: "locked",
            set: Setter::ByJoint(|arm, locked| {
                let lock = |arm: ArmBuilder<'m>, (joint, value): (String, f64)| {
                    arm.with_locked(&joint, value)
                };
                locked.into_iter().fold(arm, lock)
            }),
            doc: "{joint: value}, radians or metres; up to 1e-3 outside the limits is clamped, as in `held`.",
            default: "none",
        },
        OptionSpec {
            name: "only",
            set: Setter::Elsewhere,
            doc: "names of the free joints; all others are locked at `held`.",
            default: "all between base and tip",
        },
        OptionSpec {
            name: "held",
            set: Setter::Elsewhere,
            doc: "configuration of the model for the joints that `only` omits, shape (model's dof,), clamped into the \
                  limits.",
            default: "the neutral configuration",
        },
        OptionSpec {
            name: "srdf",
            set: Setter::Elsewhere,
            doc: "an `Srdf` of the robot, whose state \"ready\" or \"home\" is `default_start`.",
            default: "none",
        },
        OptionSpec {
            name: "attempts",
            set: Setter::Whole(|arm, attempts| arm.with_attempts(attempts)),
            doc: "largest number of attempts for a query, at least 1; with `world` or `margin` up to twice as many.",
            default: "200",
        },
        OptionSpec {
            name: "iterations",
            set: Setter::Whole(|arm, iterations| arm.with_iterations(iterations)),
            doc: "no attempt begins once all attempts together have used this many, at least 1.",
            default: "2600, or none if `attempts` is given",
        },
        OptionSpec {
            name: "time_limit",
            set: Setter::TimeLimit(|arm, limit| arm.with_time_limit(limit)),
            doc: "seconds for a query; with a time limit, results may differ from run to run.",
            default: "none",
        },
        OptionSpec {
            name: "seed",
            set: Setter::LongWhole(ArmBuilder::with_seed),
            doc: "seed of the attempts after the first.",
            default: "0",
        },
        OptionSpec {
            name: "global_search_on_miss",
            set: Setter::Switch(ArmBuilder::with_global_search_on_miss),
            doc: "on a miss, return the best of all attempts on any branch.",
            default: "False, the closest pose on the branch of the start",
        },
        OptionSpec {
            name: "limit_avoidance",
            set: Setter::Number(ArmBuilder::with_limit_avoidance),
            doc: "strength of joint limit avoidance on paths, radians, at least 0.",
            default: "4",
        },
        OptionSpec {
            name: "metres_per_radian",
            set: Setter::Number(|arm, metres| arm.with_metres_per_radian(metres)),
            doc: "distance that weighs as much as a radian, metres.",
            default: "a quarter of the arm's reach",
        },
        OptionSpec {
            name: "atlas",
            set: Setter::Switch(ArmBuilder::with_atlas),
            doc: "start attempts from a precomputed table of seeds (35 ms to compute, once).",
            default: "True",
        },
    ]
}

/// Reads a configuration of `model` for locked joints: a list, or positions by joint name.
fn read_held<V: Value>(value: &V, model: &Model) -> Result<Vec<f64>, V::Error> {
    let what = V::label("held");
    if value.is_map() {
        return configuration_of(value, &what, model, model.neutral());
    }
    value.vector(&what, model.configuration_len())
}

/// Applies all given options to the builder of an arm of `model`; objects of the interface are applied by the caller.
///
/// # Errors
/// If an option has another type, or names an unknown value.
pub fn apply<'m, A: Arguments>(
    builder: ArmBuilder<'m>,
    arguments: &A,
    model: &Model,
) -> Result<ArmBuilder<'m>, ErrorOf<A>> {
    let mut builder = super::apply(arguments, &options(), builder)?;
    // Read without `only` too: an invalid value is an error.
    let held = arguments.get("held")?;
    let held = held.map(|held| read_held(&held, model)).transpose()?;
    if let Some(only) = arguments.get("only")? {
        let joints = only.names("only")?;
        builder = builder.with_only(&joints, &held.unwrap_or_else(|| model.neutral()));
    }
    let mut is_given = false;
    for option in &options() {
        let is_per_joint = matches!(option.set, Setter::PerJoint(..));
        is_given |= is_per_joint && arguments.get(option.name)?.is_some();
    }
    if !is_given {
        return Ok(builder);
    }
    let joints = builder.joints().or_raise::<A::Value>()?.into_iter();
    let names: Vec<String> = joints
        .map(|joint| model.joints()[joint.index()].name.clone())
        .collect();
    let joints = Joints {
        names: &names,
        start: &[],
    };
    joints.apply(arguments, &options(), builder)
}
