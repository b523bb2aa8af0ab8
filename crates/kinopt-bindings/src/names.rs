//! Names of enum variants.

use kinopt::animation::Playback;
use kinopt::arm::{
    Argument, ElbowBranch, HeldBy, Search, ServoStatus, ShoulderBranch, WristBranch,
};
use kinopt::ik::{BoundKind, Side};
use kinopt::model::{LoopKind, UnknownName};
use kinopt::motion::path::MissReason;
use kinopt::problem::{Derivatives, Preferences};
use kinopt::task::{Axis, PoseBounds, Quantity, Role};

/// Names of values.
pub type Names<T, const N: usize> = [(&'static str, T); N];

/// Derivative modes of a problem.
pub const DERIVATIVES: Names<Derivatives, 4> = [
    ("analytic", Derivatives::Analytic),
    ("dual", Derivatives::Dual),
    ("forward_difference", Derivatives::ForwardDifference),
    ("central_difference", Derivatives::CentralDifference),
];

/// Modes of soft tasks.
pub const PREFERENCES: Names<Preferences, 2> = [
    ("within_goals", Preferences::WithinGoals),
    ("traded", Preferences::Traded),
];

/// Selection among several solutions of an arm.
pub const SEARCHES: Names<Search, 3> = [
    ("start", Search::Start),
    ("first", Search::First),
    ("nearest", Search::Nearest),
];

/// Behaviour of a clip outside its span, as in files of state machines.
pub const PLAYBACKS: Names<Playback, 3> = [
    ("hold", Playback::Hold),
    ("loop", Playback::Loop),
    ("ping_pong", Playback::PingPong),
];

/// Roles of tasks.
pub const ROLES: Names<Role, 2> = [("goal", Role::Goal), ("preference", Role::Preference)];

/// Goal bounds by name: the full pose, or the position with any orientation.
///
/// # Errors
/// If no goal has this name.
pub fn goal(name: &str) -> Result<PoseBounds, UnknownName> {
    let goals = [
        ("pose", PoseBounds::pose()),
        ("position", PoseBounds::position()),
    ];
    named("goal", name, &goals)
}

/// Coordinate axes.
pub const AXES: Names<Axis, 3> = [("x", Axis::X), ("y", Axis::Y), ("z", Axis::Z)];

/// Kinds of loops.
pub const LOOPS: Names<LoopKind, 2> = [("connect", LoopKind::Connect), ("weld", LoopKind::Weld)];

/// Limits that restrict the source joint of mimic joints: false for its own, true for those of its mimic joints too.
pub const MIMIC_LIMITS: Names<bool, 2> = [("source", false), ("both", true)];

/// Quantities of errors, weights and tolerances; their names are those in the library's messages.
const QUANTITIES: [Quantity; 8] = [
    Quantity::Metres,
    Quantity::Radians,
    Quantity::Pixels,
    Quantity::JointUnits,
    Quantity::JointUnitsPerSecond,
    Quantity::MetresPerSecond,
    Quantity::RadiansPerSecond,
    Quantity::Ratio,
];

/// Returns a value by its name; `kind` describes it in the message.
///
/// # Errors
/// If no value has this name.
pub fn named<T: Clone>(
    kind: &'static str,
    name: &str,
    known: &[(&'static str, T)],
) -> Result<T, UnknownName> {
    let entry = known.iter().find(|(word, _)| *word == name);
    let names = known.iter().map(|(word, _)| *word);
    entry
        .map(|(_, value)| value.clone())
        .ok_or_else(|| UnknownName::new(kind, name, names))
}

/// Returns a quantity by its name.
///
/// # Errors
/// If no quantity has this name.
pub fn quantity(name: &str) -> Result<Quantity, UnknownName> {
    let known = QUANTITIES.into_iter().find(|q| q.to_string() == name);
    let names = QUANTITIES.map(|quantity| quantity.to_string());
    known.ok_or_else(|| UnknownName::new("quantity", name, names.iter().map(String::as_str)))
}

/// Name of a side of an interval.
#[must_use]
pub fn side(side: Side) -> &'static str {
    match side {
        Side::Lower => "lower",
        Side::Upper => "upper",
    }
}

/// Name of a role.
#[must_use]
pub fn role(role: Role) -> &'static str {
    match role {
        Role::Preference => "preference",
        _ => "goal",
    }
}

/// Name of the kind of an active limit.
#[must_use]
pub fn bound_kind(kind: BoundKind) -> &'static str {
    match kind {
        BoundKind::Move => "move",
        _ => "limit",
    }
}

/// Name of the state of a servo.
#[must_use]
pub fn servo_status(status: ServoStatus) -> &'static str {
    match status {
        ServoStatus::OnTarget => "on_target",
        ServoStatus::SpeedLimited => "speed_limited",
        ServoStatus::Settling => "settling",
        ServoStatus::Blocked => "blocked",
        ServoStatus::Touching => "touching",
        ServoStatus::Stopping => "stopping",
        ServoStatus::Stopped => "stopped",
        _ => "nearest",
    }
}

/// Name of the limit that is active at a joint of a servo.
#[must_use]
pub fn held_by(by: HeldBy) -> &'static str {
    match by {
        HeldBy::Limit(Side::Lower) => "lower limit",
        HeldBy::Limit(Side::Upper) => "upper limit",
        HeldBy::Speed(Side::Lower) => "speed down",
        HeldBy::Speed(Side::Upper) => "speed up",
        HeldBy::Acceleration(Side::Lower) => "acceleration down",
        HeldBy::Acceleration(Side::Upper) => "acceleration up",
        HeldBy::Outside(Side::Lower) => "below lower limit",
        HeldBy::Outside(Side::Upper) => "above upper limit",
        _ => "other",
    }
}

/// Text of the reason why a point of a path is not reached.
#[must_use]
pub fn miss_reason(reason: &MissReason) -> String {
    match reason {
        MissReason::BeyondReach { distance, reach } => {
            format!("beyond reach: {distance:.4} m away, and the chain is {reach:.4} m long")
        }
        MissReason::Touches(pair) => format!("collision of {pair}"),
        _ => "no configuration within the limits was found".to_owned(),
    }
}

/// Name of a branch of the shoulder.
#[must_use]
pub fn shoulder(branch: ShoulderBranch) -> &'static str {
    match branch {
        ShoulderBranch::Left => "left",
        ShoulderBranch::Right => "right",
    }
}

/// Name of a branch of the elbow.
#[must_use]
pub fn elbow(branch: ElbowBranch) -> &'static str {
    match branch {
        ElbowBranch::Up => "up",
        ElbowBranch::Down => "down",
    }
}

/// Name of a branch of the wrist.
#[must_use]
pub fn wrist(branch: WristBranch) -> &'static str {
    match branch {
        WristBranch::NoFlip => "no_flip",
        WristBranch::Flip => "flip",
    }
}

/// Name of the argument for the completeness of a solution set; `None` for none.
#[must_use]
pub fn argument(argument: &Argument) -> Option<&'static str> {
    match argument {
        Argument::SphericalWrist => Some("spherical_wrist"),
        Argument::SphericalShoulder => Some("spherical_shoulder"),
        Argument::ThreeParallelAxes => Some("three_parallel_axes"),
        Argument::UnivariatePolynomial { .. } => Some("univariate_polynomial"),
        _ => None,
    }
}
