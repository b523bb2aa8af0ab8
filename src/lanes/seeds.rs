//! Where attempts begin.

use std::f64::consts::TAU;

use super::atlas::Candidates;
use super::chain::JointKind;
use super::lane::LaneScalar;
use super::links::Link;
use super::options::Search;
use super::prepared::Prepared;
use super::query::Query;
use super::turns::reduced;
use crate::random::mix;
use crate::spatial::Placement;

/// Beyond this an angle loses digits, radians.
const LARGE_ANGLE: f64 = 1.0e3;

/// The seeds of one query, by attempt number: the start, those of the atlas, then random ones; the
/// start comes after the atlas under [`Search::First`].
pub(crate) struct QuerySeeds<'a> {
    prepared: &'a Prepared,
    start: &'a [f64],
    target: &'a Placement<f64>,
    /// Looked up when first asked for.
    candidates: Option<Candidates>,
    start_first: bool,
}

impl<'a> QuerySeeds<'a> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn new(prepared: &'a Prepared, query: &Query<'a>) -> Self {
        Self {
            prepared,
            start: query.start,
            target: query.target,
            candidates: None,
            start_first: query.search == Search::Start,
        }
    }

    /// A start's value in the solver's terms.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn start_value(&self, link: &Link, start: f64) -> f64 {
        match link.kind {
            JointKind::Revolute => reduced(start),
            JointKind::Prismatic => start * self.prepared.links.lengths_per_metre,
        }
    }

    /// The start, within the bounds; an unbounded angle within half a turn of zero if it is large.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn fill_start(&self, q: &mut [f64]) {
        let links = &self.prepared.links.links;
        for ((q, link), &start) in q.iter_mut().zip(links).zip(self.start) {
            *q = self.start_value(link, start);
            *q = q.max(link.lower).min(link.upper);
            if link.kind == JointKind::Revolute && q.abs() > LARGE_ANGLE {
                let turned = *q - TAU * (*q / TAU).round();
                *q = turned.max(link.lower).min(link.upper);
            }
        }
    }

    /// Writes the seed of an attempt.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn fill<V: LaneScalar>(&mut self, attempt: u32, q: &mut [f64]) {
        let links = &self.prepared.links;
        if self.start_first && attempt == 0 {
            self.fill_start(q);
            return;
        }
        // No closure here: one that is not inlined would be compiled without the vector features.
        if self.candidates.is_none() {
            self.candidates = Some(match &self.prepared.atlas {
                Some(atlas) => {
                    let mut goal = links.goal_from_first(self.target, false);
                    if self.prepared.settings.axes.orientation_weights == [0.0; 3] {
                        // Any orientation will do: the start's is the nearest.
                        self.fill_start(q);
                        let tip = links.base_from_tip(q);
                        let target = Placement::new(tip.rotation, self.target.translation);
                        goal = links.goal_from_first(&target, false);
                    }
                    atlas.look_up::<V>(links, &goal)
                }
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
            self.fill_start(q);
        } else {
            let mut state = mix(self.prepared.options.seed ^ mix(u64::from(attempt)));
            for ((q, link), &start) in q.iter_mut().zip(&links.links).zip(self.start) {
                let start = self.start_value(link, start);
                state = mix(state);
                let unit = (state >> 11) as f64 / (1u64 << 53) as f64;
                let half = match link.kind {
                    JointKind::Revolute => std::f64::consts::PI,
                    JointKind::Prismatic => 1.0,
                };
                let lower = if link.lower.is_finite() {
                    link.lower
                } else {
                    start - half
                };
                let upper = if link.upper.is_finite() {
                    link.upper
                } else {
                    start + half
                };
                *q = (lower + unit * (upper - lower))
                    .max(link.lower)
                    .min(link.upper);
            }
        }
    }
}
