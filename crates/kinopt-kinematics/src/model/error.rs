//! Errors of models, masses, parameter maps and skeletons.

use thiserror::Error;

use super::UnknownName;
use crate::spatial::RigidDefect;

/// Errors of models, masses, parameter maps and skeletons; each names the joint, frame or bone.
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
    /// A name that no bone or frame has; the message lists the valid names.
    #[error(transparent)]
    UnknownName(#[from] UnknownName),
    /// A bone comes before its parent. This check also excludes cycles.
    #[error("bone `{bone}`: its parent must precede it in the list")]
    ParentNotBefore {
        /// Name of the child.
        bone: String,
    },
    /// A length is negative or not finite.
    #[error("bone `{bone}`: length {length} is not a finite number of at least 0")]
    BadLength {
        /// Name of the bone.
        bone: String,
        /// Given length.
        length: f64,
    },
    /// Limits are NaN or out of order.
    #[error("bone `{bone}`: limits [{lower}, {upper}] rad of its {angle} are not an interval")]
    BadBoneLimits {
        /// Name of the bone.
        bone: String,
        /// Angle of the bone: first twist, bend or second twist.
        angle: &'static str,
        /// Lower limit, radians.
        lower: f64,
        /// Upper limit, radians.
        upper: f64,
    },
    /// A rest placement is not a rigid motion.
    #[error("bone `{bone}`: its rest placement is not a rigid motion ({problem})")]
    BadRest {
        /// Name of the bone.
        bone: String,
        /// Defect of the placement.
        problem: RigidDefect,
    },
    /// A bone of another skeleton.
    #[error("bone {bone} does not exist; there are {bones} bones")]
    ForeignBone {
        /// Index of the bone.
        bone: usize,
        /// Number of bones.
        bones: usize,
    },
    /// An invalid hinge.
    #[error("hinge of bone `{bone}`: {problem}")]
    BadHinge {
        /// Name of the bone.
        bone: String,
        /// Problem in words.
        problem: String,
    },
    /// A cone of a bone without a joint.
    #[error("bone `{bone}` is locked; only a rotating bone has a cone")]
    ConeOfStillBone {
        /// Name of the bone.
        bone: String,
    },
    /// A cone of the bone of a free root.
    #[error("bone `{bone}` is a free root, which has no cone")]
    ConeOfFreeBone {
        /// Name of the bone.
        bone: String,
    },
    /// No mass on any body that joints move.
    #[error("`{model}` has no centre of mass: its joints move no masses")]
    NoMass {
        /// Name of the model.
        model: String,
    },
    /// A mass is negative or not finite.
    #[error("the mass of `{frame}` is {mass} kg, expected a finite number of at least 0")]
    BadMass {
        /// The frame with the mass.
        frame: String,
        /// The mass in kilograms.
        mass: f64,
    },
    /// A position of a mass that is not finite.
    #[error("the mass of `{frame}`: coordinate {coordinate} m is not a finite number")]
    BadMassPosition {
        /// The frame with the mass.
        frame: String,
        /// The coordinate in metres.
        coordinate: f64,
    },
    /// A frame id that is not in the model.
    #[error("a mass is on frame {index}, but model `{model}` has {frames} frames")]
    ForeignMass {
        /// Name of the model.
        model: String,
        /// The index of the frame id.
        index: usize,
        /// Number of frames in the model.
        frames: usize,
    },
    /// A robot description without inertials whose masses depend on mesh files, which are not opened.
    #[error(
        "{} no inertial: mass and centre depend on mesh files, which are not opened; add an inertial or set masses",
        match others {
            0 => format!("`{frame}` has"),
            1 => format!("`{frame}` and 1 more body have"),
            n => format!("`{frame}` and {n} more bodies have"),
        }
    )]
    MissingInertia {
        /// The first body without inertial.
        frame: String,
        /// Number of further bodies without inertial.
        others: usize,
    },
    /// A mesh without volume to compute masses from.
    #[error("mass from the volume of a mesh: {0}")]
    NoVolume(String),
}
