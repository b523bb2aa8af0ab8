//! What is known of a solved path.

use crate::search::Collision;

/// A step in which the arm leaves its branch.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Reconfiguration {
    /// The row of [`q`](PathSolution::q) that it leads to, from the one before; 0 for the step that closes a cyclic path.
    pub index: usize,
    /// The joint that moves furthest, by its place in [`Arm::joints`](crate::Arm::joints).
    pub joint: usize,
    /// How far that moves, radians; a slide by the metres that weigh as much.
    pub distance: f64,
    /// Weighted joint length of the step.
    pub length: f64,
}

/// How far the tool is from the path at most while all joints move evenly from one row to the next, over all steps that are no
/// reconfiguration. Upper bounds, not samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Deviation {
    /// Metres; what the goal leaves free does not count.
    pub metres: f64,
    /// The row that the step leads to in which that is.
    pub metres_at: usize,
    /// Radians.
    pub radians: f64,
    /// The row that the step leads to in which that is.
    pub radians_at: usize,
}

/// A point that the tool does not reach.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Missed {
    /// The row of [`q`](PathSolution::q).
    pub index: usize,
    /// By how much, metres beyond what the goal leaves free.
    pub position_error: f64,
    /// And radians.
    pub orientation_error: f64,
    /// Why.
    pub reason: MissReason,
}

/// Why a point is missed.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum MissReason {
    /// It is farther from where the chain begins than the chain is long: certain.
    BeyondReach {
        /// The distance, metres.
        distance: f64,
        /// The chain's length, metres.
        reach: f64,
    },
    /// The place can be reached, but something touches there; the deepest pair.
    Touches(Collision),
    /// No configuration within the limits was found.
    NotFound,
}

/// A step on which something touches, or comes too near to be told apart from that.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Blocked {
    /// The row of [`q`](PathSolution::q) that it leads to; 0 for the step that closes a cyclic path.
    pub index: usize,
    /// What is in the way.
    pub by: Collision,
}

/// Joints for a whole path.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PathSolution {
    /// One configuration a point, one after another, radians or metres, in the order in which the path is gone. A path that may be
    /// entered anywhere has one more: its first point comes at the end again.
    pub q: Vec<f64>,
    /// Numbers of a configuration.
    pub joint_count: usize,
    /// Which point of the path the first row is for: 0 unless it may be entered anywhere.
    pub entry: usize,
    /// The steps in which the arm leaves its branch: in all others no joint moves further than
    /// [asked](super::PathSolver::with_max_step), or the tool itself goes far and small parts of its way lead there.
    pub reconfigurations: Vec<Reconfiguration>,
    /// Weighted joint length of all steps, those of reconfigurations too: the root of the sum of (weight · difference)², added up.
    pub length: f64,
    /// How far the tool is from the path between the points.
    pub largest_deviation: Deviation,
    /// The points that are not reached, in order.
    pub missed: Vec<Missed>,
    /// The steps that are not surely free, of an arm that keeps clear of something; reconfigurations are none of them, as nothing is
    /// said of how they are made.
    pub blocked: Vec<Blocked>,
}

impl PathSolution {
    /// One configuration a point.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.q.chunks_exact(self.joint_count.max(1))
    }

    /// Whether all points are reached without a reconfiguration, and all steps are free.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.reconfigurations.is_empty() && self.missed.is_empty() && self.blocked.is_empty()
    }
}
