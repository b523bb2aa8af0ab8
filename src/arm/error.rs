//! What can be wrong with an arm's description, and with a question to it.

use thiserror::Error;

use crate::bad_option::BadOption;
use crate::kinematics::KinematicsError;
use crate::lanes::LaneError;
use crate::model::{ModelError, UnknownName};
use crate::problem::ProblemError;
use crate::spatial::RigidDefect;

/// Why an arm cannot be built.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ArmError {
    /// A frame or joint that the model does not have; the message lists the valid names.
    #[error(transparent)]
    UnknownName(#[from] UnknownName),
    /// Locked values or followers that do not fit the limits.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Nothing between base and tip can move.
    #[error("no free joint between `{base}` and `{tip}`")]
    NoFreeJoint {
        /// The base frame.
        base: String,
        /// The tip frame.
        tip: String,
    },
    /// A ball joint between base and tip.
    #[error("`{joint}` is a ball joint: an arm has joints of one number each, a `Problem` any")]
    BallJoint {
        /// The joint.
        joint: String,
    },
    /// A joint of the arm that moves a loop of the model, which an arm does not close.
    #[error(
        "joint `{joint}` moves loop `{closed}`, which an arm does not close: a `Problem` on the model does \
         (or lock the joint)"
    )]
    InLoop {
        /// The joint.
        joint: String,
        /// The loop.
        closed: String,
    },
    /// An option out of its range.
    #[error(transparent)]
    Option(#[from] BadOption),
    /// An option that has one number a joint, given another number of them.
    #[error(
        "option {option} has {given} numbers, the arm has {} free joints: {}",
        joints.len(), joints.join(", ")
    )]
    JointCount {
        /// Which option.
        option: &'static str,
        /// Numbers given.
        given: usize,
        /// The free joints, base to tip.
        joints: Vec<String>,
    },
    /// Two options that ask for different things.
    #[error("{0}")]
    Conflict(&'static str),
    /// A margin out of its range.
    #[cfg(feature = "collision")]
    #[error(transparent)]
    Checker(#[from] crate::collision::CheckerError),
    /// A checker of another model, told by its size.
    #[error("the checker's model has {given} numbers a configuration, the arm's has {expected}")]
    ForeignChecker {
        /// Of the checker's model.
        given: usize,
        /// Of the arm's.
        expected: usize,
    },
    /// A configuration of the whole model that does not place it.
    #[error(transparent)]
    Kinematics(#[from] KinematicsError),
    /// The tool's placement is not a rigid motion.
    #[error("the tool's placement is not a rigid motion: {0}")]
    Tool(RigidDefect),
    /// The problem behind the arm.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The lane engine's options.
    #[error(transparent)]
    Lanes(#[from] LaneError),
}

/// What a question gives, or why it cannot be asked.
pub(crate) type Reply<T> = Result<T, QueryError>;

/// Why a question cannot be answered. Missing the target is no error: see
/// [`Solution::reached`](crate::Solution).
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum QueryError {
    /// A slice of the wrong length.
    #[error("{what} has {given} numbers, {expected} are needed ({joints} joints a configuration)")]
    Length {
        /// Which argument.
        what: &'static str,
        /// Its length.
        given: usize,
        /// The length it must have.
        expected: usize,
        /// Free joints of the arm.
        joints: usize,
    },
    /// A start that is NaN or infinite. Outside the limits is fine.
    #[error("the start of query {query} holds {value} for joint `{joint}`, which is not finite")]
    StartNotFinite {
        /// Which query of the batch, 0 for a single one.
        query: usize,
        /// The joint.
        joint: String,
        /// The value.
        value: f64,
    },
    /// A target that is not finite or not a rigid motion to 1e-6.
    #[error("target {query}: {problem}")]
    Target {
        /// Which query of the batch, 0 for a single one.
        query: usize,
        /// What is wrong.
        problem: RigidDefect,
    },
    /// A configuration, velocity or acceleration that holds NaN or infinity.
    #[error("{what} holds {value} for joint `{joint}`, which is not finite")]
    NotFinite {
        /// The argument.
        what: &'static str,
        /// The joint.
        joint: String,
        /// The value.
        value: f64,
    },
    /// What an arm touches that keeps clear of nothing: it has no [checker](super::Arm::with_checker).
    #[error(
        "what the arm touches is not known: it was made without a world or a margin to keep clear of"
    )]
    NothingToKeepClearOf,
    /// A servo's time step that is no positive number of seconds.
    #[error("the time step is {0} s: a positive finite number")]
    TimeStep(f64),
    /// A servo's start state beyond a velocity or acceleration limit.
    #[error("joint `{joint}`: {rate} {value} exceeds its limit {limit}")]
    RateLimit {
        /// The joint.
        joint: String,
        /// "velocity" or "acceleration".
        rate: &'static str,
        /// Given, rad/s or m/s (or that a second).
        value: f64,
        /// The joint's limit.
        limit: f64,
    },
    /// A servo's start state whose acceleration cannot end before the velocity limit.
    #[error(
        "joint `{joint}`: its acceleration cannot end before its velocity is {velocity:.6}, beyond its limit {limit}"
    )]
    CannotCoast {
        /// The joint.
        joint: String,
        /// Velocity when the acceleration has ended, rad/s or m/s.
        velocity: f64,
        /// The velocity limit, rad/s or m/s.
        limit: f64,
    },
    /// A servo's start state from which a joint cannot brake before a position limit.
    #[error(
        "joint `{joint}` cannot brake before its position limit {limit}: it would pass it by {distance:.6} rad or m"
    )]
    CannotBrake {
        /// The joint.
        joint: String,
        /// The position limit, radians or metres.
        limit: f64,
        /// Distance beyond the limit at which the joint would come to rest, radians or metres.
        distance: f64,
    },
    /// The problem behind the arm could not be set up once more; it could when the arm was built.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The chain could not be compiled once more; it could when the arm was built.
    #[error(transparent)]
    Kinematics(#[from] KinematicsError),
}
