//! Errors of building an arm and of its queries.

use thiserror::Error;

use crate::simd_ik::LaneError;
use kinopt_kinematics::bad_option::BadOption;
use kinopt_kinematics::kinematics::KinematicsError;
use kinopt_kinematics::model::{Limits, ModelError, UnknownName};
use kinopt_kinematics::spatial::RigidDefect;
use kinopt_solver::problem::ProblemError;

/// Error of building an arm.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ArmError {
    /// The model has no such frame or joint; the message lists the valid names.
    #[error(transparent)]
    UnknownName(#[from] UnknownName),
    /// Locked values or mimic joints do not fit the limits.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// No joint between base and tip can move.
    #[error("no free joint between base `{base}` and tip `{tip}`")]
    NoFreeJoint {
        /// Name of the base frame.
        base: String,
        /// Name of the tip frame.
        tip: String,
    },
    /// A ball joint is between base and tip.
    #[error(
        "joint `{joint}` is a ball joint: an arm supports revolute and prismatic joints; use a `Problem`"
    )]
    BallJoint {
        /// Name of the joint.
        joint: String,
    },
    /// A joint of the arm moves a loop of the model, which an arm does not close.
    #[error(
        "joint `{joint}` moves loop `{closed}`: an arm does not close loops; lock the joint, or use a `Problem`"
    )]
    InLoop {
        /// Name of the joint.
        joint: String,
        /// Name of the loop.
        closed: String,
    },
    /// Joint limits are not within the limits of the model.
    #[error(
        "joint_limits of `{joint}` are [{}, {}], expected an interval within its limits [{}, {}]",
        given.lower, given.upper, limits.lower, limits.upper
    )]
    JointLimits {
        /// Name of the joint.
        joint: String,
        /// Given limits, radians or metres.
        given: Limits,
        /// Limits of the model.
        limits: Limits,
    },
    /// An option is out of its range.
    #[error(transparent)]
    Option(#[from] BadOption),
    /// An option with one number per joint has another number of them.
    #[error(
        "option {option} has {given} numbers, expected {}, one for each free joint: {}",
        joints.len(), joints.join(", ")
    )]
    JointCount {
        /// Name of the option.
        option: &'static str,
        /// Number of values given.
        given: usize,
        /// Names of the free joints, base to tip.
        joints: Vec<String>,
    },
    /// Two options contradict each other.
    #[error("{0}")]
    Conflict(&'static str),
    /// A margin is out of its range, or an obstacle is attached to an unknown frame.
    #[cfg(feature = "collision")]
    #[error(transparent)]
    Checker(#[from] kinopt_collision::collision::WorldError),
    /// The checker belongs to another model, recognised by its size.
    #[error(
        "the configuration of the checker's model has {given} numbers, that of the arm's model has {expected}"
    )]
    ForeignChecker {
        /// Degrees of freedom of the checker's model.
        given: usize,
        /// Degrees of freedom of the arm's model.
        expected: usize,
    },
    /// A configuration of the whole model is invalid for forward kinematics.
    #[error(transparent)]
    Kinematics(#[from] KinematicsError),
    /// The tool's placement is not a rigid motion.
    #[error("the tool's placement is not a rigid motion: {0}")]
    Tool(RigidDefect),
    /// The general problem of the arm is invalid.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// Options of the SIMD solver are invalid.
    #[error(transparent)]
    Lanes(#[from] LaneError),
}

/// Error of a query. An unreached target is not an error: see [`Solution::reached`](kinopt_solver::Solution).
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum QueryError {
    /// A slice has the wrong length.
    #[error("{what} has {given} numbers, expected {expected} (the arm has {joints} joints)")]
    Length {
        /// Name of the argument.
        what: &'static str,
        /// Number of values given.
        given: usize,
        /// Number of values needed.
        expected: usize,
        /// Number of free joints of the arm.
        joints: usize,
    },
    /// A start is NaN or infinite. A start outside the limits is valid.
    #[error("{}: joint `{joint}` is {value}, which is not finite", start_of(*query))]
    StartNotFinite {
        /// Index of the query in the batch or path; `None` for a single query.
        query: Option<usize>,
        /// Name of the joint.
        joint: String,
        /// Value of the joint.
        value: f64,
    },
    /// A target is not finite or not a rigid motion to 1e-6.
    #[error("{}: {problem}", target_of(*query))]
    Target {
        /// Index of the query in the batch or path; `None` for a single query.
        query: Option<usize>,
        /// Defect of the placement.
        problem: RigidDefect,
    },
    /// A configuration, velocity or acceleration that holds NaN or infinity.
    #[error("{what}: joint `{joint}` is {value}, which is not finite")]
    NotFinite {
        /// The argument.
        what: &'static str,
        /// The joint.
        joint: String,
        /// Value of the joint.
        value: f64,
    },
    /// The arm has no [checker](super::Arm::with_checker), so its collisions are unknown.
    #[error("collisions are unknown: the arm was built without a world or a margin")]
    NothingToKeepClearOf,
    /// A goal set has another number of starts than arms.
    #[error("{given} starts for {arms} arms: expected one start for each arm")]
    Starts {
        /// Number of starts given.
        given: usize,
        /// Number of arms.
        arms: usize,
    },
    /// The time step of a servo is out of range; a rate in hertz is a common mistake.
    #[error("the time step is {0} s, expected a number above 0 and at most 1 (0.001 for 1 kHz)")]
    TimeStep(f64),
    /// The start state of a servo exceeds a velocity or acceleration limit.
    #[error("joint `{joint}`: {rate} {value} exceeds its limit {limit}")]
    RateLimit {
        /// Name of the joint.
        joint: String,
        /// "velocity" or "acceleration".
        rate: &'static str,
        /// Given value, rad/s or m/s, or rad/s² or m/s².
        value: f64,
        /// Limit of the joint, in the same unit.
        limit: f64,
    },
    /// In the start state of a servo an acceleration cannot end before the velocity limit.
    #[error(
        "joint `{joint}`: its velocity is {velocity:.6} when its acceleration ends, beyond the limit {limit}"
    )]
    CannotCoast {
        /// Name of the joint.
        joint: String,
        /// Velocity at the end of the acceleration, rad/s or m/s.
        velocity: f64,
        /// Velocity limit, rad/s or m/s.
        limit: f64,
    },
    /// In the start state of a servo a joint cannot brake before a position limit.
    #[error(
        "joint `{joint}` cannot brake before its position limit {limit}: it stops {distance:.6} rad or m beyond"
    )]
    CannotBrake {
        /// Name of the joint.
        joint: String,
        /// Position limit, radians or metres.
        limit: f64,
        /// Distance beyond the limit at which the joint would come to rest, radians or metres.
        distance: f64,
    },
    /// The general problem could not be set up again. It could when the arm was built.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The chain could not be compiled again. It could when the arm was built.
    #[error(transparent)]
    Kinematics(#[from] KinematicsError),
}

/// The start of a query in messages.
fn start_of(query: Option<usize>) -> String {
    query.map_or("the start".to_owned(), |index| {
        format!("the start of query {index}")
    })
}

/// The target of a query in messages.
fn target_of(query: Option<usize>) -> String {
    query.map_or("target".to_owned(), |index| format!("target {index}"))
}
