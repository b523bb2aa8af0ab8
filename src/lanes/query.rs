//! One target, a start, and what may be spent on it.

use super::options::Prefer;
use crate::clock::Instant;
use crate::spatial::Placement;

/// One query as the drivers see it.
#[derive(Clone, Copy)]
pub(crate) struct Query<'a> {
    pub(crate) target: &'a Placement<f64>,
    pub(crate) start: &'a [f64],
    pub(crate) search: Prefer,
    /// The first attempt, and one more than the last.
    pub(crate) attempts: (u32, u32),
    /// Iterations after which no attempt begins.
    pub(crate) budget: u32,
    /// When to give up, checked between iterations.
    pub(crate) deadline: Option<Instant>,
}

/// Where a query's configurations go.
#[derive(Default)]
pub(crate) struct Answer<'a> {
    /// The solution; after a miss the end of the start's own attempt under [`Prefer::Start`] (where
    /// it is among the attempts), the best of all attempts otherwise.
    pub(crate) q: &'a mut [f64],
    /// After a miss under [`Prefer::Start`] the best of all attempts; empty where nobody asks.
    pub(crate) best: &'a mut [f64],
    /// After a miss which attempt the best of all is.
    pub(crate) best_attempt: u32,
}

impl<'a> Answer<'a> {
    /// For who does not ask for the best of all.
    pub(crate) fn of(q: &'a mut [f64]) -> Self {
        Self {
            q,
            ..Self::default()
        }
    }
}
