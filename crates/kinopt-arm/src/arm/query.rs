//! Query of an arm, and the attempts that its options allow.

use super::arm::Arm;
use crate::simd_ik::{self, PoseSolver};
use kinopt_kinematics::clock::{Instant, is_past};
use kinopt_kinematics::spatial::{Placement, Vector3};
use kinopt_solver::problem::Anchor;

/// Iterations of the SIMD solver after which the general solver first continues its attempts.
///
/// The damping by gain ratio of the general solver passes narrow valleys in which the SIMD solver stalls.
pub(super) const QUICK_ATTEMPT_ITERATIONS: u32 = 600;

/// A query with validated target and start.
#[derive(Clone, Copy)]
pub(super) struct Query<'a> {
    pub(super) target: &'a Placement<f64>,
    pub(super) start: &'a [f64],
    pub(super) deadline: Option<Instant>,
}

impl<'a> Query<'a> {
    /// Builds a query. Its time limit begins now.
    pub(super) fn new(arm: &Arm, target: &'a Placement<f64>, start: &'a [f64]) -> Self {
        Self {
            target,
            start,
            deadline: arm.deadline(),
        }
    }
}

impl Query<'_> {
    /// Returns true if less than `needed` is left until the deadline.
    #[cfg(feature = "collision")]
    pub(super) fn is_late_by(&self, needed: std::time::Duration) -> bool {
        let earlier = |at: Instant| at.checked_sub(needed).unwrap_or(at);
        is_past(self.deadline.map(earlier))
    }

    pub(super) fn is_late(&self) -> bool {
        is_past(self.deadline)
    }
}

/// Returns true if a reached solution of the SIMD solver is final, without refinement or comparison.
pub(super) fn is_plain(arm: &Arm) -> bool {
    let options = &arm.options;
    options.max_move.is_none() && options.posture.is_none() && !options.search.compares()
}

/// Returns true if only the attempt from the start matters: the target is proven unreachable.
///
/// It is false for goal bounds of the position, if a number of attempts was given, and if a search returns the best of
/// all attempts.
pub(super) fn needs_only_first_attempt(arm: &Arm, target: &Placement<f64>) -> bool {
    let options = &arm.options;
    if options.attempts_given || options.searches_globally() || !options.goal.is_exact_in_position()
    {
        return false;
    }
    let anchor = arm.names.anchors.first().and_then(Option::as_ref);
    let tolerance = options.position_tolerance;
    let shortfall =
        |anchor: &Anchor| anchor.falls_short_of(target.translation, Vector3::zero(), tolerance);
    anchor.and_then(shortfall).is_some()
}

/// Largest number of attempts at a target.
pub(super) fn attempts_at(arm: &Arm, target: &Placement<f64>) -> u32 {
    match needs_only_first_attempt(arm, target) {
        true => 1,
        false => arm.options.attempts,
    }
}

/// The SIMD solver; with the option `max_move`, the one with the bounds of the query.
pub(super) fn simd_solver_within<'a>(
    arm: &'a Arm,
    bounded_solver: &'a Option<PoseSolver>,
) -> Option<&'a PoseSolver> {
    match bounded_solver {
        Some(_) if arm.options.max_move.is_some() => bounded_solver.as_ref(),
        _ => arm.simd_solver.as_ref(),
    }
}

/// Query of the SIMD solver for the attempts of the half-open range `attempts`, within `budget` iterations.
pub(super) fn simd_query<'a>(
    arm: &Arm,
    query: &Query<'a>,
    attempts: (u32, u32),
    budget: u32,
) -> simd_ik::Query<'a> {
    simd_ik::Query {
        target: query.target,
        start: query.start,
        search: arm.options.search.preference(),
        attempts,
        budget,
        deadline: query.deadline,
    }
}
