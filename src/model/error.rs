//! What can be wrong with a model, each naming the culprit.

use thiserror::Error;

use crate::spatial::RigidDefect;

/// Why a model or a parameter map cannot be built.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ModelError {
    /// Two things of one kind share a name.
    #[error("{kind} name `{name}` is used twice")]
    DuplicateName {
        /// "joint", "frame" or "loop".
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// An id beyond this model's joints, or a parent that comes later.
    #[error("{kind} `{name}` refers to a joint that is not in this model or comes after it")]
    ForeignId {
        /// What holds the bad reference.
        kind: &'static str,
        /// Its name.
        name: String,
    },
    /// Limits that are NaN, out of order or empty.
    #[error("joint `{joint}`: limits [{lower}, {upper}] are not an interval")]
    BadLimits {
        /// The joint.
        joint: String,
        /// Lower end as given.
        lower: f64,
        /// Upper end as given.
        upper: f64,
    },
    /// Limits of a ball joint that leave nothing, or limits of one on another kind of joint.
    #[error("joint `{joint}` has {problem}")]
    BadBallLimits {
        /// The joint.
        joint: String,
        /// What is wrong with them.
        problem: &'static str,
    },
    /// A quaternion that is zero, or not finite.
    #[error("joint `{joint}`: a quaternion without length is no rotation")]
    NoRotation {
        /// The ball joint.
        joint: String,
    },
    /// A ball joint was given a role that only one number can have.
    #[error("joint `{joint}` is a ball and cannot be {role} by one number")]
    BallJoint {
        /// The joint.
        joint: String,
        /// "coupled", "narrowed", …
        role: &'static str,
    },
    /// A joint that is no ball was given what only a ball can have.
    #[error("joint `{joint}` is no ball and cannot be locked at a rotation")]
    NoBallJoint {
        /// The joint.
        joint: String,
    },
    /// A free joint's slides and ball that are not side by side.
    #[error(
        "free joint `{joint}` is not three slides and a ball side by side in the configuration"
    )]
    BrokenFreeJoint {
        /// Its first slide.
        joint: String,
    },
    /// An axis that is zero, or of which a component or their sum is not finite; builders make any other
    /// of unit length.
    #[error("joint `{joint}`: axis ({x}, {y}, {z}) has no direction")]
    BadAxis {
        /// The joint.
        joint: String,
        /// First component.
        x: f64,
        /// Second component.
        y: f64,
        /// Third component.
        z: f64,
    },
    /// A placement that is not finite or whose rotation is not orthonormal with determinant +1.
    #[error("{kind} `{name}`: its placement is not a rigid motion ({problem})")]
    BadPlacement {
        /// "joint", "frame" or "loop".
        kind: &'static str,
        /// Its name.
        name: String,
        /// What is wrong with it.
        problem: RigidDefect,
    },
    /// A loop of a frame that the model does not have.
    #[error("loop `{name}` joins a frame that is not in this model")]
    ForeignLoop {
        /// The loop.
        name: String,
    },
    /// A loop of a frame with itself.
    #[error("loop `{name}` joins the frame `{frame}` to itself")]
    LoopOfOneFrame {
        /// The loop.
        name: String,
        /// The frame.
        frame: String,
    },
    /// A base joint for a robot that its own free joint moves as a whole.
    #[error(
        "joint `{joint}` moves the whole of `{model}` freely already: its base may be free, within a room, or left as it is"
    )]
    FreeAlready {
        /// The free joint's first slide.
        joint: String,
        /// The robot.
        model: String,
    },
    /// A loop that no configuration closes: a link longer than all others together, or places that no joint
    /// moves against each other.
    #[error("loop `{name}` cannot close: its places stay at least {gap} {unit} apart")]
    LoopCannotClose {
        /// The loop.
        name: String,
        /// How near its places can come.
        gap: f64,
        /// What that is counted in.
        unit: &'static str,
    },
    /// A configuration order that does not name every moving joint once.
    #[error(
        "the configuration order names {given} joints but must name each of the {moving} moving joints once"
    )]
    BadConfigurationOrder {
        /// How many it names.
        given: usize,
        /// How many joints move.
        moving: usize,
    },
    /// More joints or frames than an id can count.
    #[error("a model holds at most {limit} {kind}s")]
    TooMany {
        /// "joint" or "frame".
        kind: &'static str,
        /// The limit.
        limit: usize,
    },
    /// A joint that does not move was given a role that needs one.
    #[error("joint `{joint}` is fixed and cannot be {role}")]
    FixedJoint {
        /// The joint.
        joint: String,
        /// "locked", "coupled", …
        role: &'static str,
    },
    /// A joint that was locked, or coupled, twice.
    #[error("joint `{joint}` is {role} twice")]
    RoleTwice {
        /// The joint.
        joint: String,
        /// "locked" or "coupled".
        role: &'static str,
    },
    /// Joints that follow one another in a ring.
    #[error("joint `{joint}` follows itself through its masters")]
    CouplingCycle {
        /// One joint of the ring.
        joint: String,
    },
    /// A ratio, an offset or a locked value that is not finite.
    #[error("joint `{joint}`: {what} is {value}, which is not a finite number")]
    NotFinite {
        /// The joint.
        joint: String,
        /// Which number.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// A value outside the joint's own limits.
    #[error("joint `{joint}` cannot be locked at {value}: its limits are [{lower}, {upper}]")]
    LockedOutsideLimits {
        /// The joint.
        joint: String,
        /// The value asked for.
        value: f64,
        /// Lower limit.
        lower: f64,
        /// Upper limit.
        upper: f64,
    },
    /// Too few or too many numbers.
    #[error("{what} has {expected} numbers, {given} were given")]
    Length {
        /// "a configuration of this model", "the variables of this map", …
        what: &'static str,
        /// Numbers given.
        given: usize,
        /// Numbers needed.
        expected: usize,
    },
    /// One of several numbers that is not finite.
    #[error("number {index} of {what} is {value}, which is not a finite number")]
    BadNumber {
        /// As of [`Length`](Self::Length).
        what: &'static str,
        /// Which, from 0.
        index: usize,
        /// The number.
        value: f64,
    },
    /// A share of the way between two configurations that is not finite.
    #[error(
        "the share of the way between two configurations is {share}, which is not a finite number"
    )]
    BadShare {
        /// The share.
        share: f64,
    },
    /// Coupled joints whose limits leave no common value.
    #[error("joint `{joint}` and the joints that follow it have no value within all limits")]
    EmptyRange {
        /// The master joint.
        joint: String,
    },
}
