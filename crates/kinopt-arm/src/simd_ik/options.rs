//! Options, outcome and errors of the SIMD solver.

use super::axis_goal::AxisGoal;
use super::chain::MAX_JOINTS;
use kinopt_kinematics::bad_option::{BadOption, POSITIVE};

/// Preference among several solutions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Prefer {
    /// The solution from the start, if that attempt succeeds; further attempts count only if it fails.
    #[default]
    Start,
    /// The solution that takes the fewest iterations; attempts begin with the atlas's configurations.
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
    /// Distance of the tool from the target at the start, in radians, below which only the first attempt is made.
    ///
    /// Metres convert by `metres_per_radian`. Applies to [`Prefer::Start`]; the caller continues a failed attempt. 0
    /// disables it.
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
    /// Sets the largest distance of the tip from the target, metres; positive. Default 1e-6.
    #[must_use]
    pub fn with_position_tolerance(mut self, position_tolerance: f64) -> Self {
        self.position_tolerance = position_tolerance;
        self
    }

    /// Sets the largest angle between the tip and the target, radians; positive. Default 1e-6.
    #[must_use]
    pub fn with_orientation_tolerance(mut self, orientation_tolerance: f64) -> Self {
        self.orientation_tolerance = orientation_tolerance;
        self
    }

    /// Sets the metres that weigh as much as one radian in the cost; positive. Default 0.3.
    #[must_use]
    pub fn with_metres_per_radian(mut self, metres_per_radian: f64) -> Self {
        self.metres_per_radian = metres_per_radian;
        self
    }

    /// Sets the weights and dead bands of the pose's components. Default: the full pose.
    #[must_use]
    pub fn with_axes(mut self, axes: AxisGoal) -> Self {
        self.axes = axes;
        self
    }

    /// Sets the initial damping: λ starts at this factor times twice the cost; positive. Default 0.07.
    #[must_use]
    pub fn with_damping(mut self, damping: f64) -> Self {
        self.damping = damping;
        self
    }

    /// Sets the number of iterations without halving the error after which an attempt ends. Default 6.
    ///
    /// It is ten times as large while twice the cost is below 1e-6 of the chain's reach squared.
    #[must_use]
    pub fn with_stall_limit(mut self, stall_limit: u32) -> Self {
        self.stall_limit = stall_limit;
        self
    }

    /// Sets the largest number of iterations of one attempt. Default 100.
    #[must_use]
    pub fn with_iterations(mut self, iterations: u32) -> Self {
        self.iterations = iterations;
        self
    }

    /// Sets the largest number of attempts of one query, at least 1. Default 200.
    #[must_use]
    pub fn with_attempts(mut self, attempts: u32) -> Self {
        self.attempts = attempts;
        self
    }

    /// Sets the number of iterations of all attempts of a query after which no attempt begins. Default 3 000.
    ///
    /// It bounds the time for targets at the end of a narrow valley: an arm nearly stretched, a joint at its limit.
    #[must_use]
    pub fn with_total_iterations(mut self, total_iterations: u32) -> Self {
        self.total_iterations = total_iterations;
        self
    }

    /// Sets the seed of the atlas and of the random attempts: attempt i is sampled from (seed, i). Default 0.
    #[must_use]
    pub fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// Sets whether to build the seed atlas, which makes several times fewer iterations. Default true.
    ///
    /// The atlas takes a few megabytes, and tens of milliseconds to build. Chains of fewer than 4 or more than 12
    /// joints have none.
    #[must_use]
    pub fn with_atlas(mut self, atlas: bool) -> Self {
        self.atlas = atlas;
        self
    }

    /// Sets whether to use the portable kernels even if the processor has faster instructions. Default false.
    #[must_use]
    pub fn with_portable(mut self, portable: bool) -> Self {
        self.portable = portable;
        self
    }

    /// Checks that every number is in its range.
    ///
    /// # Errors
    /// Returns [`LaneError::Option`] with the name of an option out of range.
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

/// Outcome of a query.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct PoseOutcome {
    /// True if both errors are within their tolerances.
    pub reached: bool,
    /// Distance of the tip from the target at the returned q, metres.
    pub position_error: f64,
    /// Angle between tip and target at the returned q, radians.
    pub orientation_error: f64,
    /// Iterations of all attempts together.
    pub iterations: u32,
    /// Number of attempts begun.
    pub attempts: u32,
    /// Number of the attempt that reached the target, from 0 over all attempts of the query; `None` if none did.
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

/// Error of joints that do not form a [`Chain`](super::Chain), or of a call with invalid arguments.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LaneError {
    /// An option is out of its range.
    #[error(transparent)]
    Option(#[from] BadOption),
    /// A slice has another length than the chain and the number of targets require.
    #[error("{what} has {found} numbers, expected {expected}")]
    Length {
        /// Name of the argument.
        what: &'static str,
        /// Length of the argument.
        found: usize,
        /// Length that it must have.
        expected: usize,
    },
    /// Joint values are not finite.
    #[error("{0} is not finite")]
    NotFinite(&'static str),
    /// The start of a query, by its index, is not finite.
    #[error("the start of query {0} is not finite")]
    Start(usize),
    /// A target, by its index, is not finite or its rotation is not orthonormal to 1e-6.
    #[error("target {0} is not a rigid placement")]
    Target(usize),
    /// The number of moving joints is not between 1 and [`MAX_JOINTS`].
    #[error("a chain has 1 to {MAX_JOINTS} moving joints, not {0}")]
    ChainLength(usize),
    /// The joint is fixed, or a ball joint. A fixed joint belongs into the placement of the next one.
    #[error("joint {0} of the chain is fixed")]
    FixedJoint(usize),
    /// The axis is zero or not finite.
    #[error("joint {0} of the chain: the axis is zero or not finite")]
    Axis(usize),
    /// The bounds are NaN, crossed, or leave no finite value.
    #[error("joint {joint} of the chain: bounds [{lower}, {upper}] are not an interval")]
    Bounds {
        /// Index of the joint, from 0 at the base.
        joint: usize,
        /// Lower bound, radians or metres.
        lower: f64,
        /// Upper bound, radians or metres.
        upper: f64,
    },
    /// The placement is not finite, or its rotation is not orthonormal to 1e-6.
    #[error("placement {0} of the chain (the tip's is last) is not a rigid motion")]
    Placement(usize),
}
