//! One question to the engine.

use std::time::Instant;

use super::options::Search;
use crate::spatial::Placement;

/// One query as the drivers see it.
#[derive(Clone, Copy)]
pub(crate) struct Query<'a> {
    pub(crate) target: &'a Placement<f64>,
    pub(crate) start: &'a [f64],
    pub(crate) search: Search,
    /// Iterations after which no attempt begins.
    pub(crate) budget: u32,
    /// When to give up, checked between iterations.
    pub(crate) deadline: Option<Instant>,
}
