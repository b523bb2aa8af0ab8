//! Options of an arm.

use kinopt::arm::ArmBuilder;

use super::{OptionSpec, Setter};
use crate::names::{SEARCHES, named};
use crate::value::{Arguments, ErrorOf, Value};

/// Options that are objects of the interface, or belong to one.
pub const OBJECTS: [&str; 4] = ["collision_model", "margin", "srdf", "world"];

/// Options of an arm, by name.
///
/// Those with [`Setter::Elsewhere`] are objects of the interface, except `only` and `held`: see [`apply`].
#[must_use]
pub fn options<'m>() -> [OptionSpec<ArmBuilder<'m>>; 23] {
    [
        OptionSpec {
            name: "attempts",
            set: Setter::Whole(|arm, attempts| arm.with_attempts(attempts)),
            doc: "largest number of attempts for a query, at least 1; with `world` or `margin` up to twice as many.",
            default: "200",
        },
        OptionSpec {
            name: "atlas",
            set: Setter::Switch(ArmBuilder::with_atlas),
            doc: "start attempts from a precomputed table of seeds (35 ms to compute, once).",
            default: "True",
        },
        OptionSpec {
            name: "collision_model",
            set: Setter::Elsewhere,
            doc: "a `CollisionModel` of the robot, with the shapes and pairs for `world` and `margin`.",
            default: "that of `robot`, without the pairs that are never, or in a thousand random configurations \
                      always, in contact",
        },
        OptionSpec {
            name: "global_search_on_miss",
            set: Setter::Switch(ArmBuilder::with_global_search_on_miss),
            doc: "on a miss, return the best of all attempts on any branch.",
            default: "False, the closest pose on the branch of the start",
        },
        OptionSpec {
            name: "goal",
            set: Setter::PoseBounds(ArmBuilder::with_goal),
            doc: "goal bounds, a `PoseBounds`.",
            default: "the full pose",
        },
        OptionSpec {
            name: "held",
            set: Setter::Elsewhere,
            doc: "configuration of the model for the joints that `only` omits, shape (model's dof,), clamped into the \
                  limits.",
            default: "the neutral configuration",
        },
        OptionSpec {
            name: "iterations",
            set: Setter::Whole(|arm, iterations| arm.with_iterations(iterations)),
            doc: "no attempt begins once all attempts together have used this many, at least 1.",
            default: "2600, or none if `attempts` is given",
        },
        OptionSpec {
            name: "joint_weights",
            set: Setter::Numbers(|arm, weights| arm.with_joint_weights(&weights)),
            doc: "weight of a radian or metre of each joint in joint distances, shape (dof,), above 0.",
            default: "1 each",
        },
        OptionSpec {
            name: "limit_avoidance",
            set: Setter::Number(ArmBuilder::with_limit_avoidance),
            doc: "strength of joint limit avoidance on paths, radians, at least 0.",
            default: "4",
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
            name: "margin",
            set: Setter::Elsewhere,
            doc: "smallest distance of all pairs, metres, at least 0; without a `world`, of the links of the robot.",
            default: "0",
        },
        OptionSpec {
            name: "max_move",
            set: Setter::Numbers(|arm, max_move| arm.with_max_move(&max_move)),
            doc: "largest displacement of each joint from its start, shape (dof,), radians or metres; a hard bound.",
            default: "inf",
        },
        OptionSpec {
            name: "metres_per_radian",
            set: Setter::Number(|arm, metres| arm.with_metres_per_radian(metres)),
            doc: "distance that weighs as much as a radian, metres.",
            default: "a quarter of the arm's reach",
        },
        OptionSpec {
            name: "only",
            set: Setter::Elsewhere,
            doc: "names of the free joints; all others are locked at `held`.",
            default: "all between base and tip",
        },
        OptionSpec {
            name: "orientation_tolerance",
            set: Setter::Number(ArmBuilder::with_orientation_tolerance),
            doc: "largest angle between the tool and its target, radians.",
            default: "1e-6",
        },
        OptionSpec {
            name: "position_tolerance",
            set: Setter::Number(ArmBuilder::with_position_tolerance),
            doc: "largest distance of the tool from its target, metres.",
            default: "1e-6",
        },
        OptionSpec {
            name: "posture",
            set: Setter::Numbers(|arm, posture| arm.with_posture(&posture)),
            doc: "nominal posture of a redundant arm, shape (dof,), radians or metres.",
            default: "none",
        },
        OptionSpec {
            name: "search",
            set: Setter::Named(|arm, name| Ok(arm.with_search(named("search", name, &SEARCHES)?))),
            doc: "\"start\" (the solution of the attempt from the start; other attempts only if that fails), \
                  \"first\" (the fastest) or \"nearest\" (the nearest to the start).",
            default: "\"start\"",
        },
        OptionSpec {
            name: "seed",
            set: Setter::LongWhole(ArmBuilder::with_seed),
            doc: "seed of the attempts after the first.",
            default: "0",
        },
        OptionSpec {
            name: "srdf",
            set: Setter::Elsewhere,
            doc: "an `Srdf` of the robot, whose state \"ready\" or \"home\" is `default_start`.",
            default: "none",
        },
        OptionSpec {
            name: "time_limit",
            set: Setter::TimeLimit(|arm, limit| arm.with_time_limit(limit)),
            doc: "seconds for a query; with a time limit, results may differ from run to run.",
            default: "none",
        },
        OptionSpec {
            name: "tool",
            set: Setter::Placement(|arm, tool| arm.with_tool(tool)),
            doc: "placement of the tool relative to the tip, 4 x 4, metres.",
            default: "the tip itself",
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
    ]
}

/// Applies all given options to a builder; objects of the interface are applied by the caller. `neutral` is the default
/// of `held`.
///
/// # Errors
/// If an option has another type, or names an unknown value.
pub fn apply<'m, A: Arguments>(
    builder: ArmBuilder<'m>,
    arguments: &A,
    neutral: &[f64],
) -> Result<ArmBuilder<'m>, ErrorOf<A>> {
    let builder = super::apply(arguments, &options(), builder)?;
    let Some(only) = arguments.get("only")? else {
        return Ok(builder);
    };
    let joints = only.names("only")?;
    Ok(match arguments.get("held")? {
        Some(held) => builder.with_only(&joints, &held.numbers("held")?),
        None => builder.with_only(&joints, neutral),
    })
}
