//! Errors of robot files. Each names the file, the position and the problem.

use thiserror::Error;

use kinopt_kinematics::file::ReadError;
use kinopt_kinematics::model::{ModelError, UnknownName};

/// Result of reading a part of a robot file.
pub(crate) type Read<T> = Result<T, RobotFileError>;

/// Error of reading a robot file.
#[derive(Clone, Debug, Error)]
#[non_exhaustive]
pub enum RobotFileError {
    /// The file cannot be opened, is too long, or is not UTF-8 text.
    #[error(transparent)]
    Unreadable(#[from] ReadError),
    /// The file is not well-formed XML, or it has a document type.
    #[error("{file}: not well-formed XML: {problem}")]
    NotXml {
        /// Path or name as given.
        file: String,
        /// Message of the XML parser, with line and column.
        problem: String,
    },
    /// The file is a xacro macro file. It must be expanded by an external program.
    #[error(
        "{file}:{line}: this is xacro, not URDF: expand it first with `xacro IN > OUT.urdf` (`pip install xacro`; in Python `Robot.from_xacro`)"
    )]
    Xacro {
        /// Path or name as given.
        file: String,
        /// Line of the first macro, from 1.
        line: u32,
    },
    /// An element is invalid.
    #[error("{file}:{line}: {element}: {fault}")]
    Element {
        /// Path or name as given.
        file: String,
        /// Line of the element, from 1.
        line: u32,
        /// The element, such as ``joint `elbow`, <limit>``.
        element: String,
        /// Problem of the element.
        fault: ParseIssue,
    },
    /// The elements do not form a model. Examples: mimic joints that form a cycle or leave their source joint no value,
    /// and numbers outside the range of a model.
    #[error("{file}: {source}")]
    Model {
        /// Path or name as given.
        file: String,
        /// The joint and its problem.
        source: ModelError,
    },
}

