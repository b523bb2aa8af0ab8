//! Errors of reach maps.

use super::super::{ArmError, QueryError};
use kinopt_kinematics::bad_option::BadOption;
use kinopt_kinematics::spatial::RigidDefect;
use thiserror::Error;

/// Error of building, loading or using a reach map.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ReachMapError {
    /// No proofs exist for the arm's chain or goal.
    #[error(
        "a reach map needs an arm of at most eight joints without mimic joints and unlimited prismatic joints, and \
         a goal that is a pose, a position, or a pose with a free rotation about an axis"
    )]
    NoProofs,
    /// An option is out of its range.
    #[error(transparent)]
    Option(#[from] BadOption),
    /// The map would have too many cells.
    #[error(
        "the map would have {cells:.1e} cells, allowed: at most {allowed:.1e}; increase position_step or orientation_step"
    )]
    TooManyCells {
        /// Number of cells of the grid.
        cells: f64,
        /// Largest number.
        allowed: f64,
    },
    /// The part of the map to build does not exist.
    #[error("part {part} of {parts}: expected a number from 0 to {}", parts.saturating_sub(1))]
    Part {
        /// Index of the part.
        part: usize,
        /// Number of parts.
        parts: usize,
    },
    /// The map was built for an arm with other joints.
    #[error(
        "the map was built for another arm: its joints are {}, given: {}",
        expected.join(", "), given.join(", ")
    )]
    OtherJoints {
        /// Joints of the map.
        expected: Vec<String>,
        /// Joints of the given arm.
        given: Vec<String>,
    },
    /// The map was built for an arm with the same joints that differs in another property.
    #[error("the map was built for another arm: the {property} differ")]
    OtherArm {
        /// Property that differs.
        property: &'static str,
    },
    /// Parts to merge have different grids.
    #[error("map {index} has another {property} than the first map")]
    OtherGrid {
        /// Index of the map among those to merge.
        index: usize,
        /// Property that differs.
        property: &'static str,
    },
    /// Two parts to merge contain the same cube, or there are no parts.
    #[error("maps to merge must be different parts of one map, and at least one")]
    NotParts,
    /// Arrays of a map do not fit together.
    #[error("damaged reach map: `{array}` {problem}")]
    Damaged {
        /// Name of the array.
        array: &'static str,
        /// Defect.
        problem: &'static str,
    },
    /// A candidate placement of a base is not a rigid motion.
    #[error("base {index}: {problem}")]
    Base {
        /// Index among the candidates.
        index: usize,
        /// Defect of the placement.
        problem: RigidDefect,
    },
    /// The arm could not be changed for the search.
    #[error(transparent)]
    Arm(#[from] ArmError),
    /// A query is invalid.
    #[error(transparent)]
    Query(#[from] QueryError),
}
