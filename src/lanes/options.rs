//! A solver's options, what it answers, and what can be wrong with a call.

use super::axis_goal::AxisGoal;
use crate::bad_option::{BadOption, POSITIVE};

/// Which of several solutions is wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Prefer {
    /// The one from the start, if that attempt succeeds; others only rescue it.
    #[default]
    Start,
    /// Whichever takes the fewest iterations: the atlas's seeds come first.
    First,
}

/// Options of a [`PoseSolver`](super::PoseSolver).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LaneOptions {
    pub(crate) position_tolerance: f64,
    pub(crate) orientation_tolerance: f64,
    pub(crate) metres_per_radian: f64,
    pub(crate) axes: AxisGoal,
    pub(crate) damping: f64,
    pub(crate) stall_limit: u32,
    pub(crate) iterations: u32,
    pub(crate) attempts: u32,
    pub(crate) total_iterations: u32,
    pub(crate) seed: u64,
    pub(crate) atlas: bool,
    pub(crate) portable: bool,
    /// Distance between the tool at the start and a target, radians (metres by `metres_per_radian`), below which the first
    /// attempt alone is made under [`Prefer::Start`]: the caller continues it where it misses. 0 for none.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) nearby: f64,
}

impl Default for LaneOptions {
    fn default() -> Self {
        Self {
            position_tolerance: 1e-6,
            orientation_tolerance: 1e-6,
            metres_per_radian: 0.3,
            axes: AxisGoal::full_pose(),
            damping: 0.07,
            stall_limit: 6,
            iterations: 100,
            attempts: 200,
            total_iterations: 3000,
            seed: 0,
            atlas: true,
            portable: false,
            nearby: 0.0,
        }
    }
}

impl LaneOptions {
    setters! {
        /// How far the tip may be from the target, metres; positive. Default 1e-6.
        pub fn with_position_tolerance(mut self, position_tolerance: f64) { self.position_tolerance = position_tolerance }
        /// How far the tip may be turned from the target, radians; positive. Default 1e-6.
        pub fn with_orientation_tolerance(mut self, orientation_tolerance: f64) { self.orientation_tolerance = orientation_tolerance }
        /// Metres that weigh as much as one radian in the cost; positive. Default 0.3.
        pub fn with_metres_per_radian(mut self, metres_per_radian: f64) { self.metres_per_radian = metres_per_radian }
        /// Which components of the pose count. Default all.
        pub fn with_axes(mut self, axes: AxisGoal) { self.axes = axes }
        /// Levenberg-Marquardt's λ at the start of an attempt is this times twice the cost. Default 0.07.
        pub fn with_damping(mut self, damping: f64) { self.damping = damping }
        /// An attempt whose error has not halved in this many iterations is given up, ten
        /// times as many where twice the cost is below 1e-6 of the chain's reach squared. Default 6.
        pub fn with_stall_limit(mut self, stall_limit: u32) { self.stall_limit = stall_limit }
        /// Most iterations of one attempt. Default 100.
        pub fn with_iterations(mut self, iterations: u32) { self.iterations = iterations }
        /// Most attempts of one query, at least 1. Default 200.
        pub fn with_attempts(mut self, attempts: u32) { self.attempts = attempts }
        /// No attempt begins after so many iterations of all attempts of a query together. Goals at the
        /// end of a narrow valley (an arm nearly stretched, a joint on its limit) would otherwise take
        /// ten times as many as others that are out of reach. Default 3 000.
        pub fn with_total_iterations(mut self, total_iterations: u32) { self.total_iterations = total_iterations }
        /// Seed of the atlas and of the random attempts: attempt i begins from (seed, i). Default 0.
        pub fn with_seed(mut self, seed: u64) { self.seed = seed }
        /// Whether to build the seed atlas: a few megabytes and tens of milliseconds, and several times
        /// fewer iterations. Chains of fewer than 4 or more than 12 joints have none. Default true.
        pub fn with_atlas(mut self, atlas: bool) { self.atlas = atlas }
        /// Whether to use the portable kernels even where faster instructions are there: for comparing
        /// them. Default false.
        pub fn with_portable(mut self, portable: bool) { self.portable = portable }
    }

    /// Whether every number is in its range.
    ///
    /// # Errors
    /// [`LaneError::Option`] with the name of one that is not.
    pub(crate) fn check(&self) -> Result<(), LaneError> {
        for (name, value) in [
            ("position_tolerance", self.position_tolerance),
            ("orientation_tolerance", self.orientation_tolerance),
            ("metres_per_radian", self.metres_per_radian),
            ("damping", self.damping),
        ] {
            BadOption::check(name, value, POSITIVE)?;
        }
        Ok(self.axes.check()?)
    }
}

/// How a query ended.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct PoseOutcome {
    /// Whether both errors are within their tolerances.
    pub reached: bool,
    /// Distance of the tip from the target at the returned q, metres.
    pub position_error: f64,
    /// Angle between tip and target at the returned q, radians.
    pub orientation_error: f64,
    /// Iterations of all attempts together.
    pub iterations: u32,
    /// Attempts begun.
    pub attempts: u32,
    /// The attempt whose q this is, when it reached, counted from 0 over all that were begun for the question.
    pub winner: Option<u32>,
}

impl PoseOutcome {
    /// The outcome of an attempt that was not begun.
    pub(super) const NOT_BEGUN: Self = Self {
        reached: false,
        position_error: f64::INFINITY,
        orientation_error: f64::INFINITY,
        iterations: 0,
        attempts: 0,
        winner: None,
    };
}

/// What is wrong with a call.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LaneError {
    /// An option out of its range.
    #[error(transparent)]
    Option(#[from] BadOption),
    /// A slice of another length than the chain and the number of targets ask for.
    #[error("{what} holds {found} numbers, {expected} are needed")]
    Length {
        /// Which argument.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length it must have.
        expected: usize,
    },
    /// Joint values that are not finite.
    #[error("{0} is not finite")]
    NotFinite(&'static str),
    /// A start that is not finite.
    #[error("the start of query {0} is not finite")]
    Start(usize),
    /// A target that is not finite or whose rotation is not orthonormal to 1e-6.
    #[error("target {0} is not a rigid placement")]
    Target(usize),
}
