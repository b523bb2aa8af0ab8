//! Query of the SIMD solver: target, start and budget.

use super::options::Prefer;
use kinopt_kinematics::clock::Instant;
use kinopt_kinematics::spatial::Placement;

/// A query as the drivers receive it.
#[derive(Clone, Copy)]
pub(crate) struct Query<'a> {
    pub(crate) target: &'a Placement<f64>,
    pub(crate) start: &'a [f64],
    pub(crate) search: Prefer,
    /// Number of the first attempt, and one past the last.
    pub(crate) attempts: (u32, u32),
    /// Number of iterations after which no attempt begins.
    pub(crate) budget: u32,
    /// Time after which the search stops, checked between iterations.
    pub(crate) deadline: Option<Instant>,
}

/// Output configurations of a query.
#[derive(Default)]
pub(crate) struct QueryOutput<'a> {
    /// The solution; if none was found, the end of the attempt from the start or the best of all attempts.
    ///
    /// The former applies under [`Prefer::Start`] if that attempt is among those run.
    pub(crate) q: &'a mut [f64],
    /// Best of all failed attempts under [`Prefer::Start`]; may be empty if not needed.
    pub(crate) best: &'a mut [f64],
    /// Number of the best failed attempt.
    pub(crate) best_attempt: u32,
}

impl<'a> QueryOutput<'a> {
    /// Output without the best failed attempt.
    pub(crate) fn of(q: &'a mut [f64]) -> Self {
        Self {
            q,
            ..Self::default()
        }
    }
}
