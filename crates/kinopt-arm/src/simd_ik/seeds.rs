//! Initial configurations of attempts.

use std::f64::consts::TAU;

use super::atlas::Candidates;
use super::lane::LaneScalar;
use super::links::{Link, Links};
use super::options::Prefer;
use super::prepared::Prepared;
use super::query::Query;
use super::revolutions::reduced_angle;
use kinopt_kinematics::random::mix;
use kinopt_kinematics::spatial::Placement;

/// Largest angle that is used as it is, radians; larger ones lose digits.
const MAX_UNREDUCED_ANGLE: f64 = 1.0e3;

/// Initial configurations of one query by attempt number: the start, those of the atlas, then random ones.
///
/// Under [`Prefer::First`] the start comes after those of the atlas.
pub(crate) struct QuerySeeds {
    /// Configurations of the atlas, looked up on first use.
    candidates: Candidates,
    looked_up: bool,
}

impl QuerySeeds {
    pub(crate) fn new() -> Self {
        Self {
            candidates: Candidates::none(),
            looked_up: false,
        }
    }

    /// Resets the atlas's configurations for another query.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn reset(&mut self) {
        self.looked_up = false;
    }

    /// Writes the initial configuration of an attempt to `q`. `goal_from_first` is the query's goal as the kernel uses
    /// it.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn fill<V: LaneScalar>(
        &mut self,
        prepared: &Prepared,
        query: &Query<'_>,
        goal_from_first: &Placement<f64>,
        attempt: u32,
        q: &mut [f64],
    ) {
        let links = &prepared.links;
        let start_first = query.search == Prefer::Start;
        if start_first && attempt == 0 {
            fill_start(links, query.start, q);
            return;
        }
        // No closure: one that is not inlined would be compiled without the vector features.
        if !self.looked_up {
            self.looked_up = true;
            self.candidates.count = 0;
            if let Some(atlas) = &prepared.atlas {
                let mut goal = *goal_from_first;
                if prepared.settings.weighted {
                    goal = links.goal_from_first(query.target, false);
                    if prepared.settings.axes.orientation_weights == [0.0; 3] {
                        // Any orientation suffices: use the one at the start.
                        fill_start(links, query.start, q);
                        let target =
                            Placement::new(links.tip_rotation(q), query.target.translation);
                        goal = links.goal_from_first(&target, false);
                    }
                }
                atlas.look_up::<V>(links, &goal, &mut self.candidates);
            }
        }
        let count = self.candidates.count as u32;
        let atlas_from = u32::from(start_first);
        if attempt >= atlas_from && attempt < atlas_from + count {
            (self.candidates).fill((attempt - atlas_from) as usize, q);
            for (q, link) in q.iter_mut().zip(&links.links) {
                *q = q.max(link.lower).min(link.upper);
            }
        } else if attempt == count && !start_first {
            fill_start(links, query.start, q);
        } else {
            let mut state = mix(prepared.options.seed ^ mix(u64::from(attempt)));
            for ((q, link), &start) in q.iter_mut().zip(&links.links).zip(query.start) {
                let start = start_value(links, link, start);
                state = mix(state);
                let unit = (state >> 11) as f64 / (1u64 << 53) as f64;
                let half = match link.kind.slides() {
                    true => 1.0,
                    false => std::f64::consts::PI,
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

/// Start value of a joint in the solver's units.
#[cfg_attr(not(debug_assertions), inline(always))]
fn start_value(links: &Links, link: &Link, start: f64) -> f64 {
    match link.kind.slides() {
        true => start * links.lengths_per_metre,
        false => reduced_angle(start),
    }
}

/// Writes the start, clamped to the bounds; a large angle moves within half a revolution of zero if bounds allow.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn fill_start(links: &Links, start: &[f64], q: &mut [f64]) {
    for ((q, link), &start) in q.iter_mut().zip(&links.links).zip(start) {
        *q = start_value(links, link, start);
        *q = q.max(link.lower).min(link.upper);
        if link.kind.turns() && q.abs() > MAX_UNREDUCED_ANGLE {
            let wrapped = *q - TAU * (*q / TAU).round();
            *q = wrapped.max(link.lower).min(link.upper);
        }
    }
}
