//! Where attempts begin.

use super::atlas::Candidates;
use super::chain::JointKind;
use super::lane::LaneScalar;
use super::race::Query;
use super::solver::{PoseSolver, Search};
use crate::spatial::Placement;

/// The seeds of one query, by attempt number: the start, those of the atlas, then random ones; the
/// start comes after the atlas under [`Search::First`].
pub(crate) struct QuerySeeds<'a> {
    solver: &'a PoseSolver,
    start: &'a [f64],
    goal_from_first: Placement<f64>,
    /// Looked up when first asked for.
    candidates: Option<Candidates>,
    start_first: bool,
}

impl<'a> QuerySeeds<'a> {
    #[inline(always)]
    pub(crate) fn new(
        solver: &'a PoseSolver,
        goal_from_first: &Placement<f64>,
        query: &Query<'a>,
    ) -> Self {
        Self {
            solver,
            start: query.start,
            goal_from_first: *goal_from_first,
            candidates: None,
            start_first: query.search == Search::Start,
        }
    }

    /// Writes the seed of an attempt.
    #[inline(always)]
    pub(crate) fn fill<V: LaneScalar>(&mut self, attempt: u32, q: &mut [f64]) {
        let links = &self.solver.links;
        if self.start_first && attempt == 0 {
            for ((q, link), &start) in q.iter_mut().zip(&links.links).zip(self.start) {
                *q = start.max(link.lower).min(link.upper);
            }
            return;
        }
        // No closure here: one that is not inlined would be compiled without the vector features.
        if self.candidates.is_none() {
            self.candidates = Some(match &self.solver.atlas {
                Some(atlas) => atlas.look_up::<V>(links, &self.goal_from_first),
                None => Candidates::none(),
            });
        }
        let Some(candidates) = &self.candidates else {
            return;
        };
        let count = candidates.count as u32;
        let atlas_from = u32::from(self.start_first);
        if attempt >= atlas_from && attempt < atlas_from + count {
            candidates.fill((attempt - atlas_from) as usize, q);
            for (q, link) in q.iter_mut().zip(&links.links) {
                *q = q.max(link.lower).min(link.upper);
            }
        } else if attempt == count && !self.start_first {
            for ((q, link), &start) in q.iter_mut().zip(&links.links).zip(self.start) {
                *q = start.max(link.lower).min(link.upper);
            }
        } else {
            let mut state = mix(self.solver.options.seed ^ mix(u64::from(attempt)));
            for ((q, link), &start) in q.iter_mut().zip(&links.links).zip(self.start) {
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