/// Problem of an element.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ParseIssue {
    /// The root element is not `<robot>`.
    #[error("the root element must be <robot>")]
    NotARobot,
    /// A geom with contact bits whose type is unsupported; collision checks ignore it.
    #[error("unsupported collision shape `{kind}`: ignored in collision checks")]
    NoShape {
        /// `type` of the geom.
        kind: &'static str,
    },
    /// A geom pair that collision checks ignore.
    #[error("the pair is ignored in collision checks: {why}")]
    PairNotKept {
        /// Reason in words.
        why: &'static str,
    },
    /// The robot has no links.
    #[error("there is no <link>")]
    NoLinks,
    /// A required attribute is missing or empty.
    #[error("attribute `{attribute}` is missing or empty")]
    MissingAttribute {
        /// Name of the attribute.
        attribute: &'static str,
    },
    /// A required child element is missing.
    #[error("<{child}> is missing")]
    MissingElement {
        /// Name of the child element.
        child: &'static str,
    },
    /// An element that may occur once occurs again.
    #[error("<{child}> is given twice")]
    RepeatedElement {
        /// Name of the child element.
        child: &'static str,
    },
    /// An unknown name that is a misspelling of a known one.
    #[error("`{found}` is not known; `{meant}` may be meant")]
    Misspelt {
        /// Name in the file.
        found: String,
        /// Known name that it resembles.
        meant: &'static str,
    },
    /// An attribute does not hold the expected number of finite numbers.
    #[error("attribute `{attribute}` must be {count} finite number(s), not `{text}`")]
    BadNumbers {
        /// Name of the attribute.
        attribute: &'static str,
        /// Expected number of values.
        count: usize,
        /// Text of the attribute.
        text: String,
    },
    /// A joint type outside the standard.
    #[error(
        "joint type `{kind}` is not known; valid types: revolute, continuous, prismatic, fixed, floating, planar, spherical"
    )]
    UnknownJointType {
        /// Type in the file.
        kind: String,
    },
    /// A revolute or prismatic joint without limits.
    #[error(
        "a {kind} joint needs <limit>{}",
        if *kind == "revolute" { "; type `continuous` has none" } else { "" }
    )]
    NoLimits {
        /// `revolute` or `prismatic`.
        kind: &'static str,
    },
    /// A `<geometry>` without a shape of the standard.
    #[error("<geometry> must contain one of box, cylinder, capsule, sphere, mesh")]
    UnknownShape,
    /// The lower limit is above the upper limit.
    #[error("lower limit {lower} is above upper limit {upper}")]
    LimitsOutOfOrder {
        /// In radians or metres.
        lower: f64,
        /// In radians or metres.
        upper: f64,
    },
    /// An axis of zero length.
    #[error("the axis is zero; it must have a direction")]
    NoDirection,
    /// A `quat_xyzw` that is zero, given together with `rpy`, or in a file older than URDF 1.1.
    #[error("attribute `quat_xyzw` {problem}")]
    BadQuaternion {
        /// The problem in words.
        problem: &'static str,
    },
    /// Two links or two joints have the same name.
    #[error("the name is already used on line {first_line}")]
    DuplicateName {
        /// Line of the first use of the name.
        first_line: u32,
    },
    /// The file has no element of the name.
    #[error(transparent)]
    UnknownName(#[from] UnknownName),
    /// A link is the child of two joints.
    #[error("its child link `{link}` is already the child of joint `{other}`")]
    TwoParents {
        /// Name of the link.
        link: String,
        /// Joint that comes first in the file.
        other: String,
    },
    /// Joints form a cycle.
    #[error("the joint is part of a cycle; links and joints must form a tree")]
    Cycle,
    /// Several links have no parent joint.
    #[error("links {} all have no parent joint; a robot has one root", roots.join(", "))]
    SeveralRoots {
        /// Names of the links.
        roots: Vec<String>,
    },
    /// The root element is not `<mujoco>`.
    #[error("the root element must be <mujoco>")]
    NotMujoco,
    /// An attribute has a value outside its list of valid words.
    #[error("attribute `{attribute}` must be {}, not `{word}`", valid.join(" or "))]
    UnknownWord {
        /// Name of the attribute.
        attribute: &'static str,
        /// Value in the file.
        word: String,
        /// Valid values.
        valid: &'static [&'static str],
    },
    /// `eulerseq` is not three of x, y, z, X, Y, Z.
    #[error("attribute `eulerseq` must be three of the letters x, y, z, X, Y, Z, not `{text}`")]
    BadEulerSequence {
        /// Value in the file.
        text: String,
    },
    /// A default class is defined twice, or contains itself.
    #[error("default class `{class}` is already given{}", on_line(*first_line))]
    RepeatedClass {
        /// Name of the class.
        class: String,
        /// Line of the first definition; 0 for the outermost class, which always exists.
        first_line: u32,
    },
    /// A file is included twice, or by itself.
    #[error("`{file}` is included already; a file may be included once")]
    IncludedTwice {
        /// Path of the file.
        file: String,
    },
    /// Elements or includes are nested too deeply.
    #[error("nested more than {limit} levels deep")]
    TooDeep {
        /// Largest nesting depth.
        limit: usize,
    },
    /// More than one of `quat`, `axisangle`, `xyaxes`, `zaxis` and `euler` is given.
    #[error("more than one of quat, axisangle, xyaxes, zaxis, euler is given")]
    SeveralOrientations,
    /// A direction or a rotation has length zero.
    #[error("attribute `{attribute}` has length zero; it must have a direction")]
    ZeroLength {
        /// Name of the attribute.
        attribute: &'static str,
    },
    /// A mass or density of a geom is negative.
    #[error("attribute `{attribute}` is {value}; it must be at least 0")]
    NegativeMass {
        /// Name of the attribute.
        attribute: &'static str,
        /// Value of the attribute.
        value: f64,
    },
    /// `range` without `limited` in a file with `autolimits="false"`.
    #[error("`range` needs `limited` in a file with autolimits=\"false\"")]
    UnsaidLimits,
    /// `range` of a ball joint is not 0 and an angle above 0.
    #[error("the range of a ball joint must be 0 and an angle above 0")]
    BadBallRange,
    /// A free joint is not the only joint of its body, or its body is no child of the world.
    #[error("a free joint must be the only joint of its body, and the body a child of the world")]
    MisplacedFreeJoint,
    /// An unsupported element that creates bodies or joints.
    #[error("<{element}> is not supported: replace it by elements that are")]
    UnsupportedElement {
        /// Name of the element.
        element: String,
    },
    /// An equality is not y = offset + ratio · x between two hinge or slide joints.
    #[error("it must be a linear relation between two hinge or slide joints")]
    NotLinear,
    /// A loop connects to a mocap body.
    #[error("it connects a body to a mocap body: use a task instead")]
    HeldFromOutside,
    /// An equality would couple a joint to two sources, or to itself.
    #[error("joint `{joint}` already has a source joint, or would form a mimic cycle")]
    FollowsAlready {
        /// Name of the joint.
        joint: String,
    },
    /// An equality locks a joint at a value outside its range, radians or metres.
    #[error("joint `{joint}`: locked position {value} is outside [{lower}, {upper}]")]
    StandsOutside {
        /// Name of the joint.
        joint: String,
        /// Value at which the joint is locked.
        value: f64,
        /// Lower limit.
        lower: f64,
        /// Upper limit.
        upper: f64,
    },
    /// Two groups have the same name.
    #[error("group `{group}` is given twice")]
    RepeatedGroup {
        /// Name of the group.
        group: String,
    },
    /// A group contains itself.
    #[error("group `{group}` contains itself")]
    GroupWithinItself {
        /// Name of the group.
        group: String,
    },
    /// A mesh has both `refquat` and a non-uniform scale, which no placement represents.
    #[error("a mesh with refquat must have a uniform scale")]
    UnsupportedMesh,
}

fn on_line(line: u32) -> String {
    match line {
        0 => String::new(),
        line => format!(" on line {line}"),
    }
}
