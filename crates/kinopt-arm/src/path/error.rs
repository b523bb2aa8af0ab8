//! Errors of paths and path solvers.

use thiserror::Error;

use crate::arm::QueryError;
use kinopt_kinematics::bad_option::BadOption;
use kinopt_kinematics::curve::KeyError;
use kinopt_kinematics::spatial::RigidDefect;

/// Reason why a path cannot be created, solved or timed.
///
/// An unreachable point is not an error: see [`PathReport::missed`](super::PathReport::missed).
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PathError {
    /// The path has no points.
    #[error("the path has no points: it needs at least one")]
    Empty,
    /// A point is not finite or not rigid to 1e-6.
    #[error("point {index} of the path: {problem}")]
    Point {
        /// Index of the point.
        index: usize,
        /// Reason why it is invalid.
        problem: RigidDefect,
    },
    /// A list and the path have different lengths.
    #[error("{what} has {given} entries, the path has {points} points")]
    Count {
        /// Name of the list.
        what: &'static str,
        /// Length of the list.
        given: usize,
        /// Number of points of the path.
        points: usize,
    },
    /// A time is not finite or not after the previous one.
    #[error("the time of point {index} is {value} s, after {before} s: times must increase")]
    Time {
        /// Index of the point.
        index: usize,
        /// Time of the point, seconds.
        value: f64,
        /// Time of the previous point, seconds.
        before: f64,
    },
    /// The keys do not define a finite curve.
    #[error(transparent)]
    Curve(#[from] KeyError),
    /// The tool does not exist.
    #[error("point {index} is for tool {tool}: there are {tools} tools, counted from 0")]
    Tool {
        /// Index of the point.
        index: usize,
        /// Tool index of the point.
        tool: usize,
        /// Number of tools.
        tools: usize,
    },
    /// A tool belongs to an arm with other joints.
    #[error("tool {0} is of an arm with other joints: create tools by `Arm::with_tool`")]
    OtherJoints(usize),
    /// An option is out of its range.
    #[error(transparent)]
    Option(#[from] BadOption),
    /// An option with one number per joint has the wrong length.
    #[error("option {option} has {given} numbers, expected {}, one for each free joint: {}", joints.len(), joints.join(", "))]
    JointCount {
        /// Name of the option.
        option: &'static str,
        /// Number of given values.
        given: usize,
        /// Names of the free joints, base to tip.
        joints: Vec<String>,
    },
    /// Limits with one number per joint have the wrong length.
    #[error("{option} has {given} numbers, the path's rows have {joints}")]
    Limits {
        /// Name of the limits.
        option: &'static str,
        /// Number of given values.
        given: usize,
        /// Length of a row.
        joints: usize,
    },
    /// A limit of one joint is out of its range.
    #[error("{option} of {joint} is {value}, expected {allowed}")]
    JointLimit {
        /// Name of the option.
        option: &'static str,
        /// Name of the joint, or its index.
        joint: String,
        /// Given value.
        value: f64,
        /// Allowed values.
        allowed: &'static str,
    },
    /// A step is not bounded by any acceleration limit.
    #[error(
        "acceleration_limits: {joint} moves to row {row}, but no joint of that step has a finite limit: \
         set acceleration limits of the joints, such as 5 (rad/s² or m/s²)"
    )]
    Unbounded {
        /// Name of the joint that moves most, or its index.
        joint: String,
        /// Index of the row that the step leads to.
        row: usize,
    },
    /// A row of joint values is not finite.
    #[error("row {row} of joint values is not finite")]
    Row {
        /// Index of the row.
        row: usize,
    },
    /// Rows are not reached, or their steps are not proven collision-free.
    #[error(
        "{count} of {rows} rows are not reached, or the step to them is not proven collision-free, the first is row \
         {first}: change the path, or allow them by `allow_unreached`; missed points and blocked steps of the path have \
         the reasons"
    )]
    Unreached {
        /// Number of unreached rows.
        count: usize,
        /// Number of rows.
        rows: usize,
        /// Index of the first unreached row.
        first: usize,
    },
    /// The points are positions, but the arm's goal bounds the orientation.
    #[error(
        "the path has positions without orientations, but the arm's goal bounds the orientation: give the arm the \
         goal \"position\", or the points orientations"
    )]
    NoOrientations,
    /// A path with times or tools of its points is extended.
    #[error("a path with times or tools cannot be extended: set them after the last segment")]
    Extended,
    /// Start, via and end position of an arc are on one line.
    #[error("start, via and end position of the arc are on one line: move the via position off it")]
    StraightArc,
    /// An even number of points does not define arcs.
    #[error(
        "arcs through {0} points: an odd number is needed, because each arc has a via position and an end"
    )]
    ArcKeys(usize),
    /// The given start or end configuration does not reach the path's first or last point.
    #[error(
        "the {which} configuration does not reach the path's {which} point: its tool is {metres:.2e} m and \
         {radians:.2e} rad off (or a joint is outside its limits, or the arm is in collision)"
    )]
    End {
        /// Either `start` or `end`.
        which: &'static str,
        /// Distance of the tool from the point, metres.
        metres: f64,
        /// Rotation of the tool from the point, radians.
        radians: f64,
    },
    /// Options exclude each other.
    #[error("{0}")]
    Conflict(&'static str),
    /// A query to the arm failed.
    #[error(transparent)]
    Query(#[from] QueryError),
}
