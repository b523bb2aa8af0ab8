//! Options of an arm, for all of its queries.

use std::time::Duration;

use super::{ArmError, PoseBounds};
use kinopt_kinematics::bad_option::{
    AT_LEAST_0, AT_LEAST_ONE, BadOption, NOT_NEGATIVE, POSITIVE, Range,
};

/// Preference among several solutions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Search {
    /// The result of the attempt from the start, if it reaches the target; for continuity. The default.
    ///
    /// Other attempts are made only if it fails; the lowest that reaches the target counts. If none does, the result is
    /// the closest pose reached from the start.
    ///
    /// For a target within 1 rad of the tool at the start, the attempt from the start runs to its end first. Metres are
    /// divided by [`with_metres_per_radian`](super::ArmBuilder::with_metres_per_radian). The result is then that of
    /// [`with_attempts(1)`](super::ArmBuilder::with_attempts) if that reaches. For a target farther away the attempt
    /// fails as soon as it stalls.
    #[default]
    Start,
    /// The solution that takes the fewest iterations. If none is found, the result is the best of all attempts.
    First,
    /// The solution nearest to the start in weighted joint distance.
    ///
    /// For six revolute joints and a full pose it is the nearest of the [complete set](super::Arm::solve_all), for other
    /// arms the nearest among many attempts. For a redundant arm it is then moved towards the start within the null space. It is never farther away than the
    /// solution of the attempt from the start. If a time limit cuts the comparison short, the solution ends as
    /// [`TimeLimit`](kinopt_solver::solver::Termination::TimeLimit).
    Nearest,
}

impl Search {
    /// Preference of the SIMD solver for its attempts.
    pub(super) fn preference(self) -> crate::simd_ik::Prefer {
        match self {
            Self::First => crate::simd_ik::Prefer::First,
            _ => crate::simd_ik::Prefer::Start,
        }
    }

    /// Returns true if the search compares many attempts.
    pub(super) fn compares(self) -> bool {
        self == Self::Nearest
    }
}

/// Default largest number of attempts of a query.
pub(super) const ATTEMPTS: u32 = 200;
/// Default number of iterations of all attempts of a query after which no attempt begins.
const ITERATIONS: u32 = 2600;
/// Default strength of limit avoidance while following, radians.
const LIMIT_AVOIDANCE: f64 = 4.0;
/// Default weight of a radian, as a fraction of the arm's reach.
const RADIAN_PER_REACH: f64 = 0.25;

/// Default weight of a radian for an arm of this reach, both in metres.
fn metres_per_radian(reach: f64) -> f64 {
    if reach > 0.0 && reach.is_finite() {
        RADIAN_PER_REACH * reach
    } else {
        1.0
    }
}

/// Options of an arm.
#[derive(Clone, Debug)]
pub(super) struct Options {
    pub(super) position_tolerance: f64,
    pub(super) orientation_tolerance: f64,
    pub(super) metres_per_radian: f64,
    /// As given; the default depends on the arm's reach.
    pub(super) given_metres_per_radian: Option<f64>,
    pub(super) goal: PoseBounds,
    pub(super) search: Search,
    /// One weight per joint.
    pub(super) weights: Vec<f64>,
    /// One bound per joint, or none.
    pub(super) max_move: Option<Vec<f64>>,
    pub(super) posture: Option<Vec<f64>>,
    pub(super) attempts: u32,
    /// As given; `None` for the default.
    pub(super) iterations: Option<u32>,
    /// True if a number of attempts was given.
    pub(super) attempts_given: bool,
    pub(super) global_search_on_failure: bool,
    /// Radians, see [`with_limit_avoidance`](super::ArmBuilder::with_limit_avoidance).
    pub(super) limit_avoidance: f64,
    pub(super) time_limit: Option<Duration>,
    pub(super) seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            position_tolerance: 1e-6,
            orientation_tolerance: 1e-6,
            metres_per_radian: 1.0,
            given_metres_per_radian: None,
            goal: PoseBounds::pose(),
            search: Search::Start,
            weights: Vec::new(),
            max_move: None,
            posture: None,
            attempts: ATTEMPTS,
            iterations: None,
            attempts_given: false,
            global_search_on_failure: false,
            limit_avoidance: LIMIT_AVOIDANCE,
            time_limit: None,
            seed: 0,
        }
    }
}

impl Options {
    /// Checks that every option is in its range, and that options per joint have one number for each of `joints`.
    pub(super) fn check(&self, joints: &[&str]) -> Result<(), ArmError> {
        for (option, value) in [
            ("position_tolerance", self.position_tolerance),
            ("orientation_tolerance", self.orientation_tolerance),
            ("metres_per_radian", self.metres_per_radian),
        ] {
            check(option, &[value], POSITIVE)?;
        }
        check_goal(&self.goal)?;
        check("attempts", &[self.attempts.into()], AT_LEAST_ONE)?;
        let iterations = self.iterations.map_or(1.0, f64::from);
        check("iterations", &[iterations], AT_LEAST_ONE)?;
        check("limit_avoidance", &[self.limit_avoidance], NOT_NEGATIVE)?;
        let check_per_joint = |option, values: &[f64], range| match values.len() == joints.len() {
            true => check(option, values, range),
            false => Err(ArmError::JointCount {
                option,
                given: values.len(),
                joints: joints.iter().map(|&name| name.to_owned()).collect(),
            }),
        };
        check_per_joint("joint_weights", &self.weights, POSITIVE)?;
        if let Some(moves) = &self.max_move {
            check_per_joint("max_move", moves, AT_LEAST_0)?;
        }
        if let Some(posture) = &self.posture {
            check_per_joint("posture", posture, (f64::is_finite, "finite numbers"))?;
            if self.search.compares() {
                return Err(ArmError::Conflict(
                    "a posture applies to the searches `Start` and `First`: `Nearest` selects \
                     by joint displacement",
                ));
            }
        }
        Ok(())
    }

    /// Sets the weight of radians as given, or by the arm's reach in metres.
    pub(super) fn weigh_radians(&mut self, reach: f64) {
        let given = self.given_metres_per_radian;
        self.metres_per_radian = given.unwrap_or_else(|| metres_per_radian(reach));
    }

    /// Number of iterations of all attempts after which no attempt begins.
    pub(super) fn budget(&self) -> u32 {
        match self.iterations {
            Some(iterations) => iterations,
            None if self.attempts_given => u32::MAX,
            None => ITERATIONS,
        }
    }

    /// Returns true if a failed query returns the best of all attempts, on any branch.
    pub(super) fn searches_globally(&self) -> bool {
        self.global_search_on_failure || self.search == Search::First
    }
}

/// Checks the half widths of a goal, and that some component counts.
pub(super) fn check_goal(goal: &PoseBounds) -> Result<(), ArmError> {
    if let Some((_, value)) = goal.invalid_half_width() {
        let allowed = "half widths must be at least 0";
        return check("goal", &[value], (|_| false, allowed));
    }
    match goal.has_position() || goal.has_orientation() {
        true => Ok(()),
        false => {
            let allowed = "at least one component must be constrained";
            check("goal", &[f64::INFINITY], (|_| false, allowed))
        }
    }
}

fn check(option: &'static str, values: &[f64], range: Range) -> Result<(), ArmError> {
    for &value in values {
        BadOption::check(option, value, range)?;
    }
    Ok(())
}
