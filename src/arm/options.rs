//! What an arm is told once, for all questions.

use std::time::Duration;

use super::Goal;

/// Which of several solutions is wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Search {
    /// The one that the start's own attempt comes to, if it succeeds; others only rescue it, the
    /// lowest that reaches first. A target that none reaches is answered by the nearest place on the
    /// start's own way. For continuity. The default.
    #[default]
    Start,
    /// Whichever takes the fewest iterations. A target that none reaches is answered by the best of
    /// all attempts, wherever that is.
    First,
    /// The one nearest to the start in weighted joint distance, among many attempts; on redundant
    /// arms it is then moved towards the start within the null space. Where a time limit cuts the
    /// comparison short the solution says [`TimeLimit`](crate::solver::Termination::TimeLimit).
    Nearest,
    /// Up to `k` solutions, nearest to the start first, any two farther apart than `distance`. A
    /// time limit is told as for the nearest.
    Distinct {
        /// Most solutions wanted, at least 1.
        k: usize,
        /// Weighted joint distance that two solutions must exceed: the root of the sum of
        /// (weight · difference)², in radians for weights of 1. At least 0.
        distance: f64,
    },
}

impl Search {
    /// The engine's search, for one attempt after another.
    pub(super) fn lanes(self) -> crate::lanes::Search {
        match self {
            Self::First => crate::lanes::Search::First,
            _ => crate::lanes::Search::Start,
        }
    }

    /// Whether many attempts are compared.
    pub(super) fn compares(self) -> bool {
        matches!(self, Self::Nearest | Self::Distinct { .. })
    }
}

/// Attempts of a question for which nothing else is asked, and the iterations of all together.
pub(super) const ATTEMPTS: u32 = 200;
const ITERATIONS: u32 = 2600;
/// How strongly joints are drawn away from their limits while following.
pub(super) const LIMIT_AVOIDANCE: f64 = 4.0;
/// A radian counts as much as this share of the arm's reach.
const RADIAN_PER_REACH: f64 = 0.25;

/// The default weight of a radian for an arm of this reach, both in metres.
pub(super) fn metres_per_radian(reach: f64) -> f64 {
    if reach > 0.0 && reach.is_finite() {
        RADIAN_PER_REACH * reach
    } else {
        1.0
    }
}

/// All options, checked.
#[derive(Clone, Debug)]
pub(super) struct Options {
    pub(super) position_tolerance: f64,
    pub(super) orientation_tolerance: f64,
    pub(super) metres_per_radian: f64,
    /// As given; without it the default goes by the arm's length.
    pub(super) given_metres_per_radian: Option<f64>,
    pub(super) goal: Goal,
    pub(super) search: Search,
    /// One a joint.
    pub(super) weights: Vec<f64>,
    /// One a joint, or none.
    pub(super) max_move: Option<Vec<f64>>,
    pub(super) posture: Option<Vec<f64>>,
    pub(super) attempts: u32,
    /// What was asked for.
    pub(super) iterations: Option<u32>,
    pub(super) attempts_asked: bool,
    pub(super) leaps: bool,
    /// Radians a radian of path.
    pub(super) limit_avoidance: f64,
    pub(super) time_limit: Option<Duration>,
    pub(super) seed: u64,
}

impl Options {
    /// Iterations of all attempts together after which none begins.
    pub(super) fn budget(&self) -> u32 {
        match self.iterations {
            Some(iterations) => iterations,
            None if self.attempts_asked => u32::MAX,
            None => ITERATIONS,
        }
    }

    /// Whether a miss is answered by the best of all attempts, wherever that is.
    pub(super) fn leaps_on_miss(&self) -> bool {
        self.leaps || self.search == Search::First
    }
}
