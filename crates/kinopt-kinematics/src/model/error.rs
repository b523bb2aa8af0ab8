//! Errors of models and parameter maps.

use thiserror::Error;

use crate::spatial::RigidDefect;

/// Errors of models and parameter maps.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ModelError {
    /// Two objects of one kind have the same name.
    #[error("{kind} name `{name}` is used twice")]
    DuplicateName {
        /// Kind of the object: "joint", "frame" or "loop".
        kind: &'static str,
        /// The common name.
        name: String,
    },
    /// An id that is not in the model, or a parent that comes after its child.
    #[error("{kind} `{name}` refers to a joint that is missing or comes after it")]
    ForeignId {
        /// The kind of the object with the wrong reference.
        kind: &'static str,
        /// The name of the object.
        name: String,
    },
    /// Limits that are NaN, out of order or empty.
    #[error("joint `{joint}`: limits [{lower}, {upper}] are not an interval")]
    BadLimits {
        /// Name of the joint.
        joint: String,
        /// Lower end of the given limits.
        lower: f64,
        /// Upper end of the given limits.
        upper: f64,
    },
    /// Empty limits of a ball joint, or ball limits on another kind of joint.
    #[error("joint `{joint}` has {problem}")]
    BadBallLimits {
        /// Name of the joint.
        joint: String,
        /// The defect.
        problem: &'static str,
    },
    /// A quaternion that is zero or not finite.
    #[error("joint `{joint}`: a quaternion of length 0 is not a rotation")]
    NoRotation {
        /// Name of the ball joint.
        joint: String,
    },
    /// A ball joint in a role for joints with one coordinate.
    #[error("joint `{joint}` is a ball joint and cannot be {role} by one number")]
    BallJoint {
        /// Name of the joint.
        joint: String,
        /// The role: "coupled", "narrowed", …
        role: &'static str,
    },
    /// A joint that is not a ball joint, locked at a rotation.
    #[error("joint `{joint}` is not a ball joint and cannot be locked at a rotation")]
    NoBallJoint {
        /// Name of the joint.
        joint: String,
    },
    /// A free joint whose prismatic joints and ball joint are not consecutive.
    #[error(
        "free joint `{joint}`: its prismatic joints and its ball joint are not consecutive in the configuration"
    )]
    BrokenFreeJoint {
        /// Its first prismatic joint.
        joint: String,
    },
    /// An axis that is zero, or whose components or their sum are not finite.
    ///
    /// Builders normalise every other axis.
    #[error("joint `{joint}`: axis ({x}, {y}, {z}) has no direction")]
    BadAxis {
        /// Name of the joint.
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
        /// Kind of the object: "joint", "frame" or "loop".
        kind: &'static str,
        /// The name of the object.
        name: String,
        /// The defect.
        problem: RigidDefect,
    },
    /// A loop with a frame that is not in the model.
    #[error("loop `{name}` connects a frame that is not in this model")]
    ForeignLoop {
        /// Name of the loop.
        name: String,
    },
    /// A loop of a frame with itself.
    #[error("loop `{name}` connects frame `{frame}` to itself")]
    LoopOfOneFrame {
        /// Name of the loop.
        name: String,
        /// Name of the frame.
        frame: String,
    },
    /// A base joint for a robot whose own free joint already moves all of it.
    #[error(
        "joint `{joint}` already moves all of `{model}` freely: use a free base, base bounds, or no base joint"
    )]
    FreeAlready {
        /// The first prismatic joint of the free joint.
        joint: String,
        /// Name of the robot.
        model: String,
    },
    /// A loop that no configuration closes.
    ///
    /// One link is longer than all others together, or no joint moves the anchors relative to each other.
    #[error("loop `{name}` cannot close: its closure error is at least {gap} {unit}")]
    LoopCannotClose {
        /// Name of the loop.
        name: String,
        /// Smallest closure error found possible.
        gap: f64,
        /// The unit of the closure error.
        unit: &'static str,
    },
    /// A configuration order that does not contain every moving joint once.
    #[error(
        "the configuration order names {given} joints, expected each of the {moving} moving joints once"
    )]
    BadConfigurationOrder {
        /// Number of joints in the order.
        given: usize,
        /// Number of moving joints.
        moving: usize,
    },
    /// More joints or frames than an id can represent.
    #[error("a model holds at most {limit} {kind}s")]
    TooMany {
        /// Kind of the objects: "joint" or "frame".
        kind: &'static str,
        /// The largest number.
        limit: usize,
    },
    /// A fixed joint in a role for moving joints.
    #[error("joint `{joint}` is fixed and cannot be {role}")]
    FixedJoint {
        /// Name of the joint.
        joint: String,
        /// The role: "locked", "coupled", …
        role: &'static str,
    },
    /// A joint that is locked twice or coupled twice.
    #[error("joint `{joint}` is {role} twice")]
    RoleTwice {
        /// Name of the joint.
        joint: String,
        /// The role: "locked" or "coupled".
        role: &'static str,
    },
    /// Mimic joints that form a cycle.
    #[error("joint `{joint}` is its own source through mimic joints")]
    CouplingCycle {
        /// One joint of the cycle.
        joint: String,
    },
    /// A ratio, an offset or a locked value that is not finite.
    #[error("joint `{joint}`: {what} is {value}, which is not a finite number")]
    NotFinite {
        /// Name of the joint.
        joint: String,
        /// The name of the number.
        what: &'static str,
        /// The value.
        value: f64,
    },
    /// A locked value outside the joint's limits.
    #[error("joint `{joint}` cannot be locked at {value}: its limits are [{lower}, {upper}]")]
    LockedOutsideLimits {
        /// Name of the joint.
        joint: String,
        /// The requested value, radians or metres.
        value: f64,
        /// Lower limit of the joint.
        lower: f64,
        /// Upper limit of the joint.
        upper: f64,
    },
    /// A slice of wrong length.
    #[error("{what} has {expected} numbers, not {given}")]
    Length {
        /// Name of the slice: "a configuration of this model", "the variables of this map", …
        what: &'static str,
        /// Given number of values.
        given: usize,
        /// Required number of values.
        expected: usize,
    },
    /// An element of a slice that is not finite.
    #[error("number {index} of {what} is {value}, which is not a finite number")]
    BadNumber {
        /// Name of the slice, as in [`Length`](Self::Length).
        what: &'static str,
        /// Index of the element, from 0.
        index: usize,
        /// The value.
        value: f64,
    },
    /// An interpolation parameter that is not finite.
    #[error("the interpolation parameter is {share}, which is not a finite number")]
    BadShare {
        /// The interpolation parameter.
        share: f64,
    },
    /// Coupled joints whose limits have no common value.
    #[error("joint `{joint}` and its mimic joints have no value within all limits")]
    EmptyRange {
        /// The source joint.
        joint: String,
    },
}
