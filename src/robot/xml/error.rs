//! What can be wrong with a URDF file, each naming the file, the place and the problem.

use thiserror::Error;

use crate::file::ReadError;
use crate::model::{ModelError, UnknownName};

/// What is read of a robot's file, or why it gives no robot.
pub(crate) type Read<T> = Result<T, RobotFileError>;

/// Why a URDF file gives no robot.
#[derive(Clone, Debug, Error)]
#[non_exhaustive]
pub enum RobotFileError {
    /// The file cannot be opened, is too long, or is not UTF-8 text.
    #[error(transparent)]
    Unreadable(#[from] ReadError),
    /// Not well-formed XML, or XML with a document type, which URDF has no use for.
    #[error("{file}: not well-formed XML: {problem}")]
    NotXml {
        /// The path or name as given.
        file: String,
        /// What the XML parser said, with line and column.
        problem: String,
    },
    /// A macro file, which only becomes URDF by running a program; this library runs none.
    #[error(
        "{file}:{line}: this is xacro, not URDF: expand it first, for example with `xacro IN > OUT.urdf`"
    )]
    Xacro {
        /// The path or name as given.
        file: String,
        /// Where the first macro stands, from 1.
        line: u32,
    },
    /// An element is wrong.
    #[error("{file}:{line}: {element}: {fault}")]
    Element {
        /// The path or name as given.
        file: String,
        /// Where the element starts, from 1.
        line: u32,
        /// The element, such as ``joint `elbow`, <limit>``.
        element: String,
        /// What is wrong with it.
        fault: Fault,
    },
    /// The parts are well-formed but do not make a model: mimic joints that follow in a ring or
    /// leave their master no value, numbers beyond what a model takes.
    #[error("{file}: {source}")]
    Model {
        /// The path or name as given.
        file: String,
        /// The joint and its problem.
        source: ModelError,
    },
}

