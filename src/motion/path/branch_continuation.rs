//! Continuation of the configurations of one station to a neighbouring station.
//!
//! Each configuration starts with its last motion, which passes straight through points where branches meet. If that
//! fails, it starts at rest. If a long step fails too, it is followed in small parts along the path.

use super::knots::NEAR;
use super::layers::{Growth, Layer};
use super::linear_segment::between;
use super::neighbour_index::Sorted;
use crate::arm::{Arm, Ends, QueryError};
use crate::spatial::Placement;

/// Fraction of the last motion added to the start of a step.
const MOMENTUM: f64 = 0.9;
/// Number of collision-free configurations by the sphere check below which the exact shapes are checked too.
pub(super) const FEW: usize = 8;
/// Subdivisions of a part in which a joint moves far, as it does near points where branches meet.
pub(super) const SMALLER: usize = 20;
/// Maximum number of parts of a step.
pub(super) const MOST_PARTS: f64 = 10_000.0;

/// Scratch memory of the continuation.
#[derive(Debug, Default)]
pub(super) struct Carrier {
    /// Range of the last continued configurations, with their motions.
    moving: std::ops::Range<usize>,
    motions: Vec<f64>,
    stand: Vec<f64>,
    starts: Vec<f64>,
    ends: Ends,
    again: Ends,
    limits: Vec<f64>,
    /// For each configuration: `None` if it failed, else whether it was followed in parts.
    came: Vec<Option<bool>>,
    free: Vec<bool>,
    failed: Vec<usize>,
    /// Index of the configurations known at the next station.
    known: Sorted,
    end: Vec<f32>,
}

impl Carrier {
    /// Discards the stored motions.
    pub(super) fn forget(&mut self) {
        self.motions.clear();
        self.moving = 0..0;
    }

    /// Continues the configurations of station `from`, starting with index `first`, to the neighbouring station `to`.
    ///
    /// Appends the results to the layer of `to`.
    pub(super) fn carry(
        &mut self,
        growth: &Growth<'_>,
        layers: &mut [Layer],
        (from, to): (usize, usize),
        first: usize,
    ) -> Result<(), QueryError> {
        let n = growth.width();
        let most = match to > from {
            // A quarter is reserved for configurations continued backwards.
            true => growth.most - growth.most / 4,
            false => growth.most,
        };
        let q = layers[from].q.get(first * n..).unwrap_or(&[]);
        let count = q.len() / n;
        let place = |at: usize| at.saturating_sub(first).min(count);
        let moving = place(self.moving.start)..place(self.moving.end);
        self.follow(growth, q, (from, to), moving)?;
        self.motions.clear();
        let begun = layers[to].count(n);
        let (known, asked) = (&layers[to].q, &layers[from].q);
        self.known
            .take(known, asked, &growth.merging, &growth.turns);
        layers[to]
            .q
            .reserve(if begun == 0 { self.ends.q.len() } else { 0 });
        for place in 0..self.came.len() {
            let Some(in_parts) = self.came[place] else {
                continue;
            };
            let q = &self.ends.q[place * n..(place + 1) * n];
            self.end.clear();
            self.end.extend(q.iter().map(|q| *q as f32));
            let known = growth.find_sorted(&layers[to], &self.known, &self.end);
            let own = match known {
                Some(own) => own,
                None if layers[to].count(n) < most => {
                    layers[to].take_folded(q, &growth.turns);
                    let own = layers[to].count(n) - 1;
                    self.known.insert(&layers[to].q[own * n..], own);
                    let stand = &self.stand[place * n..(place + 1) * n];
                    let motion = q.iter().zip(stand).map(|(a, b)| a - b);
                    self.motions.extend(motion);
                    own
                }
                None => {
                    layers[to].full = true;
                    continue;
                }
            };
            if in_parts || known.is_some() {
                match to > from {
                    true => layers[to].link(own, first + place),
                    false => layers[from].link(first + place, own),
                }
            }
        }
        self.moving = begun..layers[to].count(n);
        Ok(())
    }

    /// Continues each configuration to the next station, into `ends` and `came`. Those in `moving` start with their
    /// motion.
    fn follow(
        &mut self,
        growth: &Growth<'_>,
        from: &[f32],
        (station_from, station_to): (usize, usize),
        moving: std::ops::Range<usize>,
    ) -> Result<(), QueryError> {
        let (knots, n) = (growth.knots, growth.width());
        let ends = [knots.stations[station_from], knots.stations[station_to]];
        let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        let arm = growth.arms.of(knots.tool(ends[1]));
        self.stand.clear();
        self.stand.extend(from.iter().map(|q| f64::from(*q)));
        self.came.clear();
        self.came.resize(from.len() / n, None);
        if from.is_empty() {
            return Ok(());
        }
        growth.bounds.write(knots, low, high, &mut self.limits);
        self.starts.clear();
        self.starts.extend_from_slice(&self.stand);
        let starts = self.starts[moving.start * n..].iter_mut();
        for (q, by) in starts.zip(&self.motions) {
            *q += MOMENTUM * by;
        }
        let target = knots.targets[ends[1]];
        arm.carry_all(&target, &self.starts, &mut self.ends)?;
        self.take_near(n, false);
        self.failed.clear();
        let failed = moving.filter(|place| self.came[*place].is_none());
        self.failed.extend(failed);
        if !self.failed.is_empty() {
            self.stand_failed(n);
            arm.carry_all(&target, &self.starts, &mut self.again)?;
            self.put_back(n);
            self.take_near(n, false);
        }
        let long = knots.way[high] - knots.way[low];
        if high == low + 1 && long > NEAR && knots.is_led_to(high) {
            self.failed.clear();
            let failed = (0..self.came.len()).filter(|place| self.came[*place].is_none());
            self.failed.extend(failed);
            self.follow_in_parts(growth, ends, long)?;
        }
        growth.note_free(ends[1], &self.ends.q, false, &mut self.free)?;
        let both = self.came.iter().zip(&self.free);
        let sure = both.filter(|(came, free)| came.is_some() && **free).count();
        if sure < FEW {
            // The spheres of the fast check enclose the shapes.
            growth.note_free(ends[1], &self.ends.q, true, &mut self.free)?;
        }
        for (came, free) in self.came.iter_mut().zip(&self.free) {
            *came = came.filter(|_| *free);
        }
        Ok(())
    }

