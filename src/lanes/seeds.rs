//! Where attempts begin.

use super::chain::JointKind;
use super::race::Query;
use super::atlas::Candidates;
use super::solver::{PoseSolver, Search};
use crate::spatial::Placement;

/// The seeds of one query, by attempt number.
pub(crate) struct QuerySeeds<'a> {
    solver: &'a PoseSolver,
    start: &'a [f64],
    candidates: Candidates,
    start_first: bool,
}

impl<'a> QuerySeeds<'a> {
    #[inline(always)]
    pub(crate) fn new(
        solver: &'a PoseSolver,
        goal_from_first: &Placement<f64>,
        query: &Query<'a>,
    ) -> Self {
        let candidates = match &solver.atlas {
            Some(atlas) => atlas.look_up(&solver.links, goal_from_first),
            None => Candidates::none(),
        };
        Self {
            solver,
            start: query.start,
            candidates,
            start_first: query.search == Search::Start || candidates.count == 0,
        }
    }

    /// Writes the seed of an attempt.
    #[inline(always)]
    pub(crate) fn fill(&self, attempt: u32, q: &mut [f64]) {
        let links = &self.solver.links.links;
        let count = self.candidates.count as u32;
        let (start_at, atlas_from) = if self.start_first { (0, 1) } else { (count, 0) };
        if attempt >= atlas_from && attempt < atlas_from + count {
            self.candidates.fill((attempt - atlas_from) as usize, q);
            for (q, link) in q.iter_mut().zip(links) {
                *q = q.max(link.lower).min(link.upper);
            }
        } else if attempt == start_at {
            for ((q, link), &start) in q.iter_mut().zip(links).zip(self.start) {
                *q = start.max(link.lower).min(link.upper);
            }
        } else {
            let mut state = mix(self.solver.options.seed ^ mix(u64::from(attempt)));
            for ((q, link), &start) in q.iter_mut().zip(links).zip(self.start) {
                state = mix(state);
                let unit = (state >> 11) as f64 * (0.5f64).powi(53);
                let half = match link.kind {
                    JointKind::Revolute => std::f64::consts::PI,
                    JointKind::Prismatic => 1.0,
                };
                let lower = if link.lower.is_finite() { link.lower } else { start - half };
                let upper = if link.upper.is_finite() { link.upper } else { start + half };
                *q = (lower + unit * (upper - lower)).max(link.lower).min(link.upper);
            }
        }
    }
}

/// One step of the SplitMix64 generator (Steele, Lea, Flood 2014).
pub(crate) fn mix(state: u64) -> u64 {
    let z = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}