/// What is wrong with one element.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Fault {
    /// The document's element is not `<robot>`.
    #[error("the root element must be <robot>")]
    NotARobot,
    /// A geom that touches other things, but is none of the shapes there are.
    #[error("a {kind} is not among the shapes that count, so nothing is kept from it")]
    NoShape {
        /// Its `type`.
        kind: &'static str,
    },
    /// A pair of geoms that touch, which is not kept.
    #[error("the pair is not kept apart: {why}")]
    PairNotKept {
        /// In words.
        why: &'static str,
    },
    /// A robot without links.
    #[error("there is no <link>")]
    NoLinks,
    /// A required attribute is missing or empty.
    #[error("attribute `{attribute}` is missing or empty")]
    MissingAttribute {
        /// The attribute.
        attribute: &'static str,
    },
    /// A required child element is missing.
    #[error("<{child}> is missing")]
    MissingElement {
        /// The child element.
        child: &'static str,
    },
    /// An element that may stand once stands twice.
    #[error("<{child}> is given twice")]
    RepeatedElement {
        /// The child element.
        child: &'static str,
    },
    /// An unknown name that is nearly a known one, which would silently count for nothing.
    #[error("`{found}` is not known; `{meant}` may be meant")]
    Misspelt {
        /// The name in the file.
        found: String,
        /// The name it resembles.
        meant: &'static str,
    },
    /// An attribute that does not hold the right count of finite numbers.
    #[error("attribute `{attribute}` must be {count} finite number(s), not `{text}`")]
    BadNumbers {
        /// The attribute.
        attribute: &'static str,
        /// How many numbers it takes.
        count: usize,
        /// What the file says.
        text: String,
    },
    /// A joint type outside the standard.
    #[error(
        "joint type `{kind}` is not known; valid types: revolute, continuous, prismatic, fixed, floating, planar, spherical"
    )]
    UnknownJointType {
        /// The type in the file.
        kind: String,
    },
    /// A revolute or prismatic joint whose limits are not stated.
    #[error(
        "a {kind} joint needs <limit>{}",
        if *kind == "revolute" { "; one that turns without end is `continuous`" } else { "" }
    )]
    NoLimits {
        /// revolute or prismatic.
        kind: &'static str,
    },
    /// A `<geometry>` without a body that the standard knows.
    #[error("<geometry> holds none of box, cylinder, capsule, sphere, mesh")]
    UnknownShape,
    /// Limits out of order.
    #[error("lower limit {lower} is above upper limit {upper}")]
    LimitsOutOfOrder {
        /// In radians or metres.
        lower: f64,
        /// In radians or metres.
        upper: f64,
    },
    /// An axis of zero length.
    #[error("the axis is zero and has no direction")]
    NoDirection,
    /// A quaternion of zero length, beside `rpy`, or in a file older than URDF 1.1.
    #[error("attribute `quat_xyzw` {problem}")]
    BadQuaternion {
        /// Which of these it is.
        problem: &'static str,
    },
    /// Two links or two joints of one name.
    #[error("the name is already used on line {first_line}")]
    DuplicateName {
        /// Where the name was used first.
        first_line: u32,
    },
    /// A link or joint that is not in the file.
    #[error(transparent)]
    UnknownName(#[from] UnknownName),
    /// A link that two joints carry.
    #[error("its child link `{link}` already hangs on joint `{other}`")]
    TwoParents {
        /// The link.
        link: String,
        /// The joint that came first.
        other: String,
    },
    /// Joints that form a ring.
    #[error("the joint is part of a ring: following parents from it comes back to it")]
    Cycle,
    /// More than one link without a parent.
    #[error("links {} all have no parent joint; a robot has one root", roots.join(", "))]
    SeveralRoots {
        /// The links.
        roots: Vec<String>,
    },
    /// The document's element is not `<mujoco>`.
    #[error("the root element must be <mujoco>")]
    NotMujoco,
    /// A word where the format knows others.
    #[error("attribute `{attribute}` must be {}, not `{word}`", valid.join(" or "))]
    UnknownWord {
        /// The attribute.
        attribute: &'static str,
        /// What the file says.
        word: String,
        /// What it may say.
        valid: &'static [&'static str],
    },
    /// `eulerseq` that is not three of x, y, z, X, Y, Z.
    #[error("attribute `eulerseq` must be three of the letters x, y, z, X, Y, Z, not `{text}`")]
    BadEulerSequence {
        /// What the file says.
        text: String,
    },
    /// A class of defaults that is given twice, or stands within itself.
    #[error("default class `{class}` is already given{}", on_line(*first_line))]
    RepeatedClass {
        /// The class.
        class: String,
        /// Where it was given first; 0 for the outermost, which is there unasked.
        first_line: u32,
    },
    /// A file that is included twice, or by itself.
    #[error("`{file}` is included already; a file may be once")]
    IncludedTwice {
        /// The file.
        file: String,
    },
    /// Elements within elements, or files included by included files, without an end in sight.
    #[error("it is nested more than {limit} deep")]
    TooDeep {
        /// The most that is read.
        limit: usize,
    },
    /// More than one of `quat`, `axisangle`, `xyaxes`, `zaxis` and `euler`.
    #[error("more than one of quat, axisangle, xyaxes, zaxis, euler is given")]
    SeveralOrientations,
    /// A direction or rotation of length zero.
    #[error("attribute `{attribute}` is of length zero and says no direction")]
    ZeroLength {
        /// The attribute.
        attribute: &'static str,
    },
    /// A geom's mass or density below zero.
    #[error("attribute `{attribute}` is {value}; it must be at least 0")]
    NegativeMass {
        /// Which attribute.
        attribute: &'static str,
        /// What it says.
        value: f64,
    },
    /// `range` without `limited`, in a file that says `autolimits="false"`.
    #[error("`range` is given without `limited`, and the file says autolimits=\"false\"")]
    UnsaidLimits,
    /// A ball joint's `range` that is not 0 and an angle above it.
    #[error("a ball's range must be 0 and an angle above 0")]
    BadBallRange,
    /// A free joint beside others, or of a body that another carries.
    #[error("a free joint must be the only one of a body, and the body stand in the world")]
    MisplacedFreeJoint,
    /// An element that makes bodies or joints in a way that is not read.
    #[error("<{element}> is not read: write out what it stands for")]
    UnsupportedElement {
        /// The element.
        element: String,
    },
    /// What is no relation y = offset + ratio · x between two joints that turn or slide.
    #[error("it is no linear relation between two joints that turn about or slide along one axis")]
    NotLinear,
    /// A loop to a body that is moved from outside.
    #[error("it holds a body to a mocap body, which a program moves: ask for that by a task")]
    HeldFromOutside,
    /// A relation that would let a joint follow two others, or itself.
    #[error("joint `{joint}` already follows another, or this one follows it")]
    FollowsAlready {
        /// The joint.
        joint: String,
    },
    /// A relation that has a joint stand where its range does not let it, in radians or metres.
    #[error("joint `{joint}` should stand at {value}, outside its range from {lower} to {upper}")]
    StandsOutside {
        /// The joint.
        joint: String,
        /// Where.
        value: f64,
        /// Where its range begins.
        lower: f64,
        /// Where it ends.
        upper: f64,
    },
    /// Two groups of one name.
    #[error("group `{group}` is given twice")]
    RepeatedGroup {
        /// The group.
        group: String,
    },
    /// A group that contains itself.
    #[error("group `{group}` is within itself")]
    GroupWithinItself {
        /// The group.
        group: String,
    },
    /// A mesh whose own frame and scale do not go with a plain placement.
    #[error("the mesh's refquat and an uneven scale do not go together")]
    UnsupportedMesh,
}

fn on_line(line: u32) -> String {
    match line {
        0 => String::new(),
        line => format!(" on line {line}"),
    }
}
