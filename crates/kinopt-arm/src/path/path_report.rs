//! Report of a path: length, deviation, unreached points and possible collisions.

use crate::arm::JointPath;
use kinopt_solver::search::Collision;

/// Largest deviation of the tool from the path between points, while all joints move at constant rates.
///
/// The values are upper bounds over all steps that are no reconfiguration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Deviation {
    /// Position deviation, metres, beyond the goal bounds.
    pub metres: f64,
    /// Row that the step with the largest position deviation leads to.
    pub metres_at: usize,
    /// Orientation deviation, radians.
    pub radians: f64,
    /// Row that the step with the largest orientation deviation leads to.
    pub radians_at: usize,
}

/// Point that the tool does not reach, or reaches in collision.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Missed {
    /// Row of the joint path.
    pub index: usize,
    /// Position error, metres, beyond the goal bounds.
    pub position_error: f64,
    /// Orientation error, radians, beyond the goal bounds.
    pub orientation_error: f64,
    /// Reason why the point is not reached.
    pub reason: MissReason,
}

/// Reason why a point is not reached.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum MissReason {
    /// The distance from the chain's root exceeds the length of the chain: provably unreachable.
    BeyondReach {
        /// Distance from the root, metres.
        distance: f64,
        /// Length of the chain, metres.
        reach: f64,
    },
    /// The pose can be reached, but in collision; with the deepest pair.
    Touches(Collision),
    /// The search found no configuration within the limits.
    NotFound,
}

/// Step in collision, or too near to a collision to exclude it.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Blocked {
    /// Row that the step leads to; 0 for the step that closes a cyclic path.
    pub index: usize,
    /// Colliding pair.
    pub by: Collision,
}

/// Errors of the joint path of a Cartesian path.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PathReport {
    /// Index of the path point of the first row: 0 unless the path has
    /// [`Traversal::AnyStart`](super::Traversal::AnyStart).
    pub entry: usize,
    /// Weighted joint length of all steps, including reconfigurations: the sum of the roots of Σ (weight ·
    /// difference)².
    pub length: f64,
    /// Largest deviation of the tool from the path between the points.
    pub largest_deviation: Deviation,
    /// Unreached points, in order.
    pub missed: Vec<Missed>,
    /// Steps that are not provably collision-free, for an arm with collision avoidance. Reconfigurations are not
    /// checked.
    pub blocked: Vec<Blocked>,
}

impl JointPath<PathReport> {
    /// Returns true if all points are reached without reconfigurations, and all steps are collision-free.
    #[must_use]
    pub fn reached(&self) -> bool {
        let report = &self.report;
        self.jumps.is_empty() && report.missed.is_empty() && report.blocked.is_empty()
    }
}
