//! Where attempts begin.

use super::chain::JointKind;
use super::race::Query;
use super::solver::PoseSolver;
use crate::spatial::Placement;

/// The seeds of one query, by attempt number.
pub(crate) struct QuerySeeds<'a> {
    solver: &'a PoseSolver,
    start: &'a [f64],
}

impl<'a> QuerySeeds<'a> {
    #[inline(always)]
    pub(crate) fn new(
        solver: &'a PoseSolver,
        _goal_from_first: &Placement<f64>,
        query: &Query<'a>,
    ) -> Self {
        Self {
            solver,
            start: query.start,
        }
    }

    /// Writes the seed of an attempt.
    #[inline(always)]
    pub(crate) fn fill(&self, attempt: u32, q: &mut [f64]) {
        let links = &self.solver.links.links;
        if attempt == 0 {
            for ((q, link), &start) in q.iter_mut().zip(links).zip(self.start) {
                *q = start.clamp(link.lower, link.upper);
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
                *q = (lower + unit * (upper - lower)).clamp(link.lower, link.upper);
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
