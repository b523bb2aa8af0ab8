//! What can be wrong with a path, and with what is asked of one.

use thiserror::Error;

use crate::animation::curve::KeyError;
use crate::arm::QueryError;
use crate::bad_option::BadOption;
use crate::spatial::RigidDefect;

/// Why a path cannot be taken or solved. A point out of reach is no error: see [`PathSolution::missed`](super::PathSolution::missed).
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PathError {
    /// No point at all.
    #[error("the path has no points: it needs at least one")]
    Empty,
    /// A point that is not finite or not a rigid motion to 1e-6.
    #[error("point {index} of the path: {problem}")]
    Point {
        /// Which point, from 0.
        index: usize,
        /// What is wrong.
        problem: RigidDefect,
    },
    /// A list that is not as long as the path.
    #[error("{what} has {given} entries, the path has {points} points")]
    Count {
        /// Which list.
        what: &'static str,
        /// Its length.
        given: usize,
        /// Points of the path.
        points: usize,
    },
    /// A time that is not finite or not after the one before.
    #[error(
        "the time of point {index} is {value} s, after {before} s: times rise from point to point"
    )]
    Time {
        /// Which point, from 0.
        index: usize,
        /// Its time, seconds.
        value: f64,
        /// The time before it, seconds.
        before: f64,
    },
    /// Keys that no curve of finite numbers goes through.
    #[error(transparent)]
    Curve(#[from] KeyError),
    /// A tool that there is not.
    #[error("point {index} is for tool {tool}, and there are {tools} tools, counted from 0")]
    Tool {
        /// Which point, from 0.
        index: usize,
        /// Its tool.
        tool: usize,
        /// How many tools there are.
        tools: usize,
    },
    /// Another arm's tool.
    #[error("tool {0} is of an arm with other joints: `Arm::with_tool` makes those of one arm")]
    OtherJoints(usize),
    /// An option out of its range.
    #[error(transparent)]
    Option(#[from] BadOption),
    /// An option that has one number a joint, given another number of them.
    #[error("option {option} has {given} numbers, the arm has {} free joints: {}", joints.len(), joints.join(", "))]
    JointCount {
        /// Which option.
        option: &'static str,
        /// Numbers given.
        given: usize,
        /// The free joints, base to tip.
        joints: Vec<String>,
    },
    /// Limits that are not one a joint.
    #[error("{option} has {given} numbers, the path's rows have {joints}")]
    Limits {
        /// Which limits.
        option: &'static str,
        /// Numbers given.
        given: usize,
        /// Numbers of a row.
        joints: usize,
    },
    /// A limit of one joint that is out of its range.
    #[error("{option} of {joint} is {value}: {allowed}")]
    JointLimit {
        /// Name of the option.
        option: &'static str,
        /// Name of the joint, or its index.
        joint: String,
        /// The value given.
        value: f64,
        /// Allowed values.
        allowed: &'static str,
    },
    /// A step that no acceleration limit bounds.
    #[error(
        "acceleration_limits: {joint} moves to row {row}, and no joint that moves there has a finite limit"
    )]
    Unbounded {
        /// Name of the joint that moves most, or its index.
        joint: String,
        /// The row that the step leads to.
        row: usize,
    },
    /// A row of joint values that is not finite.
    #[error("row {row} of joint values is not finite")]
    Row {
        /// Index of the row.
        row: usize,
    },
    /// A configuration to begin or end with that does not stand at the path's end.
    #[error(
        "the {which} configuration does not stand at the path's {which} point: its tool is {metres:.2e} m and {radians:.2e} rad \
         off (or a joint is beyond its limits, or it touches something)"
    )]
    End {
        /// `start` or `end`.
        which: &'static str,
        /// How far its tool is from that point, metres.
        metres: f64,
        /// How far it is turned from it, radians.
        radians: f64,
    },
    /// Two wishes that do not go together.
    #[error("{0}")]
    Conflict(&'static str),
    /// A question to the arm.
    #[error(transparent)]
    Query(#[from] QueryError),
}