    /// Accepts results that reach the target within the joint limits of the step.
    fn take_near(&mut self, n: usize, in_parts: bool) {
        for (place, outcome) in self.ends.outcomes.iter().enumerate() {
            if self.came[place].is_some() || !outcome.reached {
                continue;
            }
            let all = place * n..(place + 1) * n;
            let moves = self.ends.q[all.clone()].iter().zip(&self.stand[all]);
            let mut moves = moves.zip(&self.limits);
            if moves.all(|((a, b), most)| (a - b).abs() <= *most) {
                self.came[place] = Some(in_parts);
            }
        }
    }

    /// Restarts the failed configurations without motion.
    fn stand_failed(&mut self, n: usize) {
        self.starts.clear();
        for &place in &self.failed {
            let stand = &self.stand[place * n..(place + 1) * n];
            self.starts.extend_from_slice(stand);
        }
    }

    fn put_back(&mut self, n: usize) {
        let ends = self.again.q.chunks_exact(n).zip(&self.again.outcomes);
        for ((q, outcome), &place) in ends.zip(&self.failed) {
            self.ends.q[place * n..(place + 1) * n].copy_from_slice(q);
            self.ends.outcomes[place] = *outcome;
        }
    }

    /// Follows the failed configurations in parts of a long step. Parts with a long joint move are subdivided.
    fn follow_in_parts(
        &mut self,
        growth: &Growth<'_>,
        ends: [usize; 2],
        long: f64,
    ) -> Result<(), QueryError> {
        let (knots, n) = (growth.knots, growth.width());
        let arm = growth.arms.of(knots.tool(ends[1]));
        let parts = (long / NEAR).ceil().min(MOST_PARTS) as usize;
        let [from, to] = ends.map(|end| knots.targets[end]);
        let count = parts * SMALLER;
        let target = |at: usize| match at < count {
            true => between(&from, &to, at as f64 / count as f64),
            false => to,
        };
        let mut followed = Followed::default();
        for &place in &self.failed {
            followed.add(place, &self.stand[place * n..(place + 1) * n]);
        }
        for begin in (0..count).step_by(SMALLER) {
            if followed.places.is_empty() {
                break;
            }
            let end = begin + SMALLER;
            let mut lost = followed.go_on(growth, arm, &target(end), &mut self.again)?;
            for smaller in begin + 1..=end {
                if lost.places.is_empty() {
                    break;
                }
                lost.go_on(growth, arm, &target(smaller), &mut self.again)?;
            }
            followed.append(lost);
        }
        for (&place, q) in followed.places.iter().zip(followed.q.chunks_exact(n)) {
            self.ends.q[place * n..(place + 1) * n].copy_from_slice(q);
            self.came[place] = Some(true);
        }
        Ok(())
    }
}

/// Configurations followed in parts of a step: their indices at its start, and their current values.
#[derive(Debug, Default)]
struct Followed {
    places: Vec<usize>,
    q: Vec<f64>,
}

impl Followed {
    fn add(&mut self, place: usize, q: &[f64]) {
        self.places.push(place);
        self.q.extend_from_slice(q);
    }

    fn append(&mut self, mut others: Self) {
        self.places.append(&mut others.places);
        self.q.append(&mut others.q);
    }

    /// Advances the configurations that reach the target. Returns those with a too long joint move, unchanged.
    fn go_on(
        &mut self,
        growth: &Growth<'_>,
        arm: &Arm,
        target: &Placement<f64>,
        ends: &mut Ends,
    ) -> Result<Self, QueryError> {
        let n = growth.width();
        arm.carry_all(target, &self.q, ends)?;
        let Self { places, q } = std::mem::take(self);
        let mut lost = Self::default();
        let steps = q.chunks_exact(n).zip(ends.q.chunks_exact(n));
        let ends = places.into_iter().zip(steps).zip(&ends.outcomes);
        for ((place, (from, to)), _) in ends.filter(|(_, outcome)| outcome.reached) {
            match growth.bounds.allow_part(from.iter().zip(to)) {
                true => self.add(place, to),
                false => lost.add(place, from),
            }
        }
        Ok(lost)
    }
}
